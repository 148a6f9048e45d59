"""Choices for a run beyond its system, duration, step and algorithm: rows, multirate, crossings."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.given import a_number, positive, require_names, require_type, shown
from orchestration.fmi.isolation import Isolation
from orchestration.master.changes import Changes, times_of
from orchestration.master.pacing import Pace

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
    (0.906682, True)
    """

    outputs: Sequence[str] = ()
    tolerance: float = 1e-9

    def __post_init__(self) -> None:
        """Refuse a tolerance that cannot be met."""
        require_names("crossings", self.outputs, "'plant.gap'")
        if isinstance(self.outputs, str):
            object.__setattr__(self, "outputs", (self.outputs,))
        positive("The tolerance of crossings", self.tolerance)


@dataclass(frozen=True)
class Options:
    """Choices for a run that all have a default.

    Attributes
    ----------
    record
        Variables to record: names ``component.variable`` or names of arrays, of any causality, or patterns with ``*``
        and ``?``, which choose outputs. Default: all outputs.
    every
        Every n-th step is recorded. Row 0 is always recorded.
    start_time
        Time of row 0, s. Default: the start time of the system.
    strict
        Whether an unconnected input, and an FMU that breaks a rule of form, is an error instead of a warning.
    allow_stale_inputs
        Whether a sampling period need not be a multiple of the step. A tick within a step then uses the
        inputs of the beginning of the step.
    allow_nan
        Whether a run goes on when a recorded value is NaN or infinite, and keeps the value. By default it is an error.
        Iterations, step control and a verdict on stability refuse such values in any case.
    fmu_tolerance
        Relative tolerance that every FMU is told for its own solver. Default: that of its default experiment, if any.
    fmu_stop_time
        Whether the FMUs are told the stop time of the run, beyond which FMI then forbids them to compute.
    ratios
        Multirate: the number of communication steps that one step of a component takes, by component
        name. A sampled component shows its outputs at the beginning of its step, a continuous component
        at the end.
    crossings
        Outputs whose change of sign ends a step. The step after a crossing extrapolates nothing.
    progress
        Function that is called now and then with two numbers: the steps made, and all steps of the run.
    inputs
        Time series for inputs without a connection, see `orchestration.simulate`.
    changes
        Values that change during the run, by time, see `orchestration.simulate`.
    pace
        Simulated seconds per second of the clock, or a `Pace`. Default: as fast as possible.
    isolate
        Components whose FMUs live in processes of their own, so that a crash ends one run only: True for all, names,
        or an `Isolation` with limits. Default: none.

    Raises
    ------
    SystemDescriptionError
        If `every` or a ratio is not a positive integer, or the pace is not a positive number.

    Examples
    --------
    >>> from orchestration import Options, scenario, simulate
    >>> result = simulate(scenario("fig2"), stop_time=1.0, options=Options(every=100, strict=True))
    >>> len(result.time), float(result.time[1])  # a row in 100 steps of 0.1 ms
    (101, 0.01)
    >>> Options(isolate=["plant"]).isolation.covers("plant"), Options(ratios={"plant": 10}).slow
    (True, True)
    """

    record: str | Collection[str] | None = None
    every: int = 1
    start_time: float | None = None
    strict: bool = False
    allow_stale_inputs: bool = False
    allow_nan: bool = False
    fmu_tolerance: float | None = None
    fmu_stop_time: bool = True
    ratios: Mapping[str, int] = field(default_factory=dict)
    crossings: Crossings = field(default_factory=Crossings)
    progress: Progress | None = None
    inputs: Any = None
    changes: Changes | None = None
    pace: float | Pace | None = None
    isolate: bool | str | Collection[str] | Isolation | None = None

    def __post_init__(self) -> None:
        """Refuse numbers that are not positive integers."""
        if self.record is not None:
            require_names("record", self.record, "'plant.x[1]'")
        if isinstance(self.record, str):
            object.__setattr__(self, "record", (self.record,))
        self._require_types()
        if not _counts(self.every):
            msg = f"every = {self.every!r}: every n-th step is recorded, where n is an integer of at least 1."
            raise SystemDescriptionError(msg)
        object.__setattr__(self, "pace", Pace.of(self.pace))
        object.__setattr__(self, "isolate", Isolation.of(self.isolate))
        if self.changes is not None:
            times_of(self.changes)
        for name, ratio in self.ratios.items():
            if not _counts(ratio):
                msg = f"{name}: the ratio {ratio!r} of its step to the communication step is not a positive integer."
                raise SystemDescriptionError(msg)

    def _require_types(self) -> None:
        """Refuse values of another type."""
        if self.start_time is not None:
            a_number("start_time", self.start_time)
        if self.fmu_tolerance is not None:
            positive("fmu_tolerance", self.fmu_tolerance, unit="")
        for name in ("strict", "allow_stale_inputs", "allow_nan", "fmu_stop_time"):
            require_type(name, getattr(self, name), bool, "give True or False")
        require_type("ratios", self.ratios, Mapping, 'give one for each component, as {"plant": 2}')
        require_type("crossings", self.crossings, Crossings, "give Crossings, as Crossings(['plant.gap'])")
        if self.progress is not None and not callable(self.progress):
            msg = f"progress is {shown(self.progress)}; give a function of two numbers, or progress=True to simulate."
            raise SystemDescriptionError(msg)

    @property
    def isolation(self) -> Isolation | None:
        """Which components are isolated, and how; None if none is."""
        return Isolation.of(self.isolate)

    @property
    def slow(self) -> bool:
        """Whether a component makes steps that are longer than the communication step."""
        return any(ratio != 1 for ratio in self.ratios.values())


def _counts(value: object) -> bool:
    """Whether a value is an integer of at least 1; True is a truth value."""
    return isinstance(value, int) and not isinstance(value, bool) and value >= 1
