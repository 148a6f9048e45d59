"""Wrong questions to a result, and wrong judgements of a system."""

from dataclasses import replace

import matplotlib.figure
import numpy as np

from orchestration import OrchestrationError, PowerBond, SystemDescriptionError, UnknownNameError, compare, ledger
from tests.faults.wrong_inputs.case import Bench, Wrong, made, untyped

U, O, E = UnknownNameError, OrchestrationError, SystemDescriptionError


def _axes() -> object:
    return matplotlib.figure.Figure().subplots()


def _later(b: Bench) -> object:
    return replace(b.result, time=b.result.time + 10.0)


TABLE = (
    Wrong("an unknown column", lambda b: b.result["plant.xx"], "column plant.xx", "plant.x", "did you mean", U),
    Wrong("a column in another case", lambda b: b.result["plant.X"], "column plant.X", "plant.x", "case-sensitive", U),
    Wrong(
        "a column that an array lacks",
        lambda b: b.result["plant.x[3]"],
        "column plant.x[3]",
        "plant.x[1] to plant.x[2]",
        "elements",
        U,
    ),
    Wrong("a column without its component", lambda b: b.result["x"], "column x", "plant.x", "did you mean", U),
    Wrong("a column by number", lambda b: b.result[0], "column 0", "text", "such as", U),
    Wrong("a column by slice", lambda b: b.result[1:3], "column slice", "text", "such as", U),
    Wrong(
        "ticks of an unknown column",
        lambda b: b.result.at_ticks("sensor.F"),
        "column sensor.F",
        "sensor.F_hat",
        "did you mean",
        U,
    ),
    Wrong(
        "ticks that were not recorded",
        lambda b: b.result.at_ticks("controller.e"),
        "controller.e",
        "0.0001 s",
        "record every step",
        O,
    ),
    Wrong(
        "the unit of an unknown column",
        lambda b: b.result.unit("plant.xx"),
        "column plant.xx",
        "plant.x",
        "did you mean",
        U,
    ),
    Wrong(
        "a plot of an unknown column",
        lambda b: b.result.plot("plant.xx"),
        "column plant.xx",
        "plant.x",
        "did you mean",
        U,
    ),
    Wrong("a plot of nothing", lambda b: b.result.plot("plnt.*"), "column plnt.*", "plant.x", "did you mean", U),
    Wrong(
        "a plot of two units in one panel",
        lambda b: b.result.plot("plant.x", "plant.q", ax=_axes()),
        "units m, rad",
        "one panel",
        "Leave ax out",
        O,
    ),
    Wrong("a plot into a text", lambda b: b.result.plot("plant.x", ax="top"), "ax", "'top'", "Axes", O),
    Wrong("a plot of a number", lambda b: b.result.plot(5), "5", "text", "such as", U),
    Wrong("a comparison with a number", lambda b: untyped(compare)(b.result, 5), "compare", "5", "Result", O),
    Wrong(
        "a comparison with an array",
        lambda b: untyped(compare)(b.result, np.zeros(3)),
        "compare",
        "ndarray",
        "Result",
        O,
    ),
    Wrong(
        "a comparison at no common time",
        lambda b: untyped(compare)(b.result, _later(b)),
        "no common communication point",
        "0 to 0.001 s|10 to 10.001 s",
        "same",
        O,
    ),
    Wrong("a power bond with a sign of 2", made(PowerBond, "a.F", "b.v", 2), "a.F * b.v", "2", "1 nor -1", E),
    Wrong(
        "a power bond of an unknown effort",
        lambda b: untyped(ledger)(b.result, PowerBond("plant.tua", "plant.dq"), b.loop),
        "plant|tua",
        "tau",
        "did you mean",
        O,
    ),
    Wrong(
        "a power bond that is not connected",
        lambda b: untyped(ledger)(b.result, PowerBond("actuator.tau[1]", "sensor.F_hat[1]"), b.loop),
        "actuator.tau[1]",
        "sensor",
        "not connected",
        E,
    ),
    Wrong(
        "a power bond that is a text",
        lambda b: untyped(ledger)(b.result, "plant.tau", b.loop),
        "bond",
        "'plant.tau'",
        "PowerBond(",
        E,
    ),
    Wrong(
        "a verdict for an unknown algorithm",
        lambda b: b.loop.stability(1e-4, "jacoby"),
        "algorithm 'jacoby'",
        "jacobi",
        "did you mean",
        E,
    ),
    Wrong("a verdict for a step of zero", lambda b: b.loop.stability(0.0), "step", "0 s", "positive", E),
    Wrong(
        "a verdict for a step that is a text", lambda b: b.loop.stability("1e-4"), "step", "'1e-4'", "number, in s", E
    ),
    Wrong(
        "a verdict at a time that is negative",
        lambda b: b.loop.stability(1e-4, at=-1.0),
        "at = -1 s",
        "0 s",
        "later",
        E,
    ),
)
