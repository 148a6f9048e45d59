"""Repulsion of the joints from the ends of their ranges, off by default.

A margin lies inside each end of a joint's range, from q_min to q_max. At the depth d > 0 in a margin, with v the rate
towards the end of the range, the controller adds a torque of the size

    min(limit_torque, max(0, limit_stiffness d + limit_damping min(1, d / limit_margin) v))

which pushes the joint back inside. The torque never pulls the joint outwards, has no jump, and is zero outside of the
margins. With limit_stiffness and limit_damping 0, as at the start, it is zero everywhere.

The torque is added after the law. In a margin the arm is therefore not the one of the paper's theory, and the tip
leaves its target. Estimates of parameters pause while a joint is pushed, so that they do not take the push for a load.
"""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, Formula, Formulas, SampledModel
from fmus.control.impedance import Measured
from fmus.elements import ANGLE, LENGTH
from fmus.mechanics.joints import Joints

MARGIN = 0.1  # rad or m, assumed; in a short range this part of it

FORMULAS = Formulas(
    "Repulsion from the ends of the ranges",
    [
        Formula(
            r"\tau_i \leftarrow \tau_i \mp \min\left( \tau_{\text{limit}}, \; \max\left( 0, \; k\,d"
            r" + b \min(1, d / \delta)\,v \right) \right)",
            "At the depth d in the margin, whose width is limit_margin or delta, joint i is pushed back. k is the"
            " limit_stiffness, b the limit_damping, v the rate towards the end. Off at the start.",
        )
    ],
)


@dataclass(frozen=True)
class Repulsion:
    """Parameters of the repulsion of n joints, shape (n,) each; units in parentheses are those of a slide.

    Attributes
    ----------
    lower, upper
        Ends of the ranges, rad (m).
    margin
        Width of the margins, rad (m).
    stiffness, damping
        N.m/rad (N/m) and N.m.s/rad (N.s/m).
    largest
        Largest torque, N.m (N).
    """

    lower: ca.SX
    upper: ca.SX
    margin: ca.SX
    stiffness: ca.SX
    damping: ca.SX
    largest: ca.SX

    def torque(self, measured: Measured) -> ca.SX:
        """Torques on the joints, N.m (N), shape (n,): positive near the lower end of a range."""
        q, dq = measured.q, measured.dq
        return self._push(self.lower + self.margin - q, -dq) - self._push(q - (self.upper - self.margin), dq)

    def _push(self, depth: ca.SX, rate: ca.SX) -> ca.SX:
        """Size of the torque at a depth, which is negative outside of the margin, and a rate towards the end."""
        d = ca.fmax(depth, 0)
        wanted = self.stiffness * d + self.damping * ca.fmin(1, d / self.margin) * rate
        return ca.fmin(self.largest, ca.fmax(0, wanted))


def declare_repulsion(model: SampledModel, joints: Joints) -> Repulsion:
    """Declare the ranges of the joints, by default those of the robot, and the repulsion from their ends."""
    lower, upper = (
        model.parameter(
            name,
            ends,
            unit=joints.each("rad", "m"),
            display_unit=joints.each(ANGLE, LENGTH),
            description=[f"{text}; {none} = no limit" for text in joints.texts(f"{which} end of the range")],
        )
        for name, ends, which, none in zip(
            ("q_min", "q_max"), joints.ranges, ("Lower", "Upper"), ("-1e9", "1e9"), strict=True
        )
    )
    margin = model.parameter(
        "limit_margin",
        [_margin(high - low) for low, high in zip(*joints.ranges, strict=True)],
        unit=joints.each("rad", "m"),
        display_unit=joints.each(ANGLE, LENGTH),
        limits=POSITIVE,
        description=joints.texts("Width of the margins of repulsion at both ends of the range"),
    )
    stiffness, damping, largest = (
        model.parameter(
            name,
            values,
            unit=joints.each(*units),
            limits=NOT_NEGATIVE,
            tunable=True,
            description=[
                f"{text}; {special}" for text in joints.texts(*(f"{what} of the repulsion" for what in whats))
            ],
        )
        for name, values, units, whats, special in (
            ("limit_stiffness", [0.0] * joints.n, ("N.m/rad", "N/m"), ("Stiffness",), "0 = none"),
            ("limit_damping", [0.0] * joints.n, ("N.m.s/rad", "N.s/m"), ("Damping",), "0 = none"),
            ("limit_torque", joints.efforts, ("N.m", "N"), ("Largest torque", "Largest force"), "1e9 = no limit"),
        )
    )
    model.require(0.5 - ca.sum1(lower > upper), "q_min must not exceed q_max for any joint; exchange or correct them")
    return Repulsion(lower, upper, margin, stiffness, damping, largest)


def _margin(width: float) -> float:
    """Start of the margin, rad or m, for a range of a width; positive also where the joint cannot move."""
    return round(min(MARGIN, MARGIN * width), 10) or MARGIN
