"""Checks that the FMU of a model can repeat a reference run: the tables of inputs and results fit the model."""

import csv
import io
from collections.abc import Collection, Mapping, Sequence
from itertools import pairwise

from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.model import Model
from adaptimp_fmu.names import suggestion
from adaptimp_fmu.references import ReferenceRun, finite
from adaptimp_fmu.variables import Role

TIME = "time"
_NEAR = 1e-9  # of the longest time: times are written with ten digits


def require_repeatable(model: Model, run: ReferenceRun) -> None:
    """Refuse a run that the model's FMU cannot repeat.

    Raises
    ------
    DefinitionError
        If a column is not a variable that can be set or an output, if a row is damaged, or if the rows do not fit the
        experiment.
    """
    stated = run.experiment.stated()
    outputs = [variable.name for variable in model.with_role(Role.OUTPUT)]
    settable = [variable.name for variable in model.with_role(Role.INPUT, Role.TUNABLE_PARAMETER)]
    where = f"{model.name}: reference run {run.name}"
    results = _columns(run.results, f"{where}: the results", outputs, "an output")
    times = results[TIME]
    tolerance = _NEAR * max(stated["step_size"], abs(stated["stop_time"]))
    for row, (end, what) in {0: ("start_time", "first"), -1: ("stop_time", "last")}.items():
        if not abs(times[row] - stated[end]) <= tolerance:
            msg = f"{where}: the {what} row of the results is at {times[row]!r} s, but {end} is {stated[end]!r} s."
            raise DefinitionError(msg)
    if run.inputs:
        inputs = _columns(run.inputs, f"{where}: the inputs", settable, "an input or a tunable parameter")
        if inputs[TIME][0] > stated["start_time"] + tolerance:
            msg = f"{where}: the inputs begin at {inputs[TIME][0]!r} s, after start_time {stated['start_time']!r} s."
            raise DefinitionError(msg)


def _columns(content: bytes, where: str, known: Collection[str], kind: str) -> Mapping[str, Sequence[float]]:
    """Numbers of a table by name of the column; times rise."""
    names, *rows = _rows(content, where)
    for name in names[1:]:
        if name not in known:
            msg = f"{where} have a column {name}, which is not {kind}; {suggestion(name, known)}"
            raise DefinitionError(msg)
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        msg = f"{where} have two columns {twice}; remove one."
        raise DefinitionError(msg)
    numbers = [
        [finite(text, f"{where}: row {index}, {name}") for name, text in zip(names, row, strict=True)]
        for index, row in enumerate(rows, 1)
    ]
    columns = dict(zip(names, zip(*numbers, strict=True), strict=True))
    for index, (before, after) in enumerate(pairwise(columns[TIME]), 2):
        if not before < after:
            msg = f"{where}: row {index} is at {after!r} s, not later than the row before it, at {before!r} s."
            raise DefinitionError(msg)
    return columns


def _rows(content: bytes, where: str) -> list[list[str]]:
    """Names, then the texts of each row, all of one length."""
    try:
        rows = [row for row in csv.reader(io.StringIO(content.decode("utf-8"))) if row]
    except UnicodeDecodeError as error:
        msg = f"{where} are not a text in UTF-8; write them as CSV."
        raise DefinitionError(msg) from error
    if len(rows) < 2 or rows[0][0] != TIME:
        msg = f"{where} are not a table; the first column must be called {TIME}, and rows of numbers must follow."
        raise DefinitionError(msg)
    for index, row in enumerate(rows[1:], 1):
        if len(row) != len(rows[0]):
            msg = f"{where} have {len(rows[0])} columns, but row {index} has {len(row)} numbers."
            raise DefinitionError(msg)
    return rows
