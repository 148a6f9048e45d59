"""Jobs for other tools, and the records that they answer; needs the standard library and numpy only."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

FMU, SYSTEM = "fmu", "system"
INDEX, NANOSECONDS = "index", "nanoseconds"
JACOBI, GAUSS_SEIDEL, LOOP_AT_ONCE = "jacobi", "gauss-seidel", "loop at once"


class ToolError(RuntimeError):
    """A tool refused a job, or could not finish it; the message is the tool's own."""


@dataclass(frozen=True)
class Tool:
    """Who runs a job, and what its rows are to be compared with.

    Attributes
    ----------
    key
        Name of its module in `tests.interop.matrix.tools`.
    title
        Head of its column.
    distribution
        Package of PyPI whose version counts.
    kinds
        What it runs: `FMU`, `SYSTEM`, or both.
    inputs
        How the inputs of an FMU alone go in; empty for tools that run no FMU.
    algorithm
        Ours that its systems are compared with: `JACOBI`, `GAUSS_SEIDEL`, or `LOOP_AT_ONCE`, which steps components
        without connected inputs first and all others at once.
    clock
        `INDEX` for t_k = k h, `NANOSECONDS` for t_k = (k ns) / 1e9 and steps that are their differences.
    requirements
        Requirements of an environment of its own; empty if the project's development environment has it.
    longest
        Steps of a system that it is given at most: slow tools get the beginning.
    """

    key: str
    title: str
    distribution: str
    kinds: tuple[str, ...]
    inputs: str = ""
    algorithm: str = JACOBI
    clock: str = INDEX
    requirements: tuple[str, ...] = ()
    longest: int = 10**9


@dataclass(frozen=True)
class Part:
    """A component of a job.

    Attributes
    ----------
    start
        Start values by variable that are not the FMU's own; Booleans are 0 or 1.
    initial
        Values of all inputs when initialization has settled.
    types, references, causalities
        By variable: Real, Integer or Boolean; value reference; causality.
    """

    name: str
    fmu: str
    start: dict[str, float]
    initial: dict[str, float]
    types: dict[str, str]
    references: dict[str, int]
    causalities: dict[str, str]

    def names(self, causality: str) -> list[str]:
        """Its variables of a causality, in the order of modelDescription.xml."""
        return [name for name, found in self.causalities.items() if found == causality]

    def value(self, name: str, number: float) -> float | int | bool:
        """A number in the type of the variable."""
        return {"Real": float, "Integer": int, "Boolean": bool}[self.types[name]](number)


@dataclass(frozen=True)
class Job:
    """What to simulate, from t = 0 in equal steps.

    Attributes
    ----------
    kind
        `FMU`: one component, driven by `stimulus`; `SYSTEM`: components and connections.
    ssp
        The same as an SSP package; that of an FMU has row 0 of the stimulus as start values.
    connections
        As (component, output, component, input).
    columns
        What is to be recorded, as ``component.variable``.
    stimulus
        By ``component.variable``, what is set at t_k before the step from there, n_steps + 1 values.
    """

    name: str
    kind: str
    step: float
    n_steps: int
    ssp: str
    parts: tuple[Part, ...]
    connections: tuple[tuple[str, str, str, str], ...]
    columns: tuple[str, ...]
    stimulus: dict[str, list[float]] = field(default_factory=dict)

    def part(self, name: str) -> Part:
        """A component by name."""
        return next(part for part in self.parts if part.name == name)

    def split(self, column: str) -> tuple[Part, str]:
        """The component and the variable of a column."""
        component, _, variable = column.partition(".")
        return self.part(component), variable

    def write(self, path: Path) -> None:
        """Write it as JSON, which keeps every bit of a float."""
        path.write_text(json.dumps(asdict(self)), encoding="utf-8")

    @classmethod
    def read(cls, path: Path) -> "Job":
        """Read what `write` wrote."""
        about: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        about["parts"] = tuple(Part(**part) for part in about["parts"])
        about["connections"] = tuple(tuple(c) for c in about["connections"])
        about["columns"] = tuple(about["columns"])
        return cls(**about)


@dataclass(frozen=True)
class Record:
    """What a tool shows.

    Attributes
    ----------
    values
        Shape (rows, len(columns)); empty if the tool checks and does not simulate.
    columns
        Names, all of the job's or those that the tool can show.
    first
        Step of the first row: 1 for tools that do not show what initialization gave.
    resolution
        Largest error of a number by rounding in the tool's file, absolute.
    """

    values: np.ndarray
    columns: tuple[str, ...]
    first: int = 0
    resolution: float = 0.0

    def write(self, path: Path) -> None:
        """Write it as an archive of numpy."""
        np.savez(path, values=self.values, columns=self.columns, first=self.first, resolution=self.resolution)

    @classmethod
    def read(cls, path: Path) -> "Record":
        """Read what `write` wrote."""
        with np.load(path) as found:
            columns = tuple(str(name) for name in found["columns"])
            return cls(found["values"], columns, int(found["first"]), float(found["resolution"]))


CHECKED = Record(np.empty((0, 0)), ())


def ordered(job: Job, series: Mapping[str, Any], first: int = 0) -> Record:
    """A record of the series by column that a tool has, in the job's order."""
    columns = tuple(name for name in job.columns if name in series)
    return Record(np.column_stack([np.asarray(series[name], dtype=float) for name in columns]), columns, first)


def require_constant_parameters(job: Job) -> None:
    """Refuse a job that drives parameters, for tools that set them before the start only."""
    for path, values in job.stimulus.items():
        part, name = job.split(path)
        if part.causalities[name] == "parameter" and len(set(values)) > 1:
            msg = f"{name} changes over time; the tool sets parameters before the start only"
            raise ToolError(msg)
