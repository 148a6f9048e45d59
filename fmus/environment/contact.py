"""Unilateral contact of the tip with a compliant half-plane (paper, V; Hunt and Crossley 1975).

The wall is the set n.x >= wall_offset with the unit normal n pointing into it. While in contact

    F_n = K_f gap (1 + D_f d(gap)/dt),  never below zero
    F_ext = F_n n + mu F_n tanh(v_t / friction_velocity) t

is the force of the tip on the wall: along the normal, and along the direction of sliding (t is n
turned by +90 degrees, v_t = t.dx). With D_f = mu = 0 this is the paper's spring.
"""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import Model

NORMAL_TOLERANCE = 1e-9  # by which the normal's length may miss 1


@dataclass(frozen=True)
class Wall:
    """Parameters of the wall, as symbols or numbers.

    Attributes
    ----------
    normal
        Unit vector into the wall, shape (2,).
    offset
        Distance of the surface from the origin along the normal, m.
    K_f, D_f
        Stiffness N/m, and damping per penetration rate s/m.
    mu, friction_velocity
        Coefficient of friction, and the sliding speed m/s that smooths it.
    """

    normal: ca.SX
    offset: ca.SX
    K_f: ca.SX
    D_f: ca.SX
    mu: ca.SX
    friction_velocity: ca.SX

    def gap(self, x: ca.SX) -> ca.SX:
        """Signed depth n.x - offset, m: positive inside the wall."""
        return ca.dot(self.normal, x) - self.offset

    def damping_factor(self, dx: ca.SX) -> ca.SX:
        """Factor 1 + D_f d(gap)/dt of the normal force; the wall lets go where it is negative."""
        return 1 + self.D_f * ca.dot(self.normal, dx)

    def force(self, x: ca.SX, dx: ca.SX, in_contact: ca.SX, pushing: ca.SX) -> ca.SX:
        """Force of the tip on the wall, N, shape (2,).

        Parameters
        ----------
        x, dx
            Tip position m and velocity m/s, shape (2,).
        in_contact, pushing
            1 while `gap`, respectively `damping_factor`, is positive, else 0.
        """
        tangent = ca.vertcat(-self.normal[1], self.normal[0])
        normal_force = in_contact * pushing * self.K_f * self.gap(x) * self.damping_factor(dx)
        sliding = ca.tanh(ca.dot(tangent, dx) / self.friction_velocity)
        return normal_force * (self.normal + self.mu * sliding * tangent)


def require_unit_normal(model: Model, normal: ca.SX) -> None:
    """Demand that the wall's normal has length 1."""
    miss = ca.fabs(ca.norm_2(normal) - 1)
    model.require(NORMAL_TOLERANCE - miss, "wall_normal must have length 1")
