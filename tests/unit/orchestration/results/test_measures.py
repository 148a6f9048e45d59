"""Measures of results by values that are computed by hand, and the same numbers as the claims have of a run."""

import math

import numpy as np
import pytest

from orchestration import FormulaError, OrchestrationError, Result, UnknownNameError, scenario, simulate
from orchestration.paper.measure import SETTLED, contact, norms, summarize
from orchestration.results.measures.expression import KINDS, Reduction
from orchestration.results.measures.formula import Formula
from orchestration.results.measures.parser import parse_formula

NAN = math.nan


@pytest.fixture(scope="module")
def small() -> Result:
    """Five rows at unequal times; ``plant`` is continuous, ``controller`` is sampled, and so is ``Drive 1``."""
    time = np.array([0.0, 0.5, 1.0, 2.0, 4.0])  # s, steps of 0.5, 0.5, 1 and 2 s, all exact
    columns = {
        "plant.F[1]": [0.0, 3.0, -6.0, 3.0, 0.0],
        "plant.F[2]": [0.0, 4.0, 8.0, -4.0, 0.0],
        "plant.gap": [2.0, -1.0, -1.0, 1.0, 3.0],
        "controller.e": [9.0, 1.0, 2.0, -4.0, 2.0],  # held over the four steps: 1, 2, -4, 2
        "Drive 1.w": [7.0, 5.0, 6.0, 7.0, 8.0],
    }
    units = {"plant.F[1]": "N", "plant.F[2]": "N", "plant.gap": "m", "controller.e": "m", "Drive 1.w": "rad/s"}
    rows = np.column_stack(list(columns.values()))
    return Result(time, tuple(columns), rows, units, sample_times={"controller": 0.5, "Drive 1": 0.5})


BY_HAND = {
    # All rows of a continuous component, each at its time.
    "max(plant.gap)": 3.0,
    "min(plant.gap)": -1.0,
    "mean(plant.gap)": 0.8,
    "rms(plant.gap)": math.sqrt(16 / 5),
    "initial(plant.gap)": 2.0,
    "final(plant.gap)": 3.0,
    "time_of_max(norm(plant.F))": 1.0,
    "time_of_min(plant.gap)": 0.5,  # the first of two
    "integral(plant.gap)": 2 * 0.5 - 1 * 0.5 - 1 * 1 + 1 * 2,  # the last row begins no step
    "duration(plant.gap < 0)": 1.5,
    "duration(plant.gap > 2)": 0.0,
    "share(plant.gap < 0)": 0.4,
    "first_time(plant.gap < 0)": 0.5,
    "last_time(plant.gap < 0)": 1.0,
    # The steps, where a component is sampled: row k + 1 of it, row k of all else.
    "max(controller.e)": 2.0,
    "min(controller.e)": -4.0,
    "mean(controller.e)": 0.25,
    "rms(controller.e)": 2.5,
    "initial(controller.e)": 1.0,
    "final(controller.e)": 2.0,
    "time_of_max(controller.e)": 0.5,
    "time_of_min(controller.e)": 1.0,
    "integral(controller.e)": 1 * 0.5 + 2 * 0.5 - 4 * 1 + 2 * 2,
    "duration(controller.e > 1)": 2.5,
    "share(controller.e > 1)": 0.5,
    "first_time(controller.e > 1)": 0.5,
    "last_time(controller.e > 1)": 2.0,
    "max(controller.e + plant.gap)": 3.0,  # 1 + 2, 2 - 1, -4 - 1, 2 + 1
    "time_of_max(controller.e + plant.gap)": 0.0,
    "max(time + 0 * controller.e)": 2.0,  # the last step begins there
    "max(plant.gap, where=controller.e < 2)": 2.0,  # at the steps, at 0 and 1 s
    'final("Drive 1.w")': 8.0,
    'initial("Drive 1.w")': 5.0,
    # Conditions.
    "max(plant.gap, where=norm(plant.F) > 0)": 1.0,
    "mean(plant.gap, where=time >= 1)": 1.0,
    "share(plant.gap < 0, where=time <= 1)": 2 / 3,
    "duration(plant.gap < 0, where=time >= 1)": 1.0,
    "integral(plant.gap, where=time >= 1)": 1.0,
    "first_time(plant.gap < 0, where=time > 0.6)": 1.0,
    "max(plant.gap, where=before(norm(plant.F) > 0))": 2.0,
    "min(plant.gap, where=since(plant.F[1] < 0))": -1.0,
    "duration(since(plant.F[1] < 0))": 3.0,
    "duration(before(plant.gap > 99))": 4.0,
    "duration(since(1 < 2) and not before(1 < 2))": 4.0,
    "share(0 < plant.gap <= 2)": 0.4,
    "share(plant.gap == 3 or plant.gap != plant.gap)": 0.2,
    # Arithmetic.
    "max(plant.gap) - min(plant.gap) * 2": 5.0,
    "norm(max(plant.F[1]), max(plant.F[2]) - 4)": 5.0,
    "norm(final(plant.F) - initial(plant.F))": 0.0,
    "max(norm(plant.F - 3))": 10.295630140987,  # |(-9, 5)| = sqrt(106), rounded
    "abs(min(plant.gap)) / max(plant.gap)": 1 / 3,
    "sqrt(max(plant.gap) + 1)": 2.0,
    "max(norm(plant.gap))": 3.0,
    "max(norm(plant.gap), where=plant.gap < 0)": 1.0,
    "max(sqrt(plant.gap**2))": 3.0,
    "-max(-plant.gap)": -1.0,
    "max(plant.gap) / duration(plant.gap > 9)": math.inf,
    # Nothing that fulfils a condition.
    "max(plant.gap, where=time > 9)": NAN,
    "mean(plant.gap, where=time > 9)": NAN,
    "final(plant.gap, where=time > 9)": NAN,
    "share(plant.gap > 0, where=time > 9)": NAN,
    "duration(plant.gap > 0, where=time > 9)": 0.0,
    "integral(plant.gap, where=time > 9)": 0.0,
    "first_time(plant.gap > 9)": NAN,
    "last_time(plant.gap > 9)": NAN,
}


@pytest.mark.parametrize("text", BY_HAND)
def test_a_measure_is_what_a_hand_computes(text: str, small: Result) -> None:
    # All numbers are exact but for at most two roundings of a quotient or a root, so 4 units of the last place.
    digits = 1e-13 if "- 3" in text else 4 * np.finfo(float).eps
    assert parse_formula(text).evaluate(small) == pytest.approx(BY_HAND[text], rel=digits, abs=0, nan_ok=True)


def test_every_kind_of_reduction_is_computed_by_hand_for_rows_and_for_steps() -> None:
    for column in ("plant", "controller"):
        kinds = {r.kind for text in BY_HAND for r in parse_formula(text).reductions if column in str(Formula(r))}
        assert kinds == set(KINDS)


def test_a_result_without_a_step_has_no_instant_of_a_sampled_component(small: Result) -> None:
    single = Result(small.time[:1], small.names, small.rows[:1], sample_times=small.sample_times)
    assert parse_formula("final(plant.gap)").evaluate(single) == 2.0
    assert math.isnan(parse_formula("final(controller.e)").evaluate(single))
    assert parse_formula("integral(plant.gap)").evaluate(single) == 0.0
    none = Result(small.time[:0], small.names, small.rows[:0], sample_times=small.sample_times)
    assert math.isnan(parse_formula("max(plant.gap)").evaluate(none))
    assert parse_formula("duration(controller.e > 0)").evaluate(none) == 0.0


def test_sums_go_from_first_to_last() -> None:
    """np.sum adds in pairs, which a loop in C does not."""
    values = np.random.default_rng(3).normal(size=1000) * 10.0 ** np.arange(1000) ** 0.3
    total = 0.0
    for value in values:
        total += value
    result = Result(np.arange(1000.0), ("a.x",), values[:, None])
    assert parse_formula("mean(a.x)").evaluate(result) == total / 1000
    assert np.sum(values) != total


def test_numbers_beyond_a_double_are_infinite_without_a_warning() -> None:
    result = Result(np.arange(3.0), ("a.x",), np.array([[1e200], [-1e308], [1e308]]))
    assert parse_formula("rms(a.x)").evaluate(result) == math.inf
    assert parse_formula("integral(a.x * 1e10)").evaluate(result) == -math.inf  # the last row begins no step
    assert math.isnan(parse_formula("mean(a.x * 1e10)").evaluate(result))
    assert parse_formula("mean(10 * a.x, where=time > 1)").evaluate(result) == math.inf


def test_combining_many_runs_at_once_gives_the_same_bits() -> None:
    formula = parse_formula("norm(max(a.x), min(a.x)) / 3 - abs(mean(a.x) * rms(a.y))")
    values = np.random.default_rng(4).normal(size=(4, 50))
    together = formula.combine(values)
    assert together.tolist() == [formula.combine(values[:, k]) for k in range(50)]
    assert isinstance(formula.combine(values[:, 0]), float)


UNITS = {
    "max(norm(plant.F))": "N",
    "max(abs(plant.gap - 1))": "m",
    "max(2 * plant.gap) / 3": "m",
    "max(plant.gap) - min(plant.gap)": "m",
    "max(plant.gap) / min(plant.gap)": "",
    "max(sqrt(plant.gap**2))": "m",
    "max(plant.gap**2)": "",
    "max(plant.gap + plant.F[1])": "",
    "max(plant.gap * plant.F[1])": "",
    "integral(plant.gap)": "m.s",
    "integral(plant.speed)": "m",
    "integral(plant.work)": "",
    "max(plant.none)": "",
    "max(plant.none + plant.gap)": "",
    "max(time)": "s",
    "time_of_max(plant.gap)": "s",
    "duration(plant.gap > 0)": "s",
    "first_time(plant.gap > 0) - last_time(plant.gap > 0)": "s",
    "share(plant.gap > 0)": "",
    "max(plant.gap) * share(plant.gap > 0)": "m",
    "2 * 3 + share(plant.gap > 0)": "",
}


@pytest.mark.parametrize("text", UNITS)
def test_units_follow_where_the_rule_is_plain(text: str) -> None:
    units = {"plant.F": "N", "plant.F[1]": "N", "plant.gap": "m", "plant.speed": "m/s", "plant.work": "N.m/rad"}
    assert parse_formula(text).unit(lambda name: units.get(name, "")) == UNITS[text]


def test_arrays_give_way_to_their_elements(small: Result) -> None:
    formula = parse_formula("rms(norm(plant.F), where=abs(controller.e) > 0) + max(plant.gap)")
    assert formula.columns == ("plant.F", "controller.e", "plant.gap")
    scalars = formula.expanded(small.columns_of)
    assert str(scalars) == "rms(norm(plant.F[1], plant.F[2]), where=abs(controller.e) > 0) + max(plant.gap)"
    assert [reduction.kind for reduction in scalars.reductions] == ["rms", "max"]
    assert isinstance(scalars.reductions[1], Reduction)
    assert scalars.reductions[1].where is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "max(plant.F)",
            "max(plant.F) has 2 elements, and a measure is one number; choose one, such as max(plant.F[1])",
        ),
        ("max(plant.gap, where=plant.F > 0)", "plant.F > 0 is 2 conditions, since plant.F is an array; write one"),
        ("max(norm(plant.F + plant.M))", "plant.F + plant.M: plant.F has 2 elements, plant.M has 3; join equal ones."),
        ("max(plant.word)", "plant.word is a column of texts, which cannot be measured"),
    ],
)
def test_what_is_no_number_of_this_result_is_refused(text: str, message: str, small: Result) -> None:
    names = (*small.names, "plant.M[1]", "plant.M[2]", "plant.M[3]")
    rows = np.column_stack([small.rows, np.zeros((5, 3))])
    result = Result(small.time, names, rows, texts={"plant.word": np.array(["a"] * 5, object)})
    with pytest.raises(FormulaError) as caught:
        parse_formula(text).evaluate(result)
    assert message in str(caught.value)


def test_a_column_that_a_result_lacks_is_named_with_near_ones(small: Result) -> None:
    with pytest.raises(UnknownNameError, match=r"no column plant.gab; did you mean plant.gap"):
        parse_formula("max(plant.gab)").evaluate(small)
    assert issubclass(FormulaError, OrchestrationError)


def test_fig5_measures_what_its_claims_measure() -> None:
    """The claims compute the same with numpy's pairwise sums and its norm, whose last bits may differ."""
    result = simulate(scenario("fig5-first"))
    claimed, touch = summarize(result), contact(result)
    touching = norms(result["plant.F_ext"])[:-1] > 0  # the tip bounces once, so the claims' contact has a gap
    e, error = norms(result.at_ticks("controller.e"))[touching], result.at_ticks("controller.p_hat[2]")[touching] - 1
    until_contact = "where=before(norm(plant.F_ext) > 0)"
    expected = {
        "max(norm(controller.e))": claimed.e_max,
        "max(norm(controller.e), where=norm(plant.F_ext) > 0)": e.max(),
        "rms(norm(controller.e), where=norm(plant.F_ext) > 0)": math.sqrt(np.mean(e * e)),
        f"max(norm(controller.e), {until_contact})": claimed.e_start,
        f"final(abs(controller.p_hat[2] - 1), {until_contact})": claimed.m2_at_contact,
        f"last_time(abs(controller.p_hat[2] - 1) > {SETTLED}, {until_contact})": claimed.m2_settled,
        "max(abs(controller.p_hat[2] - 1), where=norm(plant.F_ext) > 0)": np.abs(error).max(),
        "max(abs(controller.tau_cmd[1]))": claimed.torque[0],
        "max(abs(controller.tau_cmd[2]))": claimed.torque[1],
        "norm(final(plant.x) - initial(plant.x))": np.linalg.norm(result["plant.x"][-1] - result["plant.x"][0]),
        "first_time(norm(plant.F_ext) > 0)": touch.first,
        "last_time(norm(plant.F_ext) > 0)": touch.last,
        "max(norm(plant.F_ext))": touch.peak,
    }
    for text, number in expected.items():
        # 1e5 summands: two orders of summing differ by 1e5 roundings at most.
        assert parse_formula(text).evaluate(result) == pytest.approx(number, rel=1e-11), text
