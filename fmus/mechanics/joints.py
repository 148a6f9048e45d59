"""What the variables of an FMU need to know of an arm's joints: their names, their units, and what they can do.

A joint that turns has an angle in rad and a torque in N.m. A joint that slides has a position in m and a force in N.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from fmus.mechanics.chain import Chain, JointLimits

NONE = 1e9
"""The value of a limit that is none, in FMUs, whose numbers are finite."""


@dataclass(frozen=True)
class Joints:
    """The joints of an arm, from the base to the tip, n in number.

    Attributes
    ----------
    labels
        What texts call each joint, such as ``joint 1`` or ``joint shoulder_pan_joint``.
    turns
        Whether a joint turns; else it slides.
    limits
        What each joint can do.
    """

    labels: tuple[str, ...]
    turns: tuple[bool, ...]
    limits: tuple[JointLimits, ...]

    @classmethod
    def numbered(cls, n: int) -> "Joints":
        """Joints 1 to n that turn without limits.

        Examples
        --------
        >>> from fmus.mechanics.joints import Joints
        >>> Joints.numbered(2).labels
        ('joint 1', 'joint 2')
        """
        return cls(tuple(f"joint {i + 1}" for i in range(n)), (True,) * n, (JointLimits(),) * n)

    @classmethod
    def of(cls, chain: Chain) -> "Joints":
        """The joints of a chain."""
        joints = chain.joints
        return cls(
            tuple(joint.label for joint in joints),
            tuple(joint.turns for joint in joints),
            tuple(joint.limits for joint in joints),
        )

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.labels)

    @property
    def efforts(self) -> list[float]:
        """Largest torque or force of each joint, N.m or N; `NONE` where there is no limit."""
        return [min(limit.effort, NONE) for limit in self.limits]

    @property
    def ranges(self) -> tuple[list[float], list[float]]:
        """Lower and upper ends of the ranges, rad or m; -`NONE` and `NONE` where there is no limit."""
        return [max(limit.lower, -NONE) for limit in self.limits], [min(limit.upper, NONE) for limit in self.limits]

    def each(self, turning: str, sliding: str) -> Sequence[str]:
        """A text for each joint, such as the unit of a rate: one for those that turn, another one for slides."""
        return [turning if turns else sliding for turns in self.turns]

    def texts(self, turning: str, sliding: str = "") -> Sequence[str]:
        """Descriptions of a vector with one element for each joint: ``Angle of joint 1``, ``Position of joint lift``.

        Parameters
        ----------
        turning, sliding
            What the element of a joint is that turns, and of one that slides; `turning` for both by default.
        """
        whats = self.each(turning, sliding or turning)
        return [f"{what} of {label}" for what, label in zip(whats, self.labels, strict=True)]
