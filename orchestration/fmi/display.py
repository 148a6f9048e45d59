"""Small HTML tables, which notebooks show for objects."""

from collections.abc import Iterable, Sequence
from html import escape

MOST_ROWS = 24
"""Rows that a table shows; the others are counted."""


def html_table(head: Sequence[str], rows: Iterable[Sequence[object]], most: int = MOST_ROWS) -> str:
    """A table; texts are escaped, numbers aligned right."""
    rows = list(rows)
    cells = "".join(f"<th>{escape(text)}</th>" for text in head)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows[:most])
    rest = f"<tr><td colspan={len(head)}>and {len(rows) - most} more</td></tr>" if len(rows) > most else ""
    return f"<table><thead><tr>{cells}</tr></thead><tbody>{body}{rest}</tbody></table>"


def listed(names: Sequence[str], most: int = 4) -> str:
    """The first names, and how many there are more."""
    more = f", and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more


def _cell(value: object) -> str:
    if isinstance(value, float):
        return f'<td align="right">{value + 0.0:.6g}</td>'
    return f"<td>{escape(str(value))}</td>"
