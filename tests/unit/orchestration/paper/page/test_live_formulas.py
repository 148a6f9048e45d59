"""The measures of the live page as records: each part once, the right columns, and the numbers that Python has."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from orchestration import Result
from orchestration.errors import FormulaError
from orchestration.paper.page.live_formulas import MEASURES, SHOWN, Formulas

OUTPUTS = ("plant.x[1]", "plant.x[2]", "plant.F_ext[1]", "plant.F_ext[2]", "controller.e[1]", "controller.e[2]")
COMPUTE = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "norm": np.hypot,
    "abs": lambda a, _: np.abs(a),
    "sqrt": lambda a, _: np.sqrt(a),
    ">": lambda a, b: np.greater(a, b) * 1.0,
    ">=": lambda a, b: np.greater_equal(a, b) * 1.0,
    "count": lambda a, _: np.cumsum(np.diff(a, prepend=0.0) > 0),
}
"""All operations that ``script/formulas.js`` has, besides these reductions."""
REDUCE = {"max": np.max, "min": np.min, "mean": np.mean, "initial": lambda a: a[0], "final": lambda a: a[-1]}
TEXTS = (
    "max(norm(plant.F_ext))",
    "min(plant.x[1])",
    "mean(plant.x[2], where=time < 0.5)",
    "rms(plant.x[1] - plant.x[2])",
    "rms(plant.x[1], where=plant.x[2] <= 0)",
    "share(not norm(plant.F_ext) > 0 and plant.x[1] >= 0)",
    "first_time(norm(plant.F_ext) > 0)",
    "last_time(norm(plant.F_ext) > 0)",
    "final(plant.x[1]) - initial(-plant.x[1])",
    "max(abs(plant.x[2]), where=time > 2)",
)
"""Formulas that both the page and `Result.measure` can read; the last one has no instant."""


@pytest.fixture
def formulas() -> Formulas:
    return Formulas(("one", "two", SHOWN), OUTPUTS)


@pytest.fixture(scope="module")
def result() -> Result:
    """A run of the plant alone that touches twice."""
    time = np.linspace(0.0, 1.0, 101)
    force = np.where(np.sin(9 * time) > 0.6, np.sin(9 * time), 0.0)
    rows = np.column_stack([np.cos(5 * time), np.sin(3 * time) - 0.5, force, -2 * force])
    return Result(time, OUTPUTS[:4], rows)


def value(formulas: Formulas, place: int, rows: Mapping[str, Mapping[str, np.ndarray]]) -> Any:
    """The value at a place, computed by numpy."""
    op, *operands = formulas.nodes[place]
    if op == "number":
        return operands[0]
    if op == "column":
        run, name, late = operands
        return rows[run][name][late:]
    found = [value(formulas, operand, rows) for operand in operands]
    if op in REDUCE:
        chosen = found[0][found[1] == 1] if len(found) > 1 else found[0]
        return REDUCE[op](chosen) if len(chosen) else np.nan
    size = min((len(each) for each in found if np.ndim(each)), default=0)
    cut = [each[:size] if np.ndim(each) else each for each in found]
    return COMPUTE[op](cut[0], cut[-1])


def columns(result: Result, run: str = SHOWN) -> dict[str, dict[str, np.ndarray]]:
    """The rows of a run as the page has them."""
    return {run: {"time": result.time, **{name: result[name] for name in result.names}}}


@pytest.mark.parametrize("text", TEXTS)
def test_a_formula_gives_the_number_that_python_measures(text: str, formulas: Formulas, result: Result) -> None:
    found = value(formulas, formulas.place(text), columns(result))
    # Both add up 101 numbers below 3, whose order differs.
    np.testing.assert_allclose(found, result.measure(text), rtol=101 * np.finfo(float).eps)


def test_every_operation_is_one_that_the_script_has(formulas: Formulas) -> None:
    for text in (*TEXTS, *MEASURES):
        formulas.place(text)
    known = {"number", "start", "column", *COMPUTE, *REDUCE}
    assert {op for op, *_ in formulas.nodes} <= known


def test_each_part_stands_once_and_behind_its_own_parts(formulas: Formulas) -> None:
    place = formulas.place("max(norm(plant.x)) - min(norm(plant.x))")
    nodes = [tuple(node) for node in formulas.nodes]
    assert len(set(nodes)) == len(nodes)
    assert [op for op, *_ in nodes].count("norm") == 1
    for at, (op, *operands) in enumerate(nodes):
        assert op == "column" or all(operand < at for operand in operands)
    assert formulas.place("max(norm(plant.x)) - min(norm(plant.x))") == place
    assert len(formulas.nodes) == len(nodes)


def test_a_name_is_a_column_of_a_run_a_measure_or_a_start_value(formulas: Formulas) -> None:
    place = formulas.place("two.peak_force / one.plant.m[2] + final(plant.x[1])")
    assert ["start", "one", "plant.m[2]"] in formulas.nodes
    assert formulas.columns == {"two": ["plant.F_ext[1]", "plant.F_ext[2]"], SHOWN: ["plant.x[1]"]}
    assert formulas.runs_of(place) == {"two", SHOWN}


@pytest.mark.parametrize(("name", "late"), [("plant.x[1]", 0), ("controller.e[1]", 1), ("time", 0)])
def test_what_a_sampled_component_computes_begins_a_row_later(name: str, late: int, formulas: Formulas) -> None:
    formulas.place(f"final({name})")
    assert formulas.nodes[0] == ["column", SHOWN, name, late]


@pytest.mark.parametrize(("comparison", "expected"), [("<", 1), ("<=", 1), (">", 0), (">=", 0)])
def test_a_limit_is_compared_the_right_way_round(comparison: str, expected: int, formulas: Formulas) -> None:
    place = formulas.compared(formulas.number(1.0), comparison, formulas.number(2.0))
    assert value(formulas, place, {}) == expected
    alike = formulas.compared(formulas.number(2.0), comparison, formulas.number(2.0))
    assert value(formulas, alike, {}) == ("=" in comparison)


def test_the_times_of_a_contact_are_counted(formulas: Formulas, result: Result) -> None:
    touching = np.hypot(*result["plant.F_ext"].T) > 0
    assert value(formulas, formulas.place("bounces"), columns(result)) == np.sum(touching[1:] & ~touching[:-1]) - 1 == 1


def test_what_is_no_formula_is_refused(formulas: Formulas) -> None:
    with pytest.raises(FormulaError, match="Measure largest"):
        formulas.place("largest(plant.x[1])")


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("share(plant.x[1] > 0 or plant.x[2] > 0)", "or"),
        ("share(plant.x[1] == 0)", "=="),
        ("integral(plant.x[1])", "integral"),
        ("first_time(plant.x[1] > 0, where=time > 0.5)", "first_time"),
    ],
)
def test_what_the_script_lacks_is_refused(text: str, part: str, formulas: Formulas) -> None:
    with pytest.raises(TypeError, match=f"{part}.* is no part of a formula of the page"):
        formulas.place(text)
