"""Start values and texts of the elements of an array, as a model's author gives them: one for all, or one each."""

from collections.abc import Sequence

import casadi as ca

from adaptimp_fmu.errors import DefinitionError

Start = float | Sequence[float]
PerElement = str | Sequence[str]


def start_numbers(start: Start, where: str) -> tuple[list[float], int | None]:
    """Start values as numbers, and their number; None for a scalar."""
    if isinstance(start, int | float):
        return [float(start)], None
    if isinstance(start, str | ca.SX):
        raise _not_numbers(start, where)
    try:
        values = [float(value) for value in start]
    except (TypeError, ValueError) as error:
        raise _not_numbers(start, where) from error
    return values, len(values)


def _not_numbers(start: object, where: str) -> DefinitionError:
    """The error of a start value that is not made of numbers."""
    shown = f"the symbol {start} of type SX" if isinstance(start, ca.SX) else repr(start)
    return DefinitionError(f"{where}: start {shown} is not a number; give a number, or a list of numbers for an array.")


def per_element(texts: PerElement, names: Sequence[str], what: str) -> list[str]:
    """One text per element."""
    if isinstance(texts, str):
        return [texts] * len(names)
    if not isinstance(texts, Sequence) or not all(isinstance(text, str) for text in texts):
        msg = f"{names[0]}: {what} {texts!r}: a text is needed, or a list of texts."
        raise DefinitionError(msg)
    if len(texts) != len(names):
        msg = f"{names[0]}: {len(names)} elements but {len(texts)} {what}; give one for all, or one for each."
        raise DefinitionError(msg)
    return list(texts)
