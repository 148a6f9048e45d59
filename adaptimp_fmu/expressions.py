"""What a definition gives as the value of a variable: numbers and expressions of CasADi."""

from collections.abc import Sequence

import casadi as ca

from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.per_element import Start


def expression(value: ca.SX | Start, where: str) -> ca.SX:
    """A value as a column of CasADi, shape (n,).

    Raises
    ------
    DefinitionError
        If it is not a number, an array of numbers or an expression.
    """
    try:
        return ca.vec(ca.SX(value))
    except (NotImplementedError, TypeError) as error:
        msg = f"{where} is {value!r}; an expression of CasADi or a number is needed."
        raise DefinitionError(msg) from error


def depends(expression: ca.SX, symbols: Sequence[ca.SX]) -> bool:
    """Whether an expression depends on any of the symbols."""
    return bool(ca.depends_on(ca.SX(expression), ca.vertcat(*symbols)))
