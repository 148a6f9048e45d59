"""Measures: the numbers that a campaign keeps of each run."""

import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.campaigns.measuring.code_identity import function_identity
from orchestration.errors import StudyError, printable
from orchestration.fmi.given import require_names, shown

if TYPE_CHECKING:
    from orchestration.results.measures.formula import Formula
    from orchestration.results.result import Result

MeasureFunction = Callable[["Result"], Any]
"""Returns a number, or a mapping from each name of the measure to a number."""


@dataclass(frozen=True)
class Measure:
    """One or several numbers of a run, by a formula over its columns or by a function of its result.

    Attributes
    ----------
    names
        Names of the numbers, which become columns of the table.
    units
        Unit of each number; an empty text where there is none.
    formula
        What a formula measures; None of a function.
    function
        Function of a `Result` that returns a number, or a mapping from each of `names` to a number; None of a formula.
    columns
        Columns of the result that the function reads, as ``component.variable``, arrays allowed; all outputs if empty.

    Examples
    --------
    A function that says what it reads lets all other columns be left out:

    >>> from orchestration import Measure, Study, scenario
    >>> def reach(result):
    ...     return result["plant.x[1]"].max() - result["plant.x[1]"].min()
    >>> measure = Measure.of(reach, unit="m", columns=["plant.x"])
    >>> study = Study(scenario("fig2"), measure=measure, stop_time=0.2).grid({"plant.mu": [0.0, 0.2]})
    >>> study.run()["reach"].attrs["units"]
    'm'

    It can also be tried on a result:

    >>> from orchestration import simulate
    >>> result = simulate(scenario("fig2"), stop_time=0.2)
    >>> [round(value, 3) for value in measure.values(result)], measure.label, measure.needed
    ([0.286], 'reach', ('plant.x',))
    >>> len(measure.identity), measure.expanded(scenario("fig2").elements) is measure
    (64, True)
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    formula: "Formula | None" = None
    function: MeasureFunction | None = None
    columns: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        function: MeasureFunction,
        name: str | Sequence[str] | None = None,
        unit: str | Sequence[str] = "",
        columns: str | Sequence[str] = (),
    ) -> "Measure":
        """Make a measure of a function.

        Parameters
        ----------
        function
            Takes a `Result`, and returns a number or a mapping from each name to a number.
        name
            Name, or names of the mapping. Default: the name of the function.
        unit
            Unit, or the unit of each name.
        columns
            Columns that the function reads. Default: all outputs.

        Raises
        ------
        StudyError
            If there is no name, or names and units differ in number.
        """
        if not callable(function):
            msg = f"A measure is {shown(function)}; give a function of a Result."
            raise StudyError(msg)
        given = getattr(function, "__name__", "") if name is None else name
        names = (given,) if isinstance(given, str) else tuple(given)
        for text in names:
            if not isinstance(text, str) or not text.strip() or text == "<lambda>":
                msg = f'A measure has the name {shown(text)}; give one with it, as ("reach", "m", function).'
                raise StudyError(msg)
        units = (unit,) * len(names) if isinstance(unit, str) else tuple(unit)
        if len(units) != len(names):
            msg = (
                f"Measure {', '.join(names)}: {len(names)} names, but {len(units)} units; give one unit for each name."
            )
            raise StudyError(msg)
        require_names(f"The columns of measure {', '.join(names)}", columns, "'plant.x'")
        return cls(names, units, None, function, (columns,) if isinstance(columns, str) else tuple(columns))

    @property
    def identity(self) -> str:
        """SHA-256 hash of the formula, or of the function's code and what it reads now, as hexadecimal text."""
        if self.function is not None:
            code = function_identity(self.function)
            text = f"function {code} {self.names!r} {self.columns!r}"
        else:
            text = f"formula {self.formula}"
        return hashlib.sha256(text.encode()).hexdigest()

    @property
    def needed(self) -> tuple[str, ...]:
        """Columns that the measure reads, arrays allowed; all outputs if empty."""
        return self.columns if self.formula is None else self.formula.columns

    @property
    def label(self) -> str:
        """Names in a text, for messages."""
        return printable(", ".join(self.names), 100)

    def expanded(self, elements: Callable[[str], Sequence[str]]) -> "Measure":
        """The same measure with arrays of the formula written out.

        Parameters
        ----------
        elements
            Gives the scalar names of an array, and of a scalar the name itself.
        """
        return self if self.formula is None else replace(self, formula=self.formula.expanded(elements))

    def values(self, result: "Result") -> tuple[float, ...]:
        """The numbers of a result, one for each name.

        Raises
        ------
        StudyError
            If the function raises an exception, or returns something else than numbers.
        """
        if self.formula is not None:
            return (self.formula.evaluate(result),)
        if self.function is None:
            msg = f"Measure {self.label} has neither a formula nor a function; make it by Measure.of."
            raise StudyError(msg)
        try:
            found = self.function(result)
        except Exception as error:
            msg = f"Measure {self.label}: its function failed with {type(error).__name__}: {printable(error, 500)}."
            raise StudyError(msg) from error
        return tuple(self._number(name, found) for name in self.names)

    def _number(self, name: str, found: Any) -> float:
        """The number of a name in what the function returned."""
        by_name = found if isinstance(found, Mapping) else dict(zip(self.names, [found], strict=False))
        if name not in by_name:
            msg = f"Measure {self.label}: its function returned {shown(found)}, without {name}; return each name."
            raise StudyError(msg)
        one = by_name[name]
        array = np.asarray(one)
        if array.shape != () or array.dtype.kind not in "biuf":
            msg = f"Measure {self.label}: its function returned {shown(one)} for {name}; return a number."
            raise StudyError(msg)
        return float(array)


def measured(measures: Sequence[Measure], result: "Result") -> tuple[tuple[float, ...], str]:
    """All numbers of a result, and an empty text; or NaN and the sentence that says which measure failed."""
    try:
        return tuple(value for measure in measures for value in measure.values(result)), ""
    except StudyError as error:
        return (math.nan,) * sum(len(measure.names) for measure in measures), str(error)
