"""The null space of a redundant arm: motion of the joints that leaves the tip still, and what a controller does there.

An arm with more joints than task coordinates, n > m, can move while its tip stands still. With W = J H^-1 J' and the
projector N = I - H^-1 J' W^-1 J these motions are N v for any v. The torque

    tau_0 = -H N u,   u = d_n dq + k_n (q - posture)

acts on them alone: J H^-1 tau_0 = 0, so that the tip does not accelerate, whatever u is. It pulls the joints towards a
posture with the stiffness k_n (null_stiffness, 1/s2) and damps them with d_n (null_damping, 1/s). d_n^2 = 4 k_n is
critical damping. The tip has its six coordinates first: where they leave no posture free, the joints stop as near to it
as they can.
"""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, Formula, Formulas, SampledModel
from fmus.control.impedance import ArmEstimate, Measured, null_space_momentum
from fmus.elements import ANGLE, LENGTH
from fmus.robots.robot import Robot

DAMPING = 10.0  # 1/s, assumed
STIFFNESS = 25.0  # 1/s2, assumed: critically damped with the damping above

FORMULAS = Formulas(
    "Null space",
    [
        Formula(
            r"\tau \leftarrow \tau - H N u, \quad u = d_n \dot{q} + k_n (q - q_{\text{posture}}), \quad"
            r" N = I - H^{-1} J^{T} W^{-1} J",
            "Motion that leaves the tip still goes to the posture with the stiffness null_stiffness k_n and the"
            " damping null_damping d_n.",
        )
    ],
)


@dataclass(frozen=True)
class NullSpace:
    """Parameters of what a controller does in the null space.

    Attributes
    ----------
    damping, stiffness
        d_n, 1/s, and k_n, 1/s2, shape (1,).
    posture
        Joint coordinates, rad or m, shape (n,).
    """

    damping: ca.SX
    stiffness: ca.SX
    posture: ca.SX

    def torque(self, measured: Measured, model: ArmEstimate) -> ca.SX:
        """Torque tau_0, N.m or N, shape (n,)."""
        u = self.damping * measured.dq + self.stiffness * (measured.q - self.posture)
        return -null_space_momentum(measured.q, model, u)


def declare_null_space(model: SampledModel, robot: Robot) -> NullSpace:
    """Declare damping, stiffness and posture of the null space; the posture starts at q of the start."""
    damping = model.parameter(
        "null_damping",
        DAMPING,
        unit="1/s",
        limits=NOT_NEGATIVE,
        tunable=True,
        description="Damping of joint motion that leaves the tip still; 0 = none",
    )
    stiffness = model.parameter(
        "null_stiffness",
        STIFFNESS,
        unit="1/s2",
        limits=NOT_NEGATIVE,
        tunable=True,
        description="Stiffness towards the posture, of joint motion that leaves the tip still; 0 = none",
    )
    joints = robot.joints
    posture = model.parameter(
        "posture",
        robot.start.q,
        unit=joints.each("rad", "m"),
        display_unit=joints.each(ANGLE, LENGTH),
        tunable=True,
        description=joints.texts("Angle that the null space is drawn to", "Position that the null space is drawn to"),
    )
    return NullSpace(damping, stiffness, posture)
