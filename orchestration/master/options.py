"""Choices for a run beyond its system, duration, step and algorithm: rows, multirate, crossings."""

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

    Examples
    --------
    The arm touches its wall somewhere within a step, and a row is recorded there:

    >>> from orchestration import Crossings, Options, scenario, simulate
    >>> options = Options(crossings=Crossings(["plant.gap"], tolerance=1e-9))
    >>> result = simulate(scenario("fig2"), stop_time=0.92, record="plant.gap", options=options)
    >>> touch = abs(result["plant.gap"]).argmin()
    >>> round(float(result.time[touch]), 6), bool(abs(result["plant.gap"][touch]) < 1e-8)
    (0.917583, True)
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
    """Choices for a run that all have a default.

    Attributes
    ----------
    record
        Outputs to record: names ``component.variable``, names of arrays, or patterns with ``*`` and ``?``.
        Default: all outputs.
    every
        Every n-th step is recorded. Row 0 is always recorded.
    start_time
        Time of row 0, s.
    strict
        Whether an unconnected input is an error instead of a warning.
    allow_stale_inputs
        Whether a sampling period need not be a multiple of the step. A tick within a step then uses the
        inputs of the beginning of the step.
    ratios
        Multirate: the number of communication steps that one step of a component takes, by component
        name. A sampled component shows its outputs at the beginning of its step, a continuous component
        at the end.
    crossings
        Outputs whose change of sign ends a step. The step after a crossing extrapolates nothing.
    progress
        Function that is called now and then with two numbers: the steps made, and all steps of the run.

    Raises
    ------
    SystemDescriptionError
        If `every` or a ratio is not a positive integer.

    Examples
    --------
    >>> from orchestration import Options, scenario, simulate
    >>> result = simulate(scenario("fig2"), stop_time=1.0, options=Options(every=100, strict=True))
    >>> len(result.time), float(result.time[1])  # a row in 100 steps of 0.1 ms
    (101, 0.01)
    """

    record: str | Collection[str] | None = None
    every: int = 1
    start_time: float = 0.0
    strict: bool = False
    allow_stale_inputs: bool = False
    ratios: Mapping[str, int] = field(default_factory=dict)
    crossings: Crossings = field(default_factory=Crossings)
    progress: Progress | None = None

    def __post_init__(self) -> None:
        """Refuse numbers that are not positive integers."""
        if isinstance(self.record, str):
            object.__setattr__(self, "record", (self.record,))
        if self.record is not None and not all(isinstance(name, str) for name in self.record):
            wrong = next(name for name in self.record if not isinstance(name, str))
            msg = f"record has {wrong!r}; names of outputs are needed, such as 'plant.x[1]'."
            raise SystemDescriptionError(msg)
        if not (isinstance(self.every, int) and self.every >= 1):
            msg = f"every = {self.every!r}: every n-th step is recorded, where n is an integer of at least 1."
            raise SystemDescriptionError(msg)
        for name, ratio in self.ratios.items():
            if not (isinstance(ratio, int) and ratio >= 1):
                msg = f"{name}: the ratio {ratio!r} of its step to the communication step is not a positive integer."
                raise SystemDescriptionError(msg)

    @property
    def slow(self) -> bool:
        """Whether a component makes steps that are longer than the communication step."""
        return any(ratio != 1 for ratio in self.ratios.values())
