"""What a caller gave: checks of types whose messages show the value and an example of a right one."""

import math
from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from orchestration.errors import ArchiveError, OrchestrationError, SystemDescriptionError

LONGEST = 60
"""Characters of a value that a message shows."""


def shown(value: object) -> str:
    """A value as a message shows it: its ``repr``, shortened, and for a longer value its type."""
    text = " ".join(repr(value).split())
    return text if len(text) <= LONGEST else f"an object of type {type(value).__name__}"


def require_type(
    what: str,
    value: object,
    kinds: type | tuple[type, ...],
    example: str,
    error: type[OrchestrationError] = SystemDescriptionError,
) -> None:
    """Refuse a value of another type.

    Parameters
    ----------
    what
        What the value is given as, which begins the message.
    example
        What is needed, as the end of a sentence.
    error
        Class of the error.

    Raises
    ------
    OrchestrationError
        Of the class `error`.
    """
    if not isinstance(value, kinds):
        msg = f"{what} is {shown(value)}, of type {type(value).__name__}; {example}."
        raise error(msg)


def require_names(what: str, value: object, example: str) -> None:
    """Refuse what is not a text, and not a collection of texts.

    Raises
    ------
    SystemDescriptionError
    """
    if isinstance(value, str):
        return
    require_type(what, value, Iterable, f"give names, such as {example}")
    for name in value if isinstance(value, Iterable) else ():
        require_type(f"A name in {what}", name, str, f"give a text, such as {example}")


def a_number(what: str, value: Any, error: type[OrchestrationError] = SystemDescriptionError, unit: str = "s") -> float:
    """Return a value as a finite number.

    Parameters
    ----------
    what
        What the value is given as, which begins the message.
    unit
        Unit of the value; the empty text for a value without a unit.

    Raises
    ------
    OrchestrationError
        Of the class `error`, if the value is another thing than a number, or NaN or infinite.
    """
    in_unit = f", in {unit}" if unit else ""
    plain = isinstance(value, int | float | np.number) or (isinstance(value, np.ndarray) and value.ndim == 0)
    if not plain or isinstance(value, bool | np.complexfloating):
        msg = f"{what} is {shown(value)}; give a plain number{in_unit}."
        raise error(msg)
    if not math.isfinite(value):
        msg = f"{what} is {float(value)!r}; give a finite number{in_unit}."
        raise error(msg)
    return float(value)


def positive(what: str, value: Any, error: type[OrchestrationError] = SystemDescriptionError, unit: str = "s") -> float:
    """Return a value as a finite number above zero; parameters and errors are those of `a_number`."""
    found = a_number(what, value, error, unit)
    if found <= 0:
        msg = f"{what} is {short(found)} {unit}".rstrip() + "; it must be positive."
        raise error(msg)
    return found


def short(value: float) -> str:
    """A number with as few digits as tell it from all others, without a needless ``.0``."""
    return repr(float(value)).removesuffix(".0")


def a_path(what: str, value: Any) -> Path:
    """Return a value as a path.

    Raises
    ------
    ArchiveError
        If it is neither a text nor a path.
    """
    require_type(what, value, (str, PathLike), "give the path of a file, as a text or a Path", ArchiveError)
    return Path(value)
