"""A scenario: the FMUs of a run, and its start values with their origins."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from orchestration.fmi.description import SAMPLE_TIME
from orchestration.paper.numbers import PERIOD
from orchestration.system.system import System


@dataclass(frozen=True)
class Value:
    """A start value and where it comes from.

    Attributes
    ----------
    number
        In the unit of the variable.
    origin
        ``"V"`` for a number stated in section V, else ``"assumed: "`` and the reason.
    """

    number: float
    origin: str

    @property
    def assumed(self) -> bool:
        """Whether the paper leaves the number open."""
        return self.origin.startswith("assumed")


@dataclass(frozen=True)
class Scenario:
    """A run that the paper shows or claims something about.

    Attributes
    ----------
    models
        Component name to model identifier, in the order of stepping.
    values
        Start values by ``component.variable``.
    step
        Communication step and sampling period, s.
    sampling
        ``"assumed: "`` and the reason for the sampling period.
    sources
        Outputs by the input that they feed, in the place of outputs of the input's name: ``component.variable``.
    """

    name: str
    caption: str
    models: Mapping[str, str]
    values: Mapping[str, Value]
    step: float
    sampling: str
    stop_time: float = PERIOD  # s, V: one turn of the ellipse
    sources: Mapping[str, str] = field(default_factory=dict)

    def system(self, fmus: Mapping[str, Path]) -> System:
        """The system that is run, with the reasons for its assumed values, from FMU files by model identifier."""
        files = {component: fmus[identifier] for component, identifier in self.models.items()}
        system = System.connected_by_name(self.name, files, step=self.step, stop_time=self.stop_time)
        for taken, source in self.sources.items():
            free = set(system.elements(taken))
            kept = [c for c in system.connections if f"{c.target}.{c.input}" not in free]
            system = replace(system, connections=tuple(kept)).connect(f"{source} -> {taken}")
        numbers = {path: value.number for path, value in self.values.items()}
        assumptions = {path: value.origin for path, value in self.values.items() if value.assumed}
        sampled = [component.name for component in system.components if component.sample_time is not None]
        assumptions |= {f"{name}.{SAMPLE_TIME}": self.sampling for name in sampled}
        return replace(system.set(numbers).with_sample_time(self.step), assumptions=assumptions)
