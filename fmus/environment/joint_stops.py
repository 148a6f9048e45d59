"""Stops of joints: stiff springs with damping, which keep the joints of an arm within their ranges.

Joint i has the range from q_min to q_max. Beyond it, at the depth d > 0, its stop pushes it back by the torque

    d = max(q - q_max, q_min - q),   tau_stop = k d (u + sqrt(1 + u^2)),   u = D d(d)/dt

with k the `stop_stiffness` and D the `stop_damping`. The last factor is 1 at rest, exceeds 1 while the joint moves into
the stop and is below 1 while it moves out. It is always positive, so that a stop never pulls, and smooth. With the
energy k d^2 / 2 of its spring a stop takes power and never gives any: the factor minus 1 has the sign of the rate.

The torque of a spring has a corner at d = 0. A joint reaches and leaves it at a located event, so that the integrator
keeps its order.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, ContinuousModel, Formula, Formulas
from fmus.elements import ANGLE, LENGTH
from fmus.mechanics.joints import NONE, Joints

TRAVEL = 0.02
"""rad or m: how far the largest torque of a joint presses it into its stop, where nothing else counts."""
SLOWEST, FASTEST = 300.0, 3000.0
"""rad/s: a stop is at least and at most so stiff that the bare joint swings on it at this rate. In a sub-step of 1e-4 s
of the integrator it swings by 0.03 and by 0.3 rad."""
ROUNDING = 1e-9
"""rad or m, by which a start may miss the range."""
DAMPING = 1.0
"""s/rad, assumed: a joint that hits its stop at 1 rad/s leaves it at 0.61 rad/s, if nothing else acts on it."""

FORMULAS = Formulas(
    "Stops of the joints",
    [
        Formula(
            r"d = \max(q - q_{\text{max}}, \; q_{\text{min}} - q), \quad"
            r" \tau_{\text{stop}} = k\,d\,\left( u + \sqrt{1 + u^2} \right), \quad u = D\,\dot{d} \quad"
            r" \text{while } d > 0",
            "A stop pushes its joint back into the range; k is its stop_stiffness, D its stop_damping.",
        )
    ],
)


@dataclass(frozen=True)
class JointStops:
    """Stops at both ends of the ranges of n joints; units in parentheses are those of a slide.

    Attributes
    ----------
    lower, upper
        Ends of the ranges, rad (m), shape (n,).
    stiffness, damping
        Stiffness, N.m/rad (N/m), and damping per rate, s/rad (s/m), shape (n,).
    """

    lower: ca.SX
    upper: ca.SX
    stiffness: ca.SX
    damping: ca.SX

    def depth(self, q: ca.SX) -> ca.SX:
        """How far joints are beyond their ranges, rad (m), shape (n,): negative within them."""
        return ca.fmax(q - self.upper, self.lower - q)

    def torque(self, q: ca.SX, dq: ca.SX, pressed: ca.SX) -> ca.SX:
        """Torques of the stops on the joints, N.m (N), shape (n,): negative at the upper end of a range.

        Parameters
        ----------
        q, dq
            Joint coordinates and rates, shape (n,).
        pressed
            1 where `depth` is positive, else 0, shape (n,).
        """
        outwards = ca.if_else(q - self.upper > self.lower - q, 1, -1)
        u = self.damping * outwards * dq
        return -outwards * pressed * self.stiffness * self.depth(q) * (u + ca.sqrt(1 + u * u))


def declare_joint_stops(model: ContinuousModel, joints: Joints, inertia: np.ndarray, q_start: ca.SX) -> JointStops:
    """Declare the ranges of the joints, by default those of the robot, and their stops.

    Parameters
    ----------
    inertia
        Inertia against the motion of each joint, kg m2 (kg), shape (n,), which the default stiffness suits.
    q_start
        Joint coordinates at the start, shape (n,), which must be within the ranges.
    """
    lowest, highest = joints.ranges
    lower, upper = (
        model.parameter(
            name,
            values,
            unit=joints.each("rad", "m"),
            display_unit=joints.each(ANGLE, LENGTH),
            description=[f"{text}; {none} = none" for text in joints.texts(f"{end} end of the range")],
        )
        for name, values, end, none in (("q_min", lowest, "Lower", "-1e9"), ("q_max", highest, "Upper", "1e9"))
    )
    stiffness = model.parameter(
        "stop_stiffness",
        _stiffness(joints, inertia),
        unit=joints.each("N.m/rad", "N/m"),
        limits=POSITIVE,
        description=joints.texts("Stiffness of the stops"),
    )
    damping = model.parameter(
        "stop_damping",
        [DAMPING] * joints.n,
        unit=joints.each("s/rad", "s/m"),
        limits=NOT_NEGATIVE,
        description=joints.texts("Damping per rate of the stops"),
    )
    stops = JointStops(lower, upper, stiffness, damping)
    model.require(ca.mmin(upper - lower), "q_min must be below q_max for each joint")
    model.require(
        ROUNDING - ca.mmax(stops.depth(q_start)),
        "q_start must be between q_min and q_max for each joint; start within the range, or widen it",
    )
    return stops


def _stiffness(joints: Joints, inertia: np.ndarray) -> Sequence[float]:
    """Stiffnesses, N.m/rad (N/m), shape (n,), that hold the efforts of joints and suit the inertia against them."""
    wanted = [effort / TRAVEL if effort < NONE else 0.0 for effort in joints.efforts]
    values = np.clip(wanted, SLOWEST**2 * inertia, FASTEST**2 * inertia)
    return [float(f"{value:.1e}") for value in values]
