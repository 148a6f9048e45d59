"""The point of an arm that touches a wall, with its velocity and the moment of its contact force.

In the plane the point is the tip itself. In space it is fixed to the tip at `contact_point`, c in the frame of the
tip, such as the end of a tool or an edge of what the arm holds. With the rotation matrix R and the position p of the
tip, its velocity v and its angular velocity w,

    r = R c,   x_c = p + r,   dx_c = v + w x r

The wall is the half-space n.x >= wall_offset with the unit normal n pointing into it. While the point is in the wall,
at the depth gap = n.x_c - wall_offset, and slides along it with the velocity v_s = dx_c - (n.dx_c) n,

    F_n = K_f gap (1 + D_f d(gap)/dt),  never below zero
    f = F_n (n + mu tanh(|v_s| / friction_velocity) v_s / |v_s|)

is its force on the wall: the normal force by Hunt and Crossley (1975), and friction within the cone of the angle
atan(mu), in the direction of sliding. At the tip this is the wrench F_ext = (f, r x f), in the axes of the base. Both
have the same power, f' dx_c = f' v + (r x f)' w. With c = 0 the tip touches the wall, and there is no moment.
"""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import Formula, Formulas, Model
from fmus.elements import SPACE, of_tip
from fmus.mechanics.spatial_model import SpatialArmModel

FORMULAS = Formulas(
    "Contact in space",
    [
        Formula(
            r"r = R\,c, \quad x_c = p + r, \quad \dot{x}_c = v + \omega \times r",
            "The point that touches the wall is fixed to the tip at c, the contact_point; v and omega are the velocity"
            " and the angular velocity of the tip.",
        ),
        Formula(
            r"d = n^{T} x_c - d_0, \quad F_n = \max\left( 0, \; K_f\,d\,(1 + D_f\,\dot{d}) \right) \quad"
            r" \text{while in contact}",
            "The depth d of the point of contact is positive inside the wall; d0 is wall_offset. The wall pushes and"
            " never pulls.",
        ),
        Formula(
            r"f = F_n \left( n + \mu\,\tanh\frac{\|v_t\|}{v_\mu}\,\frac{v_t}{\|v_t\|} \right), \quad"
            r" v_t = \dot{x}_c - n\,n^{T} \dot{x}_c",
            "Friction acts along the surface in the direction of sliding, within the cone of mu; its width is"
            " friction_velocity.",
        ),
        Formula(
            r"F_{\text{ext}} = (f, \; r \times f)",
            "The force f of the point on the wall has a moment about the tip.",
        ),
    ],
)


@dataclass(frozen=True)
class ContactPoint:
    """Where a point of an arm is, and how it moves.

    Attributes
    ----------
    position, velocity
        Position m and velocity m/s of the point in the axes of the base, shape (2,) in the plane, (3,) in space.
    lever
        Vector from the tip to the point, m, of that shape; None if the point is the tip.
    angles
        Number of moments in a wrench.
    """

    position: ca.SX
    velocity: ca.SX
    lever: ca.SX | None = None
    angles: int = 0

    @property
    def name(self) -> str:
        """What texts call the point."""
        return "tip" if self.lever is None else "contact point"

    def wrench(self, force: ca.SX) -> ca.SX:
        """Force, N, of the point on the environment and its moment about the tip, N.m, in the axes of the base."""
        moment = ca.SX.zeros(self.angles, 1) if self.lever is None else ca.cross(self.lever, force)
        return ca.vertcat(force, moment)


def declare_contact_point(model: Model, arm: SpatialArmModel, q: ca.SX, dq: ca.SX) -> ContactPoint:
    """Declare which point of an arm in space touches the walls, by default its tip.

    Parameters
    ----------
    q, dq
        Joint coordinates and rates, shape (n,).
    """
    offset = model.parameter(
        "contact_point",
        [0.0] * SPACE,
        unit="m",
        description=of_tip("Position of the point that touches the wall"),
    )
    R, position = arm.arm.tip_frame(q)
    twist = ca.mtimes(arm.arm.jacobian(q), dq)
    lever = ca.mtimes(R, offset)
    velocity = twist[:SPACE] + ca.cross(twist[SPACE:], lever)
    return ContactPoint(position + lever, velocity, lever, SPACE)
