"""A serial chain of rigid bodies as numbers: joints from a fixed base to a tip, each of which moves one body.

The frame of joint i is also the frame of body i. It stands at the joint's `placement` in the frame of joint i - 1
(of the base, for the first joint) and is moved there by q[i]: turned about the joint's axis, or shifted along it.
"""

import re
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from fmus.mechanics.rigid_body import HERE, Body, Placement, RobotError, symmetric

_NUMBERED = re.compile(r"joint[ _-]?(\d+)", re.IGNORECASE)


class JointKind(StrEnum):
    """How a joint moves."""

    REVOLUTE = "revolute"
    """Turns about its axis, between limits."""
    CONTINUOUS = "continuous"
    """Turns about its axis without limits."""
    PRISMATIC = "prismatic"
    """Slides along its axis, between limits."""


@dataclass(frozen=True)
class JointLimits:
    """What a joint can do; infinite where nothing is said.

    Attributes
    ----------
    lower, upper
        Range of q, rad; m for a prismatic joint.
    velocity
        Largest rate, rad/s; m/s for a prismatic joint.
    effort
        Largest torque, N.m; force, N, for a prismatic joint.
    """

    lower: float = -np.inf
    upper: float = np.inf
    velocity: float = np.inf
    effort: float = np.inf


@dataclass(frozen=True)
class Joint:
    """A joint with the body that it moves. Units in parentheses are those of a prismatic joint.

    Attributes
    ----------
    name
        What errors call the joint.
    body
        Body in the frame of the joint.
    placement
        Frame of the joint in that of the joint before, at q = 0.
    axis
        Unit vector in the frame of the joint, shape (3,).
    kind
        How the joint moves.
    limits
        What the joint can do. Equations of motion do not use them.
    damping
        Coefficient of viscous friction, N.m.s/rad (N.s/m).
    friction
        Coulomb friction, N.m (N).
    rotor_inertia
        Inertia of the motor as seen at the joint, gear ratio squared times that of the rotor, kg m2 (kg). The rotor
        turns with its own joint only: gyroscopic effects of spinning rotors are left out, as is usual for large gear
        ratios.

    Raises
    ------
    RobotError
        If a number cannot be.
    """

    name: str
    body: Body
    placement: Placement = HERE
    axis: tuple[float, ...] = (0.0, 0.0, 1.0)
    kind: JointKind = JointKind.REVOLUTE
    limits: JointLimits = field(default_factory=JointLimits)
    damping: float = 0.0
    friction: float = 0.0
    rotor_inertia: float = 0.0

    def __post_init__(self) -> None:
        """Refuse numbers that cannot be."""
        length = np.linalg.norm(self.axis)
        if not abs(length - 1) < 1e-9:
            msg = f"Joint {self.name}: the axis {self.axis} has length {length:g}, not 1; divide it by its length."
            raise RobotError(msg)
        for name in ("damping", "friction", "rotor_inertia"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= 0):
                msg = f"Joint {self.name}: {name} is {value:g}, but must be finite and at least 0; correct it."
                raise RobotError(msg)
        if not self.limits.lower <= self.limits.upper:
            msg = (
                f"Joint {self.name}: the lower limit {self.limits.lower:g} is above the upper limit "
                f"{self.limits.upper:g}; exchange or correct them."
            )
            raise RobotError(msg)

    @property
    def turns(self) -> bool:
        """Whether q is an angle."""
        return self.kind is not JointKind.PRISMATIC

    @property
    def label(self) -> str:
        """What texts call the joint: ``joint shoulder_pan_joint``, and ``joint 2`` for joint2, joint_2 and the like."""
        number = _NUMBERED.fullmatch(self.name)
        return f"joint {number[1] if number else self.name}"


@dataclass(frozen=True)
class Chain:
    """Joints from a base, which does not move, to a tip.

    Attributes
    ----------
    name
        Name of the robot.
    joints
        In the order from the base to the tip, n in number.
    tip
        Frame of the tip in that of the last joint.
    base_name, tip_name
        Names of the frames at both ends.

    Raises
    ------
    RobotError
        If there is no joint, if two have one name, or if a body has no inertia against the motion of its joint.
    """

    name: str
    joints: tuple[Joint, ...]
    tip: Placement = HERE
    base_name: str = "base"
    tip_name: str = "tip"

    def __post_init__(self) -> None:
        """Refuse chains without equations of motion."""
        if not self.joints:
            msg = (
                f"Robot {self.name}: no joint moves between {self.base_name} and {self.tip_name}, so there is nothing "
                "to control; choose another base or tip."
            )
            raise RobotError(msg)
        names = [joint.name for joint in self.joints]
        for name in names:
            if names.count(name) > 1:
                msg = f"Robot {self.name}: {names.count(name)} joints have the name {name}; rename all but one."
                raise RobotError(msg)
        self._check_axial_bodies()
        self._check_last_body()

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.joints)

    @property
    def p(self) -> np.ndarray:
        """Parameters of the dynamics, shape (13 n,).

        Ten of each body in the order of `rigid_body.SYMBOLS`, then the viscous friction of all joints, their Coulomb
        friction, and their rotor inertias.
        """
        joints = self.joints
        return np.concatenate(
            [
                *(joint.body.parameters for joint in joints),
                [joint.damping for joint in joints],
                [joint.friction for joint in joints],
                [joint.rotor_inertia for joint in joints],
            ]
        )

    @property
    def reach(self) -> float:
        """Sum of the distances between the frames from the first joint to the tip, at q = 0, m."""
        steps = [joint.placement for joint in self.joints[1:]] + [self.tip]
        return float(sum(np.linalg.norm(step.p) for step in steps))

    def _check_axial_bodies(self) -> None:
        """Refuse a body of which only I33 is known anywhere but on a first joint that turns about axis 3."""
        for index, joint in enumerate(self.joints):
            fits = index == 0 and joint.turns and joint.axis == (0.0, 0.0, 1.0)
            if joint.body.axial_only and not fits:
                msg = (
                    f"Body {joint.body.name} of joint {joint.name} (number {index + 1}, {joint.kind}, axis "
                    f"{joint.axis}): axial_only is enough for the first joint alone, if it turns about (0, 0, 1); "
                    "give the body all ten numbers."
                )
                raise RobotError(msg)

    def _check_last_body(self) -> None:
        """Refuse a last body that resists the motion of its joint by nothing: the inertia matrix would be singular."""
        joint = self.joints[-1]
        axis, body = np.array(joint.axis), joint.body
        own = axis @ symmetric(body.parameters[4:].tolist()) @ axis if joint.turns else body.mass
        if own + joint.rotor_inertia <= 0:
            unit = "kg m2" if joint.turns else "kg"
            msg = (
                f"Joint {joint.name}: its body {joint.body.name} has an inertia of {own:g} {unit} against its motion, "
                f"and the rotor has {joint.rotor_inertia:g} {unit}, so that any torque accelerates it without limit; "
                "give the body its mass and inertia, or the joint its rotor's."
            )
            raise RobotError(msg)
