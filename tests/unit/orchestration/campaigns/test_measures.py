"""Measures as users give them: ready ones, formulas and functions; and the identity of a function's code."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from orchestration import Measure, OrchestrationError, Result, Study, StudyError, System, SystemDescriptionError
from orchestration.campaigns.measuring.code_identity import function_identity
from orchestration.campaigns.measuring.measure import measured
from orchestration.campaigns.measuring.registry import ready_measures
from orchestration.errors import FormulaError

LIMIT = 2.0
RESULT = Result(np.array([0.0, 1.0]), ("plant.x",), np.array([[1.0], [3.0]]))


def last(result: Result) -> float:
    """The last value."""
    return result["plant.x"][-1]


def above(result: Result) -> float:
    """How far the last value is above a limit."""
    return result["plant.x"][-1] - LIMIT


def test_formulas_have_names_and_units(loop: System) -> None:
    study = Study(loop, ["max(plant.x)", "swing = max(plant.x) - min(plant.x)", "t = time_of_max(plant.x)"])
    assert study.units == {"max(plant.x)": "m", "swing": "m", "t": "s"}


def test_functions_have_names_and_units(loop: System) -> None:
    pair = Measure.of(lambda _: {"a": 1.0, "b": 2.0}, ["a", "b"], ["m", "s"])
    study = Study(loop, [last, ("top", "m", lambda result: result["plant.x"].max()), pair])
    assert study.units == {"last": "", "top": "m", "a": "m", "b": "s"}


def test_a_mapping_names_measures(loop: System) -> None:
    assert list(Study(loop, {"top": "max(plant.x)", "end": last}).units) == ["top", "end"]


def test_ready_measures_go_by_their_names(fig2: System) -> None:
    name = next(iter(ready_measures()))
    assert list(Study(fig2, name).units) == [name]


def test_variants_must_have_the_columns_of_a_formula(loop: System, fig2: System) -> None:
    with pytest.raises(SystemDescriptionError, match="source"):
        Study({"loop": loop, "arm": fig2}, "max(source.u)")


WRONG: dict[str, tuple[Any, type[OrchestrationError], str]] = {
    "nothing": ([], StudyError, "needs a measure"),
    "an unknown name": ("peak_farce", StudyError, "There is no ready measure peak_farce; did you mean peak_force"),
    "no formula": ("max(plant.x", FormulaError, "max"),
    "an unknown column": ("max(plant.z)", SystemDescriptionError, "plant has no variable z"),
    "the same twice": (["max(plant.x)", "max(plant.x)"], StudyError, "given twice"),
    "a reserved name": ("status = max(plant.x)", StudyError, "a name of its own meaning"),
    "a name of a store's own": ("key = max(plant.x)", StudyError, "a name of its own meaning"),
    "a number": (5, StudyError, "give a formula"),
    "a function without a name": (lambda _: 1.0, StudyError, "give one with it"),
    "no function": ({"top": 5}, StudyError, "give a function of a Result"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_measure_is_refused(loop: System, case: str) -> None:
    given, kind, message = WRONG[case]
    with pytest.raises(kind, match=message):
        Study(loop, given)


def test_names_and_units_of_a_function_fit_each_other() -> None:
    with pytest.raises(StudyError, match="2 names, but 3 units"):
        Measure.of(last, ["a", "b"], ["m", "s", "N"])


def test_columns_of_a_function_are_checked(loop: System) -> None:
    with pytest.raises(SystemDescriptionError, match="plant has no variable z"):
        Study(loop, Measure.of(last, columns=["plant.z"]))


def fails(result: Result) -> float:
    """A function with a fault."""
    return result["plant.y"][0]


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (fails, "Measure m: its function failed with UnknownNameError: The result has no column plant.y"),
        (lambda _: 1 / 0, "Measure m: its function failed with ZeroDivisionError: division by zero."),
        (lambda _: "high", "Measure m: its function returned 'high' for m; return a number."),
        (lambda result: result["plant.x"], "for m; return a number."),
        (lambda _: None, "Measure m: its function returned None for m; return a number."),
        (lambda _: 1j, "return a number."),
        (lambda _: {"k": 1.0}, "without m; return each name."),
    ],
)
def test_a_function_that_fails_is_a_sentence(function: Callable[[Result], Any], message: str) -> None:
    values, said = measured([Measure.of(last), Measure.of(function, "m")], RESULT)
    assert np.isnan(values).all()
    assert len(values) == 2
    assert message in said


def test_one_number_is_not_enough_for_two_names() -> None:
    assert "without b" in measured([Measure.of(last, ["a", "b"])], RESULT)[1]


def test_numbers_of_any_kind_are_taken() -> None:
    for value in (True, 3, np.float32(0.5), np.array(2.5)):
        assert measured([Measure.of(lambda _, v=value: v, "m")], RESULT) == ((float(value),), "")


def made(text: str, **names: Any) -> Callable[..., Any]:
    """The function ``f`` that a text defines among names."""
    exec(text, names)
    return names["f"]


BASE = "def f(r):\n    return r + 1"


@pytest.mark.parametrize(
    "same",
    ["def f(r):\n    # a comment\n\n    return r + 1", "def f(r):  return (r + 1)"],
)
def test_comments_and_spaces_are_no_part_of_the_code(same: str) -> None:
    assert function_identity(made(same)) == function_identity(made(BASE))


@pytest.mark.parametrize(
    "other",
    ["def f(r):\n    return r + 2", "def f(r):\n    return r - 1", "def f(r, k=1):\n    return r + 1"],
)
def test_other_code_has_another_identity(other: str) -> None:
    assert function_identity(made(other)) != function_identity(made(BASE))


@pytest.mark.parametrize(
    "values", [(1, 2), ("a", "b"), ([1.0], [2.0]), (np.zeros(2), np.ones(2)), ({1}, {2}), (len, max)]
)
def test_values_that_the_code_reads_are_a_part_of_it(values: tuple[Any, Any]) -> None:
    text = "def f(r):\n    return r, k"
    first, second = (function_identity(made(text, k=value)) for value in values)
    assert first != second
    assert first == function_identity(made(text, k=values[0]))


def test_functions_and_classes_that_the_code_uses_are_a_part_of_it() -> None:
    text = "def f(r):\n    return g(r)"
    one, two = made("def f(r):\n    return 1"), made("def f(r):\n    return 2")
    assert function_identity(made(text, g=one)) != function_identity(made(text, g=two))


def test_values_from_enclosing_functions_are_a_part_of_it() -> None:
    def outer(limit: float) -> Callable[[float], float]:
        return lambda r: r - limit

    assert function_identity(outer(1.0)) == function_identity(outer(1.0))
    assert function_identity(outer(1.0)) != function_identity(outer(2.0))


def test_a_function_that_calls_itself_has_an_identity() -> None:
    text = "def f(r):\n    return f(r - 1) if r else {}"
    assert function_identity(made(text.format(0))) != function_identity(made(text.format(1)))


def test_a_value_whose_content_cannot_be_told_is_refused() -> None:
    with open(__file__, encoding="utf-8") as file, pytest.raises(StudyError, match="TextIOWrapper"):
        function_identity(made("def f(r):\n    return k", k=file))


def test_constants_of_a_module_are_a_part_of_its_functions(monkeypatch: pytest.MonkeyPatch) -> None:
    before = Measure.of(above).identity
    monkeypatch.setitem(globals(), "LIMIT", 3.0)
    assert Measure.of(above).identity != before
    assert Measure.of(last).identity != Measure.of(last, "m").identity
