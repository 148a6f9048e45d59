"""Tables of arrays whose elements are laid out in rows and columns, as a model's `Grid` says, for its page."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile

from adaptimp_fmu.description import number
from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.guide import Grid
from adaptimp_fmu.model import Model
from adaptimp_fmu.variables import Role, Variable


@dataclass(frozen=True)
class Cell:
    """An element: its name, its start value as text, and its unit if it differs from that of its column."""

    name: str
    start: str
    unit: str


@dataclass(frozen=True)
class Table:
    """Rows of an array that have the same columns.

    Attributes
    ----------
    label
        What the table shows, for those who cannot see it; a label of its own on the page.
    heads
        Name and unit of each column; the unit is empty where those of the elements differ.
    rows
        Name of each row, with its cells.
    """

    label: str
    heads: Sequence[tuple[str, str]]
    rows: Sequence[tuple[str, Sequence[Cell]]]


@dataclass(frozen=True)
class Laid:
    """An array in tables: its name, what is said of all its elements, and the tables."""

    name: str
    text: str
    tables: Sequence[Table]


def grid_of(model: Model, variable: Variable) -> Grid | None:
    """The grid that a variable stands in, if there is one."""
    array = variable.name.partition("[")[0]
    return next((grid for grid in model.guide.grids if array in grid.arrays), None)


def legends(model: Model) -> list[str]:
    """What rows and columns of the model's tables are."""
    arrays = {variable.name.partition("[")[0] for variable in model.variables}
    return [grid.legend for grid in model.guide.grids if grid.legend and arrays & set(grid.arrays)]


def laid_out(model: Model, variables: Sequence[Variable]) -> list[Laid]:
    """Those of the variables that a grid lays out, by array."""
    arrays: dict[str, list[Variable]] = {}
    for variable in variables:
        if grid_of(model, variable) is not None:
            arrays.setdefault(variable.name.partition("[")[0], []).append(variable)
    found = []
    for name, elements in arrays.items():
        grid = grid_of(model, elements[0])
        if grid is not None:
            found.append(_laid(name, grid, elements))
    return found


def _laid(name: str, grid: Grid, elements: Sequence[Variable]) -> Laid:
    """The tables of an array.

    Raises
    ------
    DefinitionError
        If the grid has fewer places than the array has elements, which then would be missing on the page.
    """
    if len(grid.places) < len(elements):
        msg = f"{name} has {len(elements)} elements, but its grid has places for {len(grid.places)}; add the others."
        raise DefinitionError(msg)
    lines: dict[str, dict[str, Variable]] = {}
    for (row, column), variable in zip(grid.places, elements, strict=False):
        lines.setdefault(row, {})[column] = variable
    alike: dict[tuple[str, ...], list[str]] = {}
    for row, cells in lines.items():
        alike.setdefault(tuple(cells), []).append(row)
    tables = [_table(f"{name}: {', '.join(columns)}", columns, {row: lines[row] for row in of})
              for columns, of in alike.items()]  # fmt: skip
    return Laid(name, _said(grid, elements), tables)


def _table(label: str, columns: Sequence[str], lines: dict[str, dict[str, Variable]]) -> Table:
    """A table of rows with the same columns."""
    units = {column: {cells[column].unit for cells in lines.values()} for column in columns}
    shared = {column: next(iter(found)) if len(found) == 1 else "" for column, found in units.items()}
    rows = [
        (row, [_cell(variable, differs=not shared[column]) for column, variable in cells.items()])
        for row, cells in lines.items()
    ]
    return Table(label, [(column, shared[column]) for column in columns], rows)


def _cell(variable: Variable, *, differs: bool) -> Cell:
    """An element; its unit only where the units of its column differ."""
    start = "" if variable.start is None else number(variable.start, variable.type)
    return Cell(variable.name, start, variable.unit if differs else "")


def _said(grid: Grid, elements: Sequence[Variable]) -> str:
    """What an array is, such as ``Assumed parameters of the arm``, a bound of all, and whether they may change."""
    words = zip(*(variable.description.split() for variable in elements), strict=False)
    shared = [alike[0] for alike in takewhile(lambda alike: len(set(alike)) == 1, words)] if len(elements) > 1 else []
    text = " ".join([*shared, grid.what])
    bounded = {variable.minimum for variable in elements} == {0.0}
    tunable = elements[0].role is Role.TUNABLE_PARAMETER
    said = [text[0].upper() + text[1:], *(["at least 0"] if bounded else []), *(["tunable"] if tunable else [])]
    return ", ".join(said)
