"""Tables of plain text that stay whole on narrow terminals: no number and no column is cut.

    signal      unit      min        max            name  N.m
    name        N.m    -1e-07          1              min -1e-07  max       1

A table that is too wide as a whole folds its last column, if that is text. If that does not help, each row becomes a
paragraph, as on the right.
"""

from collections.abc import Iterator, Sequence
from itertools import zip_longest
from textwrap import wrap

from orchestration.errors import printable

GAP = "  "
LEAST = 24  # columns for a text that is folded


def table(
    head: Sequence[str],
    rows: Sequence[Sequence[str]],
    width: int,
    *,
    numbers: Sequence[str] = (),
    together: int = 1,
) -> str:
    """A table of at most `width` columns where that is possible.

    Parameters
    ----------
    head
        Names of the columns.
    rows
        Texts, each as many as there are names.
    numbers
        Names of columns that are aligned right.
    together
        How many cells of a row stand in the first line of its paragraph, where the table is too wide.
    """
    rows = [[printable(cell) for cell in row] for row in rows]
    widths = [max(len(cell) for cell in column) for column in zip(head, *rows, strict=True)]
    fixed = sum(widths[:-1]) + len(GAP) * (len(head) - 1)
    right = [name in numbers for name in head]
    if fixed + widths[-1] > width:
        if right[-1] or width - fixed < LEAST:
            return "\n".join(_paragraphs(head, rows, width, together, right))
        widths[-1] = width - fixed
    lines = [_line(head, widths, right), GAP.join("-" * n for n in widths)]
    for row in rows:
        folded = _wrapped(row[-1], widths[-1], "", "") or [""]
        lines.append(_line([*row[:-1], folded[0]], widths, right))
        lines += [" " * fixed + more for more in folded[1:]]
    return "\n".join(lines)


def definitions(rows: Sequence[tuple[str, str]], width: int, indent: str = "") -> str:
    """Names with a text each, which is folded beside or below its name."""
    rows = [(printable(name), printable(text)) for name, text in rows]
    longest = max((len(name) for name, _ in rows), default=0)
    lines: list[str] = []
    for name, text in rows:
        place = len(indent) + longest + len(GAP)
        if width - place < LEAST:
            lines += [indent + name, *_wrapped(text, width, indent + GAP, indent + GAP)]
            continue
        first, *more = _wrapped(text, width - place, "", "") or [""]
        lines.append(f"{indent}{name:{longest}}{GAP}{first}".rstrip())
        lines += [" " * place + line for line in more]
    return "\n".join(lines)


def side_by_side(rows: Sequence[tuple[Sequence[str], str]], width: int) -> str:
    """Lines with a text each, which is folded beside or below them; rows are apart by an empty line."""
    rows = [([printable(line) for line in lines], printable(text)) for lines, text in rows]
    longest = max((len(line) for lines, _ in rows for line in lines), default=0)
    place = longest + len(GAP)
    parts: list[str] = []
    for lines, text in rows:
        if width - place < LEAST:
            parts.append("\n".join([*lines, *_wrapped(text, width, GAP * 2, GAP * 2)]))
        else:
            folded = zip_longest(lines, _wrapped(text, width - place, "", ""), fillvalue="")
            parts.append("\n".join(f"{line:{longest}}{GAP}{part}".rstrip() for line, part in folded))
    return "\n\n".join(parts)


def _line(cells: Sequence[str], widths: Sequence[int], right: Sequence[bool]) -> str:
    placed = [
        cell.rjust(n) if aligned else cell.ljust(n) for cell, n, aligned in zip(cells, widths, right, strict=True)
    ]
    return GAP.join(placed).rstrip()


def _paragraphs(
    head: Sequence[str], rows: Sequence[Sequence[str]], width: int, first: int, right: Sequence[bool]
) -> Iterator[str]:
    """Rows with their first cells in a line, and below it the other cells with their names; numbers are aligned."""
    widths = [
        max(len(cell) for cell in column) if is_number else 0 for *column, is_number in zip(*rows, right, strict=True)
    ]
    for row in rows:
        yield from _packed([cell for cell in row[:first] if cell], width, "")
        cells = list(zip(head, row, widths, strict=True))
        said = [f"{name} {cell.rjust(n)}" for name, cell, n in cells[first:-1] if cell]
        name, text, n = cells[-1]
        said += [f"{name} {text.rjust(n)}" if right[-1] else text] if text and len(cells) > first else []
        yield from _packed(said, width, GAP)


def _packed(cells: Sequence[str], width: int, indent: str) -> Iterator[str]:
    """Lines with as many cells as fit; a cell that is too long is folded."""
    lines: list[str] = []
    for cell in cells:
        if lines and len(indent) + len(lines[-1]) + len(GAP) + len(cell) <= width:
            lines[-1] += GAP + cell
        else:
            lines.append(cell)
    for line in lines:
        yield from _wrapped(line, width, indent, indent + GAP)


def _wrapped(text: str, width: int, first: str, later: str) -> list[str]:
    """Lines of a text with indents; no word is cut, however long it is."""
    return wrap(
        text,
        width,
        initial_indent=first,
        subsequent_indent=later,
        break_long_words=False,
        break_on_hyphens=False,
    )
