"""A formula of a measure: what it needs of a run, and the number that it makes of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.errors import FormulaError
from orchestration.results.measures.arithmetic import computed
from orchestration.results.measures.canonical import written
from orchestration.results.measures.elements import Elements, scalar
from orchestration.results.measures.expression import Column, Expression, Reduction, walk
from orchestration.results.measures.measure_units import unit_of
from orchestration.results.measures.reduction import reduced

if TYPE_CHECKING:
    from orchestration.results.result import Result


@dataclass(frozen=True)
class Formula:
    """Arithmetic over reductions of a run, such as ``max(plant.gap) - min(plant.gap)``.

    Two formulas are equal if their texts are, apart from spaces and needless parentheses.

    Attributes
    ----------
    tree
        The formula as `orchestration.results.measures.expression` has it. Every column lies within a `Reduction`, and
        no reduction within another one.
    """

    tree: Expression

    def __str__(self) -> str:
        """The text, in one way of writing; it can be read again."""
        return written(self.tree)

    @cached_property
    def columns(self) -> tuple[str, ...]:
        """Names as they are written, those of arrays included, each once, in the order of appearance."""
        return tuple(dict.fromkeys(node.name for node in walk(self.tree) if isinstance(node, Column)))

    @cached_property
    def reductions(self) -> tuple[Reduction, ...]:
        """What has to be reduced over the run, each once, in the order of appearance."""
        return tuple(dict.fromkeys(node for node in walk(self.tree) if isinstance(node, Reduction)))

    def expanded(self, elements: Elements) -> "Formula":
        """Return the formula with the elements of arrays in their place, so that all columns are scalars.

        Parameters
        ----------
        elements
            Gives the names of the elements of an array, and for the name of a scalar that name.

        Raises
        ------
        FormulaError
            If an array stands where one number is needed.
        """
        return Formula(scalar(self.tree, elements))

    def combine(self, values: Sequence[Any] | np.ndarray) -> Any:
        """Compute the measure from the values of the `reductions`.

        Parameters
        ----------
        values
            One for each of the `reductions`: a number, or an array with one number for each run, shape (n_runs,).

        Returns
        -------
        float or ndarray
            A number, or float64 of shape (n_runs,). The bits are the same in both cases.
        """
        of_reduction = dict(zip(self.reductions, (np.asarray(value, float)[()] for value in values), strict=True))
        found = computed(self.tree, lambda node: of_reduction[node])  # type: ignore[index] - all leaves are reductions
        return found if np.ndim(found) else float(found)

    def evaluate(self, result: "Result") -> float:
        """Measure a run.

        The rows have to be those of all steps. On a result that leaves rows out, the measure is that of the rows.

        Raises
        ------
        UnknownNameError
            If the result lacks a column.
        FormulaError
            If an array stands where one number is needed, or a column is one of texts.
        """
        scalars = self.expanded(lambda name: _elements_of(result, name))
        return scalars.combine([reduced(reduction, result) for reduction in scalars.reductions])

    def unit(self, unit_of_column: Callable[[str], str]) -> str:
        """Return the unit of the measure; empty for a pure number, and where the unit is not plain.

        Parameters
        ----------
        unit_of_column
            Gives the unit of each of the `columns`, empty for none.
        """
        return unit_of(self.tree, unit_of_column)


def _elements_of(result: "Result", name: str) -> tuple[str, ...]:
    """Names of the columns of a result that a name stands for."""
    if result[name].dtype == object:
        msg = f"{name} is a column of texts, which cannot be measured; name columns of numbers."
        raise FormulaError(msg)
    return result.columns_of(name)
