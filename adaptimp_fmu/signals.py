"""Names and values of an FMU's variables: what belongs to an array, and what fits a type."""

import re
from collections import defaultdict
from collections.abc import Iterable
from typing import Any

from adaptimp_fmu.errors import SignalError

_ELEMENT = re.compile(r"(.+)\[(\d+)\]")


def arrays(names: Iterable[str]) -> dict[str, list[str]]:
    """Names of elements by base name, in the order of their index."""
    names = list(names)
    found: defaultdict[str, dict[int, str]] = defaultdict(dict)
    for name in names:
        if match := _ELEMENT.fullmatch(name):
            found[match[1]][int(match[2])] = name
    return {
        base: [elements[i] for i in sorted(elements)]
        for base, elements in found.items()
        if base not in names and min(elements) <= 1 and max(elements) - min(elements) == len(elements) - 1
    }


def listed(names: Iterable[str]) -> str:
    """Names in their order, those of an array once: ``dt_max, tau (2), q_start (2)``."""
    names = list(names)
    of_arrays = arrays(names)
    base_of = {element: base for base, elements in of_arrays.items() for element in elements}
    return ", ".join(
        dict.fromkeys(f"{base_of[n]} ({len(of_arrays[base_of[n]])})" if n in base_of else n for n in names)
    )


def typed(unit: str, variable: Any, value: float | str) -> float | str:
    """The value as its FMI type takes it, never rounded.

    Raises
    ------
    SignalError
        If it does not fit, naming unit and variable.
    """
    if isinstance(value, str) or variable.type == "String":
        fits = isinstance(value, str) and variable.type == "String"
    else:
        fits = variable.type == "Real" or (value in (0, 1) if variable.type == "Boolean" else value.is_integer())
    if not fits:
        msg = f"{unit}: {variable.name} is of type {variable.type}, which {value!r} is not."
        raise SignalError(msg)
    return value if variable.type in ("Real", "String") else int(value)
