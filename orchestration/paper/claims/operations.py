"""Counts arithmetic operations, for a count is the same on every machine while a time is not.

One operation is an addition, a subtraction, a multiplication, a comparison, a choice or the like; a costly one is
a division, a root, a power, or a function such as a sine or an exponential. Fewer operations of both kinds cost less
whatever a machine makes of either.
"""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import Model
from adaptimp_fmu.lowering import lower

_NOT_ARITHMETIC = (ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST, ca.OP_PARAMETER, ca.OP_ASSIGN)
_COSTLY = frozenset(
    {
        *(ca.OP_DIV, ca.OP_INV, ca.OP_SQRT, ca.OP_POW, ca.OP_CONSTPOW, ca.OP_EXP, ca.OP_LOG, ca.OP_FMOD),
        *(ca.OP_SIN, ca.OP_COS, ca.OP_TAN, ca.OP_ASIN, ca.OP_ACOS, ca.OP_ATAN, ca.OP_ATAN2),
        *(ca.OP_SINH, ca.OP_COSH, ca.OP_TANH, ca.OP_ASINH, ca.OP_ACOSH, ca.OP_ATANH),
        *(ca.OP_EXPM1, ca.OP_LOG1P, ca.OP_HYPOT, ca.OP_REMAINDER, ca.OP_ERF, ca.OP_ERFINV),
    }
)


@dataclass(frozen=True)
class Operations:
    """Arithmetic operations of a function.

    Attributes
    ----------
    simple, costly
        Numbers of operations that are neither, and that are divisions, roots, powers, or functions such as a sine.
    """

    simple: int
    costly: int

    @property
    def total(self) -> int:
        """All operations."""
        return self.simple + self.costly

    def __str__(self) -> str:
        """The operations as text, such as ``121 (13)``: all of them, and how many are costly."""
        return f"{self.total} ({self.costly})"


def operations(model: Model) -> dict[str, Operations]:
    """Arithmetic operations of a sampled model's tick, by function of the generated C.

    ``tick`` is the tick without, ``tick_update`` the tick with the update of slow states, p_hat.
    """
    functions = {f.name(): f for f in lower(model).functions}
    return {name: counted(functions[name]) for name in ("tick", "tick_update") if name in functions}


def counted(function: ca.Function) -> Operations:
    """Arithmetic operations of a CasADi function of scalars."""
    codes = [function.instruction_id(i) for i in range(function.n_instructions())]
    arithmetic = [code for code in codes if code not in _NOT_ARITHMETIC]
    costly = sum(code in _COSTLY for code in arithmetic)
    return Operations(len(arithmetic) - costly, costly)


def without_update(function: ca.Function) -> Operations:
    """Arithmetic operations of a function's first result alone, with common subexpressions shared."""
    symbols = function.sx_in()
    first = function.call(symbols)[0]
    return counted(ca.Function("first", symbols, [ca.cse(first)]))
