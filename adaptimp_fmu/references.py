"""What an FMU carries for other tools beside its definition: runs that they can repeat, and sets of parameter values.

A row of a run's inputs is set at its time, before the step from there. A row of the results holds the outputs after
initialization (the first row) or at the end of the step that ends at its time. Tables have the form of the FMI
cross-check: the first column is ``time``, in s, and names are quoted where they need it.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.metadata import Experiment
from adaptimp_fmu.variables import element_names

_FILE_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*", re.ASCII)
_OPTIONS = {"StartTime": "start_time", "StopTime": "stop_time", "StepSize": "step_size", "RelTol": "tolerance"}


@dataclass(frozen=True)
class ReferenceRun:
    r"""A run of an FMU alone: its inputs over time, and the outputs that every tool must see.

    Attributes
    ----------
    name
        Name of the run and of its files: letters, digits and ``_.-``.
    experiment
        Start and stop time, communication step and tolerance; none may be missing. The tolerance is the largest
        deviation of an output over the largest absolute value of its column.
    results
        Table of the outputs as CSV.
    inputs
        Table of inputs and tunable parameters as CSV; empty if nothing is set during the run.
    description
        One line for the user.

    Raises
    ------
    DefinitionError
        If the experiment is incomplete, or the name cannot be that of a file.

    Examples
    --------
    >>> from adaptimp_fmu import ContinuousModel, Experiment, ReferenceRun
    >>> clock = ContinuousModel("Clock", "Time as an output")
    >>> clock.output("t", clock.time, unit="s", description="Time")
    >>> experiment = Experiment(start_time=0.0, stop_time=0.2, step_size=0.1, tolerance=1e-9)
    >>> clock.reference_runs = [ReferenceRun("ticking", experiment, results=b"time,t\n0,0\n0.1,0.1\n0.2,0.2\n")]

    From arrays, and from files as those of the FMI cross-check:

    >>> import numpy as np
    >>> from pathlib import Path
    >>> times = np.array([0.0, 0.1, 0.2])  # s
    >>> run = ReferenceRun.from_columns("ticking", experiment, {"time": times, "t": times})
    >>> _ = Path("ticking_ref.csv").write_bytes(run.results)
    >>> _ = Path("ticking_ref.opt").write_text("StartTime,0\nStopTime,0.2\nStepSize,0.1\nRelTol,1e-9\n")
    >>> ReferenceRun.read(Path(), "ticking") == run
    True
    """

    name: str
    experiment: Experiment
    results: bytes
    inputs: bytes = b""
    description: str = ""

    def __post_init__(self) -> None:
        """Refuse what another tool could not repeat."""
        _require_file_name(self.name, "Reference run")
        missing = [field.name for field in fields(Experiment) if field.name not in self.experiment.stated()]
        if missing:
            msg = f"Reference run {self.name}: the experiment states no {missing[0]}; give all four numbers."
            raise DefinitionError(msg)

    @classmethod
    def from_columns(
        cls,
        name: str,
        experiment: Experiment,
        results: Mapping[str, np.ndarray],
        inputs: Mapping[str, np.ndarray] | None = None,
        description: str = "",
    ) -> "ReferenceRun":
        """Make a run from arrays; the tables hold all digits.

        Parameters
        ----------
        results, inputs
            Columns by name, shape (n,) each. The first column is ``time``, in s.
        """
        driven = b"" if inputs is None else _table(inputs)
        return cls(name, experiment, _table(results), driven, description)

    @classmethod
    def read(cls, folder: Path, name: str, description: str = "") -> "ReferenceRun":
        """Read a run in the form of the FMI cross-check.

        Parameters
        ----------
        folder
            Folder with ``NAME_ref.csv``, ``NAME_ref.opt`` and, if the FMU has inputs, ``NAME_in.csv``.
        name
            Name of the run and beginning of the names of its files.
        description
            One line for the user.

        Raises
        ------
        DefinitionError
            If the options lack a number.
        OSError
            If a file cannot be read.
        """
        stated = {}
        for line in (folder / f"{name}_ref.opt").read_text(encoding="utf-8").splitlines():
            option, _, text = line.partition(",")
            if option in _OPTIONS:
                stated[_OPTIONS[option]] = finite(text, f"{name}_ref.opt: {option}")
        inputs = folder / f"{name}_in.csv"
        driven = inputs.read_bytes() if inputs.exists() else b""
        return cls(name, Experiment(**stated), (folder / f"{name}_ref.csv").read_bytes(), driven, description)


@dataclass(frozen=True)
class ParameterSet:
    """Values of some parameters of a model, under a name.

    Attributes
    ----------
    name
        Name of the set and of its file: letters, digits and ``_.-``.
    values
        Value by name of the parameter, in the unit of the parameter; a sequence for an array.
    description
        One line for the user.
    variants
        Names of the cases that the set is for. Default: the name of the set.

    Raises
    ------
    DefinitionError
        If the name cannot be that of a file.

    Examples
    --------
    >>> from adaptimp_fmu import ParameterSet, SampledModel
    >>> model = SampledModel("Gain", "A gain")
    >>> k = model.parameter("k", [2.0, 3.0], unit="N/m", description="Gain for each axis")
    >>> model.parameter_sets = [ParameterSet("soft", {"k": [0.5, 0.5]}, "A gain for a soft wall")]
    >>> list(model.parameter_sets[0].scalars())
    [('k[1]', 0.5), ('k[2]', 0.5)]
    """

    name: str
    values: Mapping[str, float | Sequence[float] | np.ndarray]
    description: str = ""
    variants: Sequence[str] = ()

    def __post_init__(self) -> None:
        """Refuse a name that not every file system takes."""
        _require_file_name(self.name, "Parameter set")

    def scalars(self) -> Iterator[tuple[str, float]]:
        """Names and values of all scalars; arrays by element."""
        for name, value in self.values.items():
            numbers = np.asarray(value, dtype=float)
            shape = numbers.size if numbers.ndim else None
            yield from zip(element_names(name, shape), np.atleast_1d(numbers).tolist(), strict=True)


def _table(columns: Mapping[str, np.ndarray]) -> bytes:
    """Columns as CSV, with numbers that read back as they are."""
    rows = zip(*(np.asarray(column, dtype=float).tolist() for column in columns.values()), strict=True)
    lines = [",".join(f'"{name}"' for name in columns), *(",".join(map(repr, row)) for row in rows)]
    return "".join(f"{line}\n" for line in lines).encode()


def finite(text: str, where: str) -> float:
    """Read a finite number; a text that is none is refused with a `DefinitionError` that begins with `where`."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        msg = f"{where}: {text!r} is not a finite number."
        raise DefinitionError(msg)
    return value


def _require_file_name(name: str, what: str) -> None:
    """Refuse a name that cannot be that of a file on every platform, with a `DefinitionError`."""
    if not _FILE_NAME.fullmatch(name):
        msg = f"{what} {name!r} names a file in the FMU; use letters, digits and _.- only."
        raise DefinitionError(msg)
