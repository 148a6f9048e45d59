"""The C text of equations: CasADi's functions are the runtime's, and sine and cosine of one angle are one call."""

import ctypes
import re
import subprocess
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from adaptimp_fmu import ContinuousModel
from adaptimp_fmu.equations import FUNCTIONS, equations_text
from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.lowering import lower
from tests.property.mathematics.library import RUNTIME, ZIG

TWO = ("fmin", "fmax", "copysign", "fmod", "remainder", "hypot", "atan2")
X, Y = ca.SX.sym("x"), ca.SX.sym("y")
CALLED = re.compile(r"\b([a-z_]\w*)\(")


def value(name: str) -> ca.SX:
    """A function of x, or of x and y."""
    if name == "pow":
        return X**Y
    return getattr(ca, name)(X, Y) if name in TWO else getattr(ca, name)(X)


def model_of(expression: ca.SX) -> ContinuousModel:
    """A model whose output is an expression of x and y."""
    model = ContinuousModel("Small", "One output")
    x, y = (model.parameter(name, 0.5, description="A number") for name in ("x", "y"))
    model.derivative(model.state("z", ca.SX(0)), ca.SX(0))
    model.output("out", ca.substitute(expression, ca.vertcat(X, Y), ca.vertcat(x, y)), description="The value")
    return model


def compiled(function: ca.Function, folder: Path) -> ctypes.CDLL:
    """The library of a function, without anything of a C library."""
    source, library = folder / "equations.c", folder / "equations.so"
    head = '#include "casadi_names.h"\n#define CASADI_SYMBOL_EXPORT __attribute__((visibility("default")))\n'
    source.write_text(head + equations_text([function]), encoding="utf-8")
    flags = ("-std=c11", "-O2", "-shared", "-fPIC", "-nostdlib", "-Wl,--no-undefined", "-I", str(RUNTIME))
    subprocess.run([*ZIG, *flags, str(source), "-o", str(library)], check=True, capture_output=True)
    return ctypes.CDLL(str(library))


def evaluated(function: ca.Function, arguments: list[float], folder: Path) -> list[float]:
    """Values of a compiled function of numbers."""
    library = compiled(function, folder)
    given, found = np.array(arguments), np.zeros(function.n_out())
    pointers = [_pointers(array) for array in (given, found)]
    assert library[function.name()](*pointers, None, None, ctypes.c_int(0)) == 0
    return found.tolist()


def _pointers(numbers: np.ndarray) -> ctypes.Array[ctypes.c_void_p]:
    """The address of each number."""
    return (ctypes.c_void_p * len(numbers))(*(numbers.ctypes.data + 8 * i for i in range(len(numbers))))


def test_every_function_that_a_model_may_use_is_the_runtime_s(tmp_path: Path) -> None:
    function = ca.Function("all_functions", [X, Y], [value(name) for name in FUNCTIONS])
    found = evaluated(function, [0.7, 0.3], tmp_path)
    expected = [float(v) for v in function(0.7, 0.3)]
    # 1 ulp here and in CasADi's C library each; log10 is log times a number: 2 more
    np.testing.assert_allclose(found, expected, rtol=4 * 2.0**-52, atol=0)


def test_no_other_header_is_included() -> None:
    text = equations_text([ca.Function("f", [X, Y], [value(name) for name in FUNCTIONS])])
    assert "#include" not in text


REFUSED = {"erf": ca.erf(X), "erfinv": ca.erfinv(X), "printme": X.printme(Y)}


@pytest.mark.parametrize(("name", "expression"), REFUSED.items())
def test_a_function_that_the_runtime_lacks_is_refused(name: str, expression: ca.SX) -> None:
    with pytest.raises(DefinitionError, match=rf"Small: output out uses {name}, .* it has sqrt, .*, atanh\."):
        lower(model_of(1 + 2 * expression))


def test_casadi_has_no_function_that_is_neither_ours_nor_refused() -> None:
    """Operations on numbers that CasADi's C code calls something for; a new one shows here."""
    ours = set(re.findall(r"#define (\w+)\(", (RUNTIME / "casadi_names.h").read_text(encoding="utf-8")))
    x, y = X, Y
    names = {name for name in dir(ca) if name.startswith("OP_")}
    refused = {"erf", "erfinv", "casadi_printme"}
    called: set[str] = set()
    for name in sorted(names):
        for build in (lambda op: ca.SX.unary(op, x), lambda op: ca.SX.binary(op, x, y)):
            try:
                expression = build(getattr(ca, name))
                text = equations_text([ca.Function("f", [x, y], [expression])])
            except (RuntimeError, NotImplementedError):
                continue
            body = text[text.index("static int casadi_f0") :].split("\n}\n")[0]
            called |= {c for line in body.split("\n")[1:] for c in CALLED.findall(line)}
    helpers = {c for c in called if c.startswith("casadi_")} - refused
    assert helpers <= {f"casadi_{name}" for name in ("sq", "sign", "fabs", "fmin", "fmax", "log1p", "expm1", "hypot")}
    assert {"sin", "atan2", "fmod"} <= called
    assert called - helpers - refused <= ours


def test_sine_and_cosine_of_one_angle_are_one_call(tmp_path: Path) -> None:
    angle = X * Y
    sine = ca.sin(angle)
    values = [ca.cos(angle) + sine, ca.sin(Y), ca.cos(angle + 1), ca.sin(sine), ca.cos(sine)]
    function = ca.Function("f", [X, Y], [*ca.vertsplit(ca.cse(ca.vertcat(*values)))])
    text = equations_text([function])
    assert len(re.findall(r"=real_sincos\(", text)) == 2
    assert len(re.findall(r"=(?:sin|cos)\(", text)) == 2  # of y and of x y + 1
    expected = [float(v) for v in function(1.25, 0.3)]
    np.testing.assert_allclose(evaluated(function, [1.25, 0.3], tmp_path), expected, rtol=2.0**-51, atol=0)


def test_a_variable_that_was_assigned_anew_is_another_angle() -> None:
    """CasADi uses the variables of numbers that are no longer needed again."""
    f = ca.Function("f", [X], [ca.cos(ca.sin(X) + 1)])
    text = equations_text([f])
    assert "a0=sin(a0);" in text
    assert "a0=cos(a0);" in text or "a1=cos(" in text
    assert "sincos" not in text
