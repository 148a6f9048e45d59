"""Contact of the tip with a compliant wall, which pushes but never pulls (paper, V; Hunt and Crossley 1975).

The wall is the half-space n.x >= wall_offset with the unit normal n pointing into it. While in contact

    F_n = K_f gap (1 + D_f d(gap)/dt),  never below zero
    F_ext = F_n n + mu F_n tanh(v_t / friction_velocity) t

is the force of the tip on the wall: along the normal, and along the direction of sliding (t is n
turned by +90 degrees, v_t = t.dx). In space t is the direction in which the tip slides, and v_t >= 0 its speed. With
D_f = mu = 0 this is the paper's spring. The tip touches the wall in a point, so that F_ext has no moment about the tip.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, Formula, Formulas, Model
from fmus.environment.half_space import HalfSpace, declare_half_space, ordinal, suffix

PLANE = 2  # coordinates of a point of the plane

FORMULAS = Formulas(
    "Contact",
    [
        Formula(r"d = n^{T} x - d_0", "The depth d of the tip is positive inside the wall; d0 is wall_offset."),
        Formula(
            r"F_n = \max\left( 0, \; K_f\,d\,(1 + D_f\,\dot{d}) \right) \quad \text{while in contact}",
            "The wall pushes and never pulls.",
        ),
        Formula(
            r"F_{\text{ext}} = F_n\,n + \mu\,F_n\,\tanh\frac{v_t}{v_\mu}\,t",
            "Friction acts along the surface: t is n turned by +90 degrees, v_t the speed along t, and the width is"
            " friction_velocity.",
        ),
    ],
)


@dataclass(frozen=True)
class Wall(HalfSpace):
    """A half-space with the law of its contact force, as symbols or numbers.

    Attributes
    ----------
    normal, offset
        Geometry of the wall, see `HalfSpace`.
    K_f, D_f
        Stiffness N/m, and damping per penetration rate s/m.
    mu, friction_velocity
        Coefficient of friction, and the sliding speed m/s that smooths it.
    """

    K_f: ca.SX
    D_f: ca.SX
    mu: ca.SX
    friction_velocity: ca.SX

    def damping_factor(self, dx: ca.SX) -> ca.SX:
        """Factor 1 + D_f d(gap)/dt of the normal force, shape (1,); the wall lets go where it is negative."""
        return 1 + self.D_f * self.along_normal(dx)

    def force(self, x: ca.SX, dx: ca.SX, in_contact: ca.SX, pushing: ca.SX) -> ca.SX:
        """Force of the tip on the wall, N, shape (2,) in the plane, (3,) in space.

        Parameters
        ----------
        x, dx
            Tip position m and velocity m/s, of that shape.
        in_contact, pushing
            1 while `gap`, respectively `damping_factor`, is positive, else 0.
        """
        normal_force = in_contact * pushing * self.K_f * self.gap(x) * self.damping_factor(dx)
        if x.shape[0] > PLANE:
            return normal_force * (self.normal + self.mu * self._sliding_in_space(dx))
        speed = ca.if_else(self.mu > 0, self.along_surface(dx), 0)  # tanh(0) costs nothing
        sliding = ca.tanh(speed / self.friction_velocity)
        return normal_force * (self.normal + self.mu * sliding * self.tangent)

    def _sliding_in_space(self, dx: ca.SX) -> ca.SX:
        """Direction of sliding times tanh(speed / friction_velocity), shape (3,); smooth where the tip is at rest."""
        slide = ca.if_else(self.mu > 0, self.in_surface(dx), ca.SX.zeros(*dx.shape))
        speed = ca.norm_2(slide)
        # The limit at rest matters for derivatives: the value there is 0 anyway.
        resting = 1 / self.friction_velocity
        per_speed = ca.if_else(speed > 0, ca.tanh(speed / self.friction_velocity) / speed, resting)
        return per_speed * slide


def declare_wall(model: Model, number: int, size: int, place: tuple[Sequence[float], float]) -> Wall:
    """Declare the parameters of a wall; those of a second wall end with a 2.

    Parameters
    ----------
    number
        1 for the first wall, 2 for the second.
    size
        Number of coordinates of a point: 2 in the plane, 3 in space.
    place
        Start values of normal and offset.
    """
    end, wall = suffix(number), ordinal(number)
    half_space = declare_half_space(model, number, size, place)
    K_f = model.parameter(f"K_f{end}", 1e5, unit="N/m", limits=NOT_NEGATIVE, description=f"Stiffness of the {wall}")
    D_f = model.parameter(
        f"D_f{end}",
        0.0,
        unit="s/m",
        limits=NOT_NEGATIVE,
        description="Hunt-Crossley damping: relative gain of the normal force per penetration rate",
    )
    mu = model.parameter(f"mu{end}", 0.0, limits=NOT_NEGATIVE, description=f"Coefficient of friction along the {wall}")
    friction_velocity = model.parameter(
        f"friction_velocity{end}",
        1e-2,
        unit="m/s",
        limits=POSITIVE,
        description=f"Sliding speed over which friction along the {wall} changes sign (tanh)",
    )
    return Wall(half_space.normal, half_space.offset, K_f, D_f, mu, friction_velocity)
