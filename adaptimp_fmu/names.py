"""Names that a wrong name may have meant, and what texts have in common."""

from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from itertools import takewhile

_LEADING_ON = ("along", "at", "between", "for", "from", "in", "of", "the", "to")
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


def common_beginning(texts: Sequence[str]) -> str:
    """What texts about the elements of an array begin with, in whole words; empty if they begin differently."""
    if len(set(texts)) == 1:
        return texts[0]
    places = zip(*(text.split() for text in texts), strict=False)
    shared = [words[0] for words in takewhile(lambda words: len(set(words)) == 1, places)]
    while shared and shared[-1].lower() in _LEADING_ON:
        shared.pop()
    return " ".join(shared).rstrip(" ,;([")


def as_one(texts: Sequence[str]) -> str:
    """Texts about the elements of an array as one: what differs is listed between what they begin and end with.

    Examples
    --------
    >>> from adaptimp_fmu.names import as_one
    >>> as_one(["Force along axis 1 of the base", "Force along axis 2 of the base"])
    'Force along axis 1, 2 of the base'
    """
    words = [text.split() for text in texts]
    shortest = min(map(len, words))
    begin = next((i for i in range(shortest) if len({one[i] for one in words}) > 1), shortest)
    rest = shortest - begin
    end = next((i for i in range(rest) if len({one[-1 - i] for one in words}) > 1), rest)
    middles = dict.fromkeys(" ".join(one[begin : len(one) - end]) for one in words)
    return " ".join(part for part in (*words[0][:begin], ", ".join(middles), *words[0][len(words[0]) - end :]) if part)
