"""What is examined: a system with an algorithm, a step and a stop time, and how a user asks for other ones."""

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass, replace
from typing import Any

from orchestration.fmi.isolation import Isolation
from orchestration.master.algorithm import ALGORITHMS, Algorithm
from orchestration.system.system import System


@dataclass(frozen=True)
class Case:
    """A run that is examined, and the changes of it that advice proposes.

    Attributes
    ----------
    system
        System, with its components in the order of stepping.
    step, stop_time
        Communication step and stop time, s.
    algorithm
        Co-simulation algorithm.
    order
        Names of the components if an order was proposed; None for that of the system.
    sample_time
        Sampling period of all components that was proposed, s; None for those that the system has.
    values
        Start values that were proposed, by ``component.variable``.
    isolation
        Components whose FMUs live in processes of their own; none if it is None.
    """

    system: System
    step: float
    stop_time: float
    algorithm: Algorithm
    order: tuple[str, ...] | None = None
    sample_time: float | None = None
    values: Mapping[str, float] = field(default_factory=dict)
    isolation: Isolation | None = None

    def but(self, **changes: Any) -> "Case":
        """The case with some attributes changed."""
        return replace(self, **changes)

    @property
    def changed_system(self) -> System:
        """The system with the proposed start values, sampling period and order."""
        system = self.system.set(self.values) if self.values else self.system
        system = system if self.sample_time is None else system.with_sample_time(self.sample_time)
        return system if self.order is None else system.ordered(self.order)

    @property
    def n(self) -> int:
        """Number of steps."""
        return max(1, round(self.duration / self.step))

    @property
    def duration(self) -> float:
        """Time from the start to the stop of the run, s."""
        return self.stop_time - self.system.start_time


Spelling = Callable[[Case], str]
"""A function that says how a user runs a case."""


def in_python(case: Case) -> str:
    """The call of `orchestration.simulate` that runs a case; the system is called ``system``."""
    subject = "system"
    if case.values:
        subject += f".set({dict(case.values)!r})"
    if case.sample_time is not None:
        subject += f".with_sample_time({case.sample_time:g})"
    words = [subject, f"stop_time={case.stop_time:.12g}", f"step={case.step:.12g}"]
    if case.algorithm.name != "gauss-seidel" or not case.algorithm.plain:
        words.append(f"algorithm={_algorithm(case.algorithm)}")
    if case.order is not None:
        words.append(f"order={list(case.order)!r}")
    if case.isolation is not None:
        words.append(f"isolate={True if case.isolation == Isolation() else _call(case.isolation)}")
    return f"simulate({', '.join(words)})"


def _algorithm(algorithm: Algorithm) -> str:
    """An algorithm as Python: its name, or a call with what differs from the defaults."""
    return repr(algorithm.name) if ALGORITHMS.get(algorithm.name) == algorithm else _call(algorithm)


def _call(value: Any) -> str:
    """A call that makes a dataclass, without the arguments that have their defaults."""
    if not is_dataclass(value):
        return repr(value)
    given = []
    for one in fields(value):
        default = one.default_factory() if one.default_factory is not MISSING else one.default
        if getattr(value, one.name) != default:
            given.append(f"{one.name}={_call(getattr(value, one.name))}")
    return f"{type(value).__name__}({', '.join(given)})"
