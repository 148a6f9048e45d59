"""Small HTML tables, which notebooks show for objects."""

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING

from orchestration.errors import printable
from orchestration.fmi.names import arrays, common_beginning

if TYPE_CHECKING:
    from orchestration.fmi.description import Variable

MOST_ROWS = 24
"""Rows that a table shows; the others are counted."""
MOST_VARIABLES = 60
"""Rows of a table of variables."""
_SHOWN = ("input", "output", "parameter", "calculatedParameter", "independent")


class Variables(dict[str, "Variable"]):
    """The variables of an FMU by name; a dictionary that shows itself in one line, and in notebooks as a table."""

    def __repr__(self) -> str:
        """Number of variables, and the first names."""
        return printable(f"<{len(self)} variables: {listed(list(self), 8)}>")

    def _repr_html_(self) -> str:
        return variables_html(self, {})


def variables_html(variables: "Mapping[str, Variable]", start: Mapping[str, float | str]) -> str:
    """A table of inputs, outputs and parameters; elements of an array share a row if at most their starts differ.

    Parameters
    ----------
    start
        Start values, by name, that are in force instead of the FMU's own.
    """
    names = tuple(variables)
    whole = {base: [names[i] for i in places.ravel()] for base, places in arrays(names).items()}
    groups = {base: group for base, group in whole.items() if _alike([variables[n] for n in group])}
    grouped = {name: base for base, group in groups.items() for name in group}
    shown = {grouped.get(name, name): groups.get(grouped.get(name, name), [name]) for name in names}
    rows = sorted(
        (
            (base, group, variables[group[0]])
            for base, group in shown.items()
            if variables[group[0]].causality in _SHOWN
        ),
        key=lambda row: _SHOWN.index(row[2].causality),
    )
    head = ("variable", "causality", "variability", "unit", "start", "description")
    cells = [
        (
            base if len(group) == 1 else f"{base} [{len(group)}]",
            *_said(first),
            _values([start.get(n, variables[n].start) for n in group]),
            common_beginning([variables[n].description for n in group]),
        )
        for base, group, first in rows
    ]
    return html_table(head, cells, MOST_VARIABLES)


def _said(variable: "Variable") -> tuple[str, str, str]:
    return variable.causality, variable.variability, variable.unit


def _alike(elements: Sequence["Variable"]) -> bool:
    """Whether the elements of an array can share a row: their starts and the ends of their descriptions may differ."""
    texts = [variable.description for variable in elements]
    return len(set(map(_said, elements))) == 1 and (common_beginning(texts) != "" or len(set(texts)) == 1)


def _values(values: Sequence[float | str | None]) -> str:
    """One value for all elements, or the first values."""
    texts = ["" if v is None else f"{v + 0.0:.6g}" if isinstance(v, float) else str(v) for v in values]
    return texts[0] if len(set(texts)) == 1 else listed(texts)


def html_table(head: Sequence[str], rows: Iterable[Sequence[object]], most: int = MOST_ROWS) -> str:
    """A table; texts are escaped, numbers aligned right."""
    rows = list(rows)
    cells = "".join(f"<th>{escaped(text)}</th>" for text in head)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows[:most])
    rest = f'<tr><td colspan="{len(head)}">and {len(rows) - most} more</td></tr>' if len(rows) > most else ""
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}{rest}</tbody></table>"


def listed(names: Sequence[str], most: int = 4) -> str:
    """The first names, and how many there are more."""
    more = f", and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def _cell(value: object) -> str:
    if isinstance(value, float):
        return f'<td align="right">{value + 0.0:.6g}</td>'
    return f"<td>{escaped(str(value))}</td>"


def escaped(text: str) -> str:
    """A text of a stranger as a part of a page: neither markup nor characters that hide or turn what follows."""
    return escape(printable(text))
