"""The C text of a model's equations: what CasADi generates, on the mathematics of the runtime.

CasADi's code calls the C library. The runtime brings functions of its own under the same names
(``runtime/casadi_names.h``), so ``<math.h>`` goes, and sine and cosine of one angle become one call.
"""

import re
from collections import Counter
from collections.abc import Iterable, Sequence

import casadi as ca

from adaptimp_fmu.errors import DefinitionError

FUNCTIONS = (
    *("sqrt", "fabs", "sign", "floor", "ceil", "fmin", "fmax", "copysign", "fmod", "remainder", "hypot"),
    *("exp", "expm1", "log", "log1p", "log10", "pow", "sin", "cos", "tan", "asin", "acos", "atan", "atan2"),
    *("sinh", "cosh", "tanh", "asinh", "acosh", "atanh"),
)
"""CasADi's functions that the equations of a model may use, besides ``+ - * /``, comparisons and ``if_else``."""

_REFUSED = {ca.OP_ERF: "erf", ca.OP_ERFINV: "erfinv", ca.OP_PRINTME: "printme"}
_INCLUDE = "#include <math.h>\n"
_ASSIGNMENT = re.compile(r"  (\w+)=(.*);")
_CALL = re.compile(r"(sin|cos)\((\w+)\)")
_HELPER = re.compile(r"^(?:void|int|(?:const )?casadi_(?:real|int)\*?) casadi_\w+\(", re.MULTILINE)
# The runtime gives every argument and takes every result, so nothing has to be asked for.
_MAYBE_ARGUMENT = re.compile(r"arg\[\d+\]\? (arg\[\d+\]\[\d+\]) : 0")
_MAYBE_RESULT = re.compile(r"if \(res\[\d+\]!=0\) ")
_BEGIN = re.compile(r"static int casadi_f\d+\(.*\{")


def equations_text(functions: Sequence[ca.Function]) -> str:
    """Generate the C text of CasADi functions.

    Parameters
    ----------
    functions
        In the order in which they are to stand.
    """
    generator = ca.CodeGenerator("equations.c", {"with_mem": False, "with_header": False})
    for function in functions:
        generator.add(function)
    text = _HELPER.sub(r"static \g<0>", generator.dump().replace(_INCLUDE, ""))
    text = _MAYBE_RESULT.sub("", _MAYBE_ARGUMENT.sub(r"\1", text))
    return "\n".join(_with_pairs(text.split("\n")))


def require_supported(where: str, value: ca.SX) -> None:
    """Refuse an expression with a function that the runtime does not have.

    Parameters
    ----------
    where
        The expression, for the message.

    Raises
    ------
    DefinitionError
        If there is such a function.
    """
    function = ca.Function("operations", ca.symvar(value), [value])
    found = {function.instruction_id(i) for i in range(function.n_instructions())}
    for operation in sorted(found & _REFUSED.keys()):
        msg = (
            f"{where} uses {_REFUSED[operation]}, which the runtime of FMUs does not have;"
            f" it has {', '.join(FUNCTIONS)}."
        )
        raise DefinitionError(msg)


def _with_pairs(lines: Sequence[str]) -> list[str]:
    """Within each function, a sine and a cosine of one value become the two results of one call."""
    result: list[str] = []
    begin = 0
    for i, line in enumerate(lines):
        if _BEGIN.match(line):
            result += lines[begin : i + 1]
            begin = i + 1
        elif line == "}":
            result += _paired(lines[begin:i])
            begin = i
    return result + list(lines[begin:])


def _paired(body: Sequence[str]) -> list[str]:
    """The statements of a function; the first of two calls computes both, the second takes its result."""
    angles = list(_angles(body))
    several = [angle for angle, n in Counter(angle for angle in angles if angle).items() if n > 1]
    numbers = {angle: i for i, angle in enumerate(several)}
    result: list[str] = []
    seen: set[tuple[str, int]] = set()
    for line, angle in zip(body, angles, strict=True):
        if angle not in numbers:
            result.append(line)
            continue
        target, function, argument = re.fullmatch(r"  (\w+)=(\w+)\((\w+)\);", line).groups()  # type: ignore[union-attr]
        name = f"angle{numbers[angle]}"
        if angle not in seen:
            result.append(f"  const SinCos {name}=real_sincos({argument});")
            seen.add(angle)
        result.append(f"  {target}={name}.{function};")
    return result


def _angles(body: Iterable[str]) -> Iterable[tuple[str, int] | None]:
    """For each statement that is a sine or a cosine, the variable of the angle and how often it was assigned before."""
    assigned: Counter[str] = Counter()
    for line in body:
        statement = _ASSIGNMENT.fullmatch(line)
        call = statement and _CALL.fullmatch(statement[2])
        yield (call[2], assigned[call[2]]) if call else None
        if statement:
            assigned[statement[1]] += 1
