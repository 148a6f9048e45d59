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
from fmus.elements import ANGLE, of_joints
from fmus.mechanics.spatial_arm import SpatialArm

OFF = 1e9
"""rad or m, a limit that is none."""
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


def declare_joint_stops(model: ContinuousModel, arm: SpatialArm, q_start: ca.SX, near: Sequence[float]) -> JointStops:
    """Declare the ranges of the joints, by default those of the chain, and their stops.

    Parameters
    ----------
    q_start
        Symbols of the joint coordinates at the start, shape (n,), which must be within the ranges.
    near
        Joint coordinates, shape (n,), whose inertia the default stiffness suits.
    """
    joints, n = arm.chain.joints, arm.chain.n
    shown = [ANGLE if joint.turns else "" for joint in joints]

    def each(turning: str, sliding: str) -> Sequence[str]:
        return [turning if joint.turns else sliding for joint in joints]

    lower = model.parameter(
        "q_min",
        [max(joint.limits.lower, -OFF) for joint in joints],
        unit=each("rad", "m"),
        display_unit=shown,
        description=[f"{text}; -1e9 = none" for text in of_joints("Lower end of the range", n)],
    )
    upper = model.parameter(
        "q_max",
        [min(joint.limits.upper, OFF) for joint in joints],
        unit=each("rad", "m"),
        display_unit=shown,
        description=[f"{text}; 1e9 = none" for text in of_joints("Upper end of the range", n)],
    )
    stiffness = model.parameter(
        "stop_stiffness",
        _stiffness(arm, near),
        unit=each("N.m/rad", "N/m"),
        limits=POSITIVE,
        description=of_joints("Stiffness of the stops", n),
    )
    damping = model.parameter(
        "stop_damping",
        [DAMPING] * n,
        unit=each("s/rad", "s/m"),
        limits=NOT_NEGATIVE,
        description=of_joints("Damping of the stops, relative gain of their torque per rate,", n),
    )
    stops = JointStops(lower, upper, stiffness, damping)
    model.require(ca.mmin(upper - lower), "q_min must be below q_max for each joint")
    model.require(
        ROUNDING - ca.mmax(stops.depth(q_start)),
        "q_start must be between q_min and q_max for each joint; start within the range, or widen it",
    )
    return stops


def _stiffness(arm: SpatialArm, q: Sequence[float]) -> Sequence[float]:
    """Stiffnesses, N.m/rad (N/m), shape (n,), that hold the efforts of joints and suit the inertia against them."""
    H = np.array(ca.DM(arm.inertia(q, arm.chain.p)))
    against = 1 / np.diag(np.linalg.inv(H))
    efforts = [joint.limits.effort for joint in arm.chain.joints]
    wanted = [effort / TRAVEL if np.isfinite(effort) else 0.0 for effort in efforts]
    values = np.clip(wanted, SLOWEST**2 * against, FASTEST**2 * against)
    return [float(f"{value:.1e}") for value in values]
