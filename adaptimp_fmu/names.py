"""Names that a wrong name may have meant, for messages."""

from collections.abc import Iterable
from difflib import get_close_matches

MOST_NEAR = 3
"""How many near names a message shows."""


def suggestion(name: str, known: Iterable[str]) -> str:
    """A sentence's end that helps with a wrong name: near names, else the known ones."""
    by_lower: dict[str, str] = {}
    for candidate in known:
        by_lower.setdefault(candidate.lower(), candidate)
    if name.lower() in by_lower:
        return f"names are case-sensitive: did you mean {by_lower[name.lower()]}?"
    close = get_close_matches(name.lower(), by_lower, MOST_NEAR, 0.6)
    if close:
        return f"did you mean {' or '.join(by_lower[match] for match in close)}?"
    shown = list(by_lower.values())[: 2 * MOST_NEAR]
    more = len(by_lower) - len(shown)
    return f"there are {', '.join(shown)}{f' and {more} more' if more else ''}."
