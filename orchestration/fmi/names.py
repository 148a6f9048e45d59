"""Names of variables: elements of arrays, patterns, and the names that a wrong one may have meant.

FMI 2.0 knows scalars only. An array is a set of variables ``x[1]``, ``x[2]``, or ``H[1,1]`` to ``H[2,3]``, whose
indices count up from 1, or from 0, and leave no hole (FMI 2.0.4, structured naming convention).
"""

import re
from collections.abc import Collection, Iterable
from difflib import get_close_matches
from fnmatch import translate
from functools import lru_cache
from itertools import product

import numpy as np

_ELEMENT = re.compile(r"(?P<base>.+)\[(?P<indices>\d{1,9}(?:,\d{1,9})*)\]", re.DOTALL)
MOST_NEAR = 4
"""How many near names a message shows."""


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
    lower: dict[str, str] = {}
    for candidate in (*known, *map(base_name, known)):
        lower.setdefault(candidate.lower(), candidate)
    close = get_close_matches(name.lower(), lower, MOST_NEAR, 0.6)
    longer = [candidate for candidate in lower if candidate.startswith(name.lower())]
    return [lower[match] for match in dict.fromkeys([*close, *longer])][:MOST_NEAR]


def suggestion(name: str, known: Iterable[str]) -> str:
    """A sentence's end that helps with a wrong name: near names, else some of the known ones."""
    known = list(known)
    if not known:
        return "there is none."
    if found := near(name, known):
        return f"did you mean {' or '.join(found)}?"
    shown = ", ".join(known[:MOST_NEAR])
    return f"there are {shown}" + (f" and {len(known) - MOST_NEAR} more." if len(known) > MOST_NEAR else ".")
