"""Small pieces of text that all parts of the page share."""

from collections.abc import Iterable, Sequence

from orchestration.paper.share import Share


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
