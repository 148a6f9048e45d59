"""Small pieces of text that all parts of the page share."""

import re
from collections.abc import Iterable, Sequence
from textwrap import fill

from orchestration.paper.share import Share

WIDTH = 120  # characters of a line
_ITEM = re.compile(r"(- |\d+\. )")  # begins an item of a list


def percent(found: Share) -> str:
    """A share with its interval, in percent."""
    return f"{_number(found.value)} % ({_number(found.low)} to {_number(found.high)})"


def listed(names: Iterable[str]) -> str:
    """Names, or that there are none."""
    return ", ".join(names) or "none"


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown."""
    lines = [heads, ["---"] * len(heads), *rows]
    return "".join(f"| {' | '.join(line)} |\n" if line[0] != "---" else f"|{'---|' * len(heads)}\n" for line in lines)


def _number(share: float) -> str:
    """A share in percent; a small one with two digits behind the point."""
    return f"{100 * share:.2f}" if 0 < share < 0.01 else f"{100 * share:.1f}"


def filled(text: str) -> str:
    """Markdown whose paragraphs and list items have lines of even length; all other lines stay as they are."""
    done: list[str] = []
    paragraph: list[str] = []
    for line in [*text.split("\n"), ""]:
        starts, stays = bool(_ITEM.match(line)), not line or line.startswith(("|", "#", "    "))
        if paragraph and (starts or stays):
            done.append(_fill(paragraph))
            paragraph = []
        if stays:
            done.append(line)
        else:
            paragraph.append(line)
    return "\n".join(done[:-1])


def _fill(lines: Sequence[str]) -> str:
    """One paragraph or list item with lines of even length."""
    marker = _ITEM.match(lines[0])
    return fill(
        " ".join(line.strip() for line in lines),
        WIDTH,
        subsequent_indent=" " * len(marker.group()) if marker else "",
        break_long_words=False,
        break_on_hyphens=False,
    )
