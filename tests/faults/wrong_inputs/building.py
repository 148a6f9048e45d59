"""Wrong models: declarations, units, Python where CasADi is needed, shapes."""

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, ContinuousModel, DefinitionError, Limits, SampledModel, build
from tests.faults.wrong_inputs.case import Action, Bench, Wrong, made, untyped

E = DefinitionError
HEAD = """import math
import casadi as ca
import numpy as np
from adaptimp_fmu import ContinuousModel, SampledModel
model = SampledModel("Gain", "Multiplies")
a = model.input("a", 0.0, description="In")
v = model.input("v", [0.0, 0.0], description="Two")
"""
TAIL = '\nmodel.output("y", y, description="Out")\n'


def _model() -> SampledModel:
    return SampledModel("Gain", "Multiplies")


def _with(**declared: object) -> Action:
    """Declare a parameter of a model."""
    options = {"name": "p", "start": 0.0, "description": "P", **declared}
    return lambda _: untyped(_model()).parameter(**options)


def _output(**declared: object) -> Action:
    options = {"name": "y", "value": ca.SX(1.0), "description": "Y", **declared}
    return lambda _: untyped(_model()).output(**options)


def _built(value: ca.SX) -> Action:
    def act(b: Bench) -> None:
        model = _model()
        model.output("y", value, description="Y")
        build(model, b.folder)

    return act


def _file(body: str) -> Action:
    """Write a file with a model, for ``adaptimp build mine.py``."""

    def write(b: Bench) -> None:
        (b.folder / "mine.py").write_text(HEAD + body + TAIL, encoding="utf-8")

    return write


def _evolved(_: Bench) -> None:
    model = ContinuousModel("Mass", "Moves")
    x = model.state("x", [0.0, 0.0])
    model.derivative(x, ca.SX(1.0))


def _no_state(_: Bench) -> None:
    model = ContinuousModel("Mass", "Moves")
    model.derivative(model.input("u", 0.0, description="U"), ca.SX(1.0))


def _forgotten(b: Bench) -> None:
    model = ContinuousModel("Mass", "Moves")
    model.output("x", model.state("x", 0.0), description="X")
    build(model, b.folder)


def _twice(_: Bench) -> None:
    model = _model()
    model.input("u", 0.0, description="U")
    model.input("u", 0.0, description="U")


def _event(_: Bench) -> None:
    model = ContinuousModel("Mass", "Moves")
    model.event("hit", model.input("u", 0.0, description="U"))


def _divisor(b: Bench) -> None:
    model = _model()
    z = model.state("z", 0.0)
    model.update_slowly(z, z, divisor="divisr")
    model.parameter("divisor", 1.0, description="D")
    model.output("y", z, description="Y")
    build(model, b.folder)


def _nameless(b: Bench) -> None:
    model = SampledModel("My model", "Multiplies")
    model.output("y", ca.SX(1.0), description="Y")
    build(model, b.folder)


TABLE = (
    Wrong("a model name with a blank", _nameless, "'My model'", "C identifier", "My_model", E),
    Wrong("a model without outputs", lambda b: build(_model(), b.folder), "Gain", "no outputs", "model.output(", E),
    Wrong("a variable declared twice", _twice, "Gain", "variable u", "another name", E),
    Wrong("a name with a blank", _with(name="my p"), "'my p'", "FMI name", "such as", E),
    Wrong("a declared element counted from zero", _with(name="p[0]"), "'p[0]'", "q[1]", "count elements from 1", E),
    Wrong("a variable without description", _with(description=""), "p", "description", "give", E),
    Wrong("the unit Nm", _with(unit="Nm"), '"Nm"', "N.m", "did you mean", E),
    Wrong("the unit Nm/rad", _with(unit="Nm/rad"), '"Nm/rad"', "N.m/rad", "did you mean", E),
    Wrong("the unit n.m", _with(unit="n.m"), '"n.m"', "N.m", "did you mean", E),
    Wrong("the unit m/s^2", _with(unit="m/s^2"), '"m/s^2"', "m/s2", "did you mean", E),
    Wrong("the unit N*m", _with(unit="N*m"), '"N*m"', "N.m", "did you mean", E),
    Wrong("the unit deg", _with(unit="deg"), '"deg"', "rad", 'display_unit="deg"', E),
    Wrong("the unit rpm", _with(unit="rpm"), '"rpm"', "rad/s", 'display_unit="rpm"', E),
    Wrong("the unit mm", _with(unit="mm"), '"mm"', "m", 'display_unit="mm"', E),
    Wrong("the unit kN/m", _with(unit="kN/m"), '"kN/m"', "SI units|N/m", 'display_unit="kN/m"', E),
    Wrong("an unknown unit", _with(unit="parsec"), '"parsec"', "known", "kg, m, s", E),
    Wrong("a display unit of another dimension", _with(unit="m", display_unit="deg"), "p", "deg|m", "rad", E),
    Wrong("an unknown display unit", _with(unit="rad", display_unit="dge"), "p|dge", "deg", "did you mean", E),
    Wrong("two units of three elements", _with(start=[0, 0, 0], unit=["m", "m"]), "p", "3|2", "one for all", E),
    Wrong("a unit that is a number", _with(unit=5), "p", "5", "text", E),
    Wrong("a start value that is a text", _with(start="4 N"), "p", "'4 N'", "number", E),
    Wrong("a start value of NaN", _with(start=float("nan")), "p", "nan", "finite", E),
    Wrong("a start value of None", _with(start=None), "p", "None", "number", E),
    Wrong("a start value that is a symbol", _with(start=ca.SX.sym("s")), "p", "SX", "number", E),
    Wrong(
        "a declared start value out of range",
        _with(start=-1.0, unit="N/m", limits=NOT_NEGATIVE),
        "p: start",
        "-1.0|0 N/m",
        "must be at least",
        E,
    ),
    Wrong("a range upside down", made(Limits, 1.0, 0.0), "Limits", "1|0", "minimum", E),
    Wrong("a range that is a pair", _with(limits=(0, 1)), "p", "(0, 1)", "Limits(", E),
    Wrong(
        "a sampling period of zero",
        made(SampledModel, "Gain", "Multiplies", sample_time=0.0),
        "sample_time",
        "0.0|1e-12 s",
        "must be at least",
        E,
    ),
    Wrong("an output that is a text", _output(value="y"), "y", "'y'", "expression", E),
    Wrong("an output that is None", _output(value=None), "y", "None", "expression", E),
    Wrong("an evolution of another length", _evolved, "Mass.x", "2|1", "as many", E),
    Wrong("a derivative of an input", _no_state, "Mass|u", "not a state", "model.state(", E),
    Wrong("a state without an evolution", _forgotten, "Mass|x", "derivative", "model.derivative(", E),
    Wrong("an event of an input", _event, "Mass: event hit", "inputs", "only states", E),
    Wrong("a divisor that is mistyped", _divisor, "Gain|divisr", "divisor", "did you mean", E),
    Wrong("an output of an undeclared symbol", _built(ca.SX.sym("k")), "Gain", "k", "model.parameter(", E),
    Wrong("an output of NaN", _built(ca.SX(float("nan"))), "Gain: output y", "NaN", "ca.sin", E),
)

FILES = (
    Wrong("if in a model", _file("y = 1.0 if a > 0 else 2.0"), "mine.py, line 8", "symbol", "ca.if_else"),
    Wrong(
        "and in a model",
        _file("y = ca.if_else(a > 0 and a < 1, 1.0, 2.0)"),
        "mine.py, line 8",
        "symbol",
        "ca.logic_and",
    ),
    Wrong("max in a model", _file("y = max(a, 1.0)"), "mine.py, line 8", "symbol", "ca.fmax"),
    Wrong("math.sin in a model", _file("y = math.sin(a)"), "Gain: output y", "NaN", "ca.sin"),
    Wrong("math.sin of an array in a model", _file("y = math.sin(v)"), "mine.py, line 8", "symbol", "ca.sin"),
    Wrong("math.atan2 in a model", _file("y = math.atan2(a, 1.0)"), "Gain: output y", "NaN", "ca.sin"),
    Wrong("np.sin in a model", _file("y = np.sin(a)"), "mine.py, line 8", "NumPy", "ca.sin", code=0),
    Wrong("a sum of two and three", _file("y = v + ca.SX.zeros(3)"), "mine.py, line 8", "2x1|3x1", "shape"),
    Wrong("an element beyond the last", _file("y = v[2]"), "mine.py, line 8", "2", "count from 0"),
    Wrong("int of a symbol", _file("y = int(a)"), "mine.py, line 8", "symbol", "ca.floor"),
    Wrong("range of a symbol", _file("y = sum(i for i in range(a))"), "mine.py, line 8", "symbol", "plain number"),
    Wrong("a name that is not defined", _file("y = K * a"), "mine.py, line 8", "NameError|K", "not defined"),
    Wrong(
        "a wrong unit in a file",
        _file('y = model.parameter("k", 1.0, unit="Nm", description="K")'),
        'mine.py, line 8|"Nm"',
        "N.m",
        "did you mean",
    ),
    Wrong("a package that is not installed", _file("import numpi"), "mine.py, line 8", "numpi", "install"),
)
"""Bodies of files for ``adaptimp build mine.py``, whose action only writes the file."""
