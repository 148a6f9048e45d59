"""What a sensor at the wrist of an arm in space feels: the contact, and weight and inertia of the payload.

The payload is a rigid body that is fixed to the tip, with the ten parameters m, m c and I in the frame of the tip. The
sensor sits between arm and payload. With the acceleration a of the tip, its angular velocity w and its angular
acceleration dw, and the acceleration g of a falling body, Newton's and Euler's laws give the wrench of the arm at the
tip on all that is beyond the sensor:

    F_wrist = F_ext + (m (a - g) + dw x mc + w x (w x mc),   I dw + w x I w + mc x (a - g))

Without a payload this is F_ext. The motion of the arm does not depend on where the sensor sits.
"""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import Formula, Formulas
from fmus.mechanics.recursions import Inertia
from fmus.mechanics.spatial_arm import SPACE, SpatialArm

FORMULAS = Formulas(
    "Wrench at the wrist",
    [
        Formula(
            r"F_{\text{wrist}} = F_{\text{ext}} + \begin{pmatrix} m\,(a - g) + \dot{\omega} \times mc + \omega \times"
            r" (\omega \times mc) \\ I\,\dot{\omega} + \omega \times I\,\omega + mc \times (a - g) \end{pmatrix}",
            "The arm pushes the environment and the payload, whose mass, first moment and moment of inertia about the"
            " tip are m, mc and I.",
        )
    ],
)


@dataclass(frozen=True)
class TipMotion:
    """Motion of the tip in the axes of the base.

    Attributes
    ----------
    R
        Rotation matrix of the tip, shape (3, 3).
    rate
        Angular velocity w, rad/s, shape (3,).
    acceleration
        Acceleration of the tip m/s2 above the angular acceleration rad/s2, shape (6,).
    """

    R: ca.SX
    rate: ca.SX
    acceleration: ca.SX

    @classmethod
    def of(cls, arm: SpatialArm, q: ca.SX, dq: ca.SX, ddq: ca.SX) -> "TipMotion":
        """Motion of the tip of an arm at joint coordinates, rates and accelerations, shape (n,)."""
        J = arm.jacobian(q)
        twist = ca.mtimes(J, dq)
        acceleration = ca.mtimes(J, ddq) + ca.jtimes(twist, q, dq)
        return cls(arm.tip_frame(q)[0], twist[SPACE:], acceleration)


def wrench_on_payload(payload: ca.SX, motion: TipMotion, gravity: ca.SX) -> ca.SX:
    """Wrench at the tip that moves a payload, N and N.m, shape (6,), in the axes of the base.

    Parameters
    ----------
    payload
        Ten parameters in the frame of the tip, in the order of `rigid_body.SYMBOLS`.
    motion
        Motion of the tip.
    gravity
        Acceleration of a falling body in the axes of the base, m/s2, shape (3,).
    """
    R, body = motion.R, Inertia.of(payload)
    a, w, dw = (R.T @ v for v in (motion.acceleration[:SPACE] - gravity, motion.rate, motion.acceleration[SPACE:]))
    force = body.m * a + ca.cross(dw, body.mc) + ca.cross(w, ca.cross(w, body.mc))
    moment = body.I @ dw + ca.cross(w, body.I @ w) + ca.cross(body.mc, a)
    return ca.vertcat(R @ force, R @ moment)
