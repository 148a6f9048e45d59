"""A task: everything that the runs of a campaign have in common."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from orchestration.campaigns.engines.checkout import checkout
from orchestration.campaigns.measuring.measure import Measure
from orchestration.fmi.isolation import Isolation
from orchestration.master.provenance import versions
from orchestration.sandbox.archive import file_hash
from orchestration.system.system import Component, System


@dataclass(frozen=True)
class Task:
    """A system, the start values that rows vary, and what is measured; cloudpickle can send it elsewhere.

    Attributes
    ----------
    system
        System with the start values that all runs share.
    varied
        Start values that rows set, as ``component.variable``; scalars.
    measures
        Measures, their formulas with scalar names.
    stop_time
        Stop time of all runs, s. Runs begin at the start time of the system.
    algorithm
        Name of the algorithm.
    isolation
        Components that live in processes of their own; None lets the engine decide.
    """

    system: System
    varied: tuple[str, ...]
    measures: tuple[Measure, ...]
    stop_time: float
    algorithm: str = "gauss-seidel"
    isolation: Isolation | None = None

    @property
    def measure_names(self) -> tuple[str, ...]:
        """Names of all measured numbers."""
        return tuple(name for measure in self.measures for name in measure.names)

    @property
    def measure_units(self) -> tuple[str, ...]:
        """Units of all measured numbers."""
        return tuple(unit for measure in self.measures for unit in measure.units)

    @cached_property
    def record(self) -> tuple[str, ...] | None:
        """Columns that the measures need, scalars as ``component.variable``; None if they need all outputs alone."""
        return self._needed if all(measure.needed for measure in self.measures) else self.everything

    @cached_property
    def everything(self) -> tuple[str, ...] | None:
        """All outputs and whatever else the measures need; None if that is all outputs alone."""
        more = set(self._needed) - set(self.outputs)
        return tuple(dict.fromkeys((*self.outputs, *self._needed))) if more else None

    @property
    def outputs(self) -> tuple[str, ...]:
        """All outputs but Strings, as ``component.variable``."""
        components = self.system.components
        return tuple(f"{c.name}.{v.name}" for c in components for v in c.description.of_causality("output"))

    @property
    def _needed(self) -> tuple[str, ...]:
        wanted = [column for measure in self.measures for column in measure.needed]
        return tuple(dict.fromkeys(path for column in wanted for path in self.system.elements(column)))

    @cached_property
    def structure(self) -> str:
        """SHA-256 hash of all that decides a run but its start values and its step, as hexadecimal text.

        It covers the content of the FMUs, the connections, the order, the algorithm, the times and the versions of the
        packages that decide the numbers; of adaptimp in a folder of sources also their content. Measures do not count.
        """
        system = self.system
        digests = {path: file_hash(path) for path in {component.path for component in system.components}}
        content = {
            "fmus": [(c.name, digests[c.path], sorted(_renamed(c).items())) for c in system.components],
            "connections": sorted(str(connection) for connection in system.connections),
            "times": [float(system.start_time).hex(), float(self.stop_time).hex()],
            "algorithm": self.algorithm,
            "versions": versions(),
            **checkout(),
        }
        return _hash(content)

    @cached_property
    def start_values(self) -> dict[str, float | str]:
        """All start values in force, those of the FMUs included, by ``component.variable``.

        Start values that rows vary are among them, with the value of the system.
        """
        found: dict[str, float | str] = {}
        for component in self.system.components:
            for name, variable in component.description.variables.items():
                value = component.start.get(name, variable.start)
                if variable.can_start and value is not None:
                    found[f"{component.name}.{name}"] = value
        return found

    @cached_property
    def identity(self) -> str:
        """SHA-256 hash of the structure and of all start values that rows do not vary, as hexadecimal text."""
        values = {path: _exact(value) for path, value in self.start_values.items() if path not in self.varied}
        return _hash({"structure": self.structure, "varied": self.varied, "values": values})

    def system_of(self, values: Sequence[float] | np.ndarray) -> System:
        """The system of one run.

        Parameters
        ----------
        values
            Values of `varied`, shape (n_varied,).

        Raises
        ------
        SystemDescriptionError
            If a value does not have the type of its variable.
        """
        return self.system.set(dict(zip(self.varied, map(float, values), strict=True)))


def _renamed(component: Component) -> dict[str, str]:
    """Names of variables in the FMU where they differ from those in the system."""
    variables = component.description.variables
    return {name: variable.fmu_name for name, variable in variables.items() if variable.fmu_name != name}


def _exact(value: float | str) -> str:
    """A text that tells a value from all others."""
    return f"text {value}" if isinstance(value, str) else float(value).hex()


def _hash(content: object) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
