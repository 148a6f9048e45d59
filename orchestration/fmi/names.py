"""Names of variables: elements of arrays, patterns, and the names that a wrong one may have meant.

FMI 2.0 knows scalars only. An array is a set of variables ``x[1]``, ``x[2]``, or ``H[1,1]`` to ``H[2,3]``, whose
indices count up from 1, or from 0, and leave no hole (FMI 2.0.4, structured naming convention).
"""

import re
from collections.abc import Collection, Iterable, Sequence
from difflib import get_close_matches
from fnmatch import translate
from functools import lru_cache
from itertools import product, takewhile

import numpy as np

_ELEMENT = re.compile(r"(?P<base>.+)\[(?P<indices>\d{1,9}(?:,\d{1,9})*)\]", re.DOTALL)
_LEADING_ON = ("along", "at", "between", "for", "from", "in", "of", "the", "to")
LIKENESS = 0.65
"""Ratio of difflib from which on a name is near; pilot and plant have 0.6, tua and tau 0.67."""
MOST_NEAR = 4
"""How many near names a message shows."""
MOST_LISTED = 6
"""How many known names a message shows if these are all; of more names it shows the first `MOST_NEAR`."""


def base_name(name: str) -> str:
    """Name of the array that a variable is an element of, or the name itself."""
    match = _ELEMENT.fullmatch(name)
    return match["base"] if match else name


@lru_cache(maxsize=64)
def arrays(names: tuple[str, ...]) -> dict[str, np.ndarray]:
    """Arrays among names.

    Returns
    -------
    dict
        Positions in `names` of the elements, by the name of the array; integers of the array's shape.
    """
    found: dict[str, dict[tuple[int, ...], int]] = {}
    for position, name in enumerate(names):
        if match := _ELEMENT.fullmatch(name):
            indices = tuple(int(index) for index in match["indices"].split(","))
            found.setdefault(match["base"], {})[indices] = position
    whole = {base: _filled(elements) for base, elements in found.items()}
    return {base: positions for base, positions in whole.items() if positions is not None}


def _filled(elements: dict[tuple[int, ...], int]) -> np.ndarray | None:
    """Positions as an array; None if elements are missing or differ in their number of indices."""
    depths = {len(indices) for indices in elements}
    if len(depths) > 1:
        return None
    firsts, lasts = (tuple(map(edge, zip(*elements, strict=True))) for edge in (min, max))
    if firsts not in ((0,) * len(firsts), (1,) * len(firsts)):
        return None
    ranges = [range(first, last + 1) for first, last in zip(firsts, lasts, strict=True)]
    if int(np.prod([len(r) for r in ranges])) != len(elements):
        return None
    return np.array([elements[indices] for indices in product(*ranges)]).reshape([len(r) for r in ranges])


def common_beginning(texts: Sequence[str]) -> str:
    """What texts about the elements of an array begin with, in whole words; a text without its end says no "along".

    Examples
    --------
    >>> from orchestration.fmi.names import common_beginning
    >>> common_beginning(["Position of the tip along x1", "Position of the tip along x2"])
    'Position of the tip'
    """
    if len(set(texts)) == 1:
        return texts[0]
    places = zip(*(text.split() for text in texts), strict=False)
    shared = [words[0] for words in takewhile(lambda words: len(set(words)) == 1, places)]
    while shared and shared[-1].lower() in _LEADING_ON:
        shared.pop()
    return " ".join(shared).rstrip(" ,;([")


def chosen(patterns: Iterable[str], known: Collection[str]) -> tuple[list[str], list[str]]:
    """Names that patterns choose: a name, the name of an array, or a pattern with ``*``, ``?``.

    Brackets are part of names and never a set of characters.

    Returns
    -------
    tuple
        The chosen names, each once, in the order of the patterns and within one in that of `known`; and the
        patterns that choose nothing.
    """
    known = tuple(known)
    places = dict.fromkeys(known)
    found: dict[str, None] = {}
    missing = []
    for pattern in patterns:
        if pattern in places:
            found[pattern] = None
            continue
        if "*" in pattern or "?" in pattern:
            matches = re.compile(translate(re.sub(r"\[", "[[]", pattern))).fullmatch
            names = [name for name in known if matches(name)]
        else:
            positions = arrays(known).get(pattern)
            names = [] if positions is None else [known[i] for i in positions.ravel()]
        found |= dict.fromkeys(names)
        missing += [] if names else [pattern]
    return list(found), missing


def near(name: str, known: Iterable[str]) -> list[str]:
    """Known names, or names of arrays, that a wrong name may have meant, the nearest first."""
    known = list(known)
    whole = arrays(tuple(known))
    lower: dict[str, str] = {}
    for candidate in known:
        of_array = base_name(candidate) if base_name(candidate) in whole else candidate
        lower.setdefault(of_array.lower(), of_array)
    close = get_close_matches(name.lower(), lower, MOST_NEAR, LIKENESS)
    longer = [candidate for candidate in lower if candidate.startswith(name.lower())]
    members = [candidate for candidate in lower if candidate.endswith(f".{name.lower()}")]
    return [lower[match] for match in dict.fromkeys([*members, *close, *longer])][:MOST_NEAR]


def suggestion(name: str, known: Iterable[str], prefix: str = "") -> str:
    """A sentence's end that helps with a wrong name: what an array is, near names, else some of the known ones.

    Parameters
    ----------
    prefix
        What stands before the known names where the user writes them, such as ``plant.``.
    """
    known = list(known)
    if not known:
        return "there is none."
    lower = {**{base_name(k).lower(): base_name(k) for k in known}, **{k.lower(): k for k in known}}
    if help_ := _index_help(name, known, prefix):
        return help_
    if lower.get(name.lower(), name) != name:
        return f"names are case-sensitive: did you mean {prefix}{lower[name.lower()]}?"
    if found := near(name, known):
        return f"did you mean {' or '.join(f'{prefix}{candidate}' for candidate in found)}?"
    shown = list(dict.fromkeys(base_name(candidate) for candidate in known))
    if len(shown) <= MOST_LISTED:
        return f"there are {', '.join(shown)}."
    return f"there are {', '.join(shown[:MOST_NEAR])} and {len(shown) - MOST_NEAR} more."


def _index_help(name: str, known: list[str], prefix: str) -> str:
    """A sentence's end about an index that lacks, is too much or is out of range; empty if the index is not wrong."""
    whole = arrays(tuple(known))
    if name in whole:
        elements = [f"{prefix}{known[i]}" for i in whole[name].ravel()]
        few = ", ".join(elements) if len(elements) <= MOST_NEAR else f"{elements[0]} to {elements[-1]}"
        return f"{prefix}{name} is an array: {few}."
    base = base_name(name)
    if base == name:
        return ""
    array = {candidate.lower(): candidate for candidate in whole}.get(base.lower())
    if array is not None and array != base and (meant := array + name[len(base) :]) in known:
        return f"names are case-sensitive: did you mean {prefix}{meant}?"
    if array is not None:
        first, last = (f"{prefix}{known[whole[array].ravel()[end]]}" for end in (0, -1))
        return f"the elements of {prefix}{array} are {first} to {last}."
    return f"{prefix}{base} is not an array; leave the index out." if base in known else ""
