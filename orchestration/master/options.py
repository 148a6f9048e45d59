"""How a run is made, besides the system, its duration, its step and its algorithm."""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field

from orchestration.errors import SystemDescriptionError

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Crossings:
    """Outputs whose change of sign ends a step.

    Attributes
    ----------
    outputs
        As ``component.variable``, Real.
    tolerance
        How closely the change is located, s.
    """

    outputs: Sequence[str] = ()
    tolerance: float = 1e-9

    def __post_init__(self) -> None:
        """Refuse a tolerance that cannot be met."""
        if not (math.isfinite(self.tolerance) and self.tolerance > 0):
            msg = f"The tolerance of crossings, {self.tolerance!r} s, is not positive and finite."
            raise SystemDescriptionError(msg)


@dataclass(frozen=True)
class Options:
    """Choices that have a default.

    Attributes
    ----------
    record
        Outputs to record as ``component.variable``; None records all.
    every
        Of how many steps one is recorded; row 0 always is.
    start_time
        Time of row 0, s.
    strict
        Whether an unconnected input is an error instead of a warning.
    allow_stale_inputs
        Whether a sampling period may be shorter than, or no multiple of, the step; ticks within a
        step then use the inputs of its start.
    ratios
        Multirate: how many communication steps one step of a component takes, by name. A sampled
        component shows its outputs at once, a continuous one when their time has come.
    crossings
        Outputs whose change of sign ends a step; the step after it extrapolates nothing.
    progress
        Called now and then with (steps made, steps in all).
    """

    record: Collection[str] | None = None
    every: int = 1
    start_time: float = 0.0
    strict: bool = False
    allow_stale_inputs: bool = False
    ratios: Mapping[str, int] = field(default_factory=dict)
    crossings: Crossings = field(default_factory=Crossings)
    progress: Progress | None = None

    def __post_init__(self) -> None:
        """Check numbers."""
        if not (isinstance(self.every, int) and self.every >= 1):
            msg = f"every = {self.every!r}: every n-th step is recorded, n an integer of at least 1."
            raise SystemDescriptionError(msg)
        for name, ratio in self.ratios.items():
            if not (isinstance(ratio, int) and ratio >= 1):
                msg = f"{name}: the ratio {ratio!r} of its step to the communication step is no positive integer."
                raise SystemDescriptionError(msg)

    @property
    def slow(self) -> bool:
        """Whether a component makes longer steps than others."""
        return any(ratio != 1 for ratio in self.ratios.values())
