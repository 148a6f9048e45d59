"""Reductions in C have the bits of those by numpy, whatever the formula is: NaN, infinities and signs of zeros too."""

from functools import cache

import numpy as np
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from orchestration import Result, scenario, simulate
from orchestration.containers.native.program import NativeProgram
from orchestration.results.measures.expression import (
    Before,
    Binary,
    Column,
    Norm,
    Number,
    Reduction,
    Since,
    Time,
    Unary,
)
from orchestration.results.measures.reduction import reduced
from tests.property.measures.formulas import reductions

COLUMNS = ("plant.F_ext[1]", "plant.gap", "plant.K_f", "controller.e[1]", "controller.p_hat[2]", "trajectory.x_v[1]")
STEP, STOP_TIME = 5e-4, 1.1  # s; the tip touches the wall at 0.9 s
PARTS = (Column("plant.F_ext[1]"), Column("controller.e[1]"))
TOUCHES = Binary(">", Norm((PARTS[0],)), Number(0.0))
NOT_A_NUMBER = Unary("sqrt", Unary("-", PARTS[1]))  # where the error is positive


@cache
def expected() -> Result:
    return simulate(scenario("fig2").with_sample_time(STEP), stop_time=STOP_TIME, record=list(COLUMNS))


def require_equal(asked: list[Reduction]) -> None:
    program = NativeProgram.of(scenario("fig2").with_sample_time(STEP), reductions=asked)
    found = program.runs(np.empty((1, 0)), np.array([STEP]), STOP_TIME)
    assert found.messages == ("",)
    with np.errstate(all="ignore"):
        by_numpy = np.array([reduced(reduction, expected()) for reduction in asked])
    numbers = ~np.isnan(by_numpy)
    wrong = [
        f"{reduction}: {number!r} in C, {other!r} by numpy"
        for reduction, number, other in zip(asked, found.reduced[0].tolist(), by_numpy.tolist(), strict=True)
        if np.isnan(number) != np.isnan(other) or (number, np.signbit(number)) != (other, np.signbit(other))
        if not (np.isnan(number) and np.isnan(other))
    ]
    assert numbers.any()
    assert not wrong, "\n".join(wrong)


# Each example is compiled, so a failing one is shown as it is, without a search for a smaller one.
@settings(
    max_examples=4,
    deadline=None,
    derandomize=True,
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.large_base_example],
)
@given(st.lists(reductions(COLUMNS), min_size=30, max_size=30))
def test_reductions_in_c_are_those_of_numpy(asked: list[Reduction]) -> None:
    require_equal([Reduction("final", Time()), *asked])


def test_what_a_compiler_might_warn_of_is_compiled() -> None:
    same, touched = Binary("==", PARTS[1], PARTS[1]), Since(TOUCHES)
    both = Binary("and", Before(TOUCHES), Binary("or", Unary("not", Before(touched)), same))
    asked = [Reduction(kind, both, where) for kind in ("share", "duration") for where in (None, same, Before(same))]
    require_equal([Reduction("final", Time()), *asked])


def test_an_extreme_that_is_not_a_number_stays_one() -> None:
    wheres = (None, Before(TOUCHES), Since(TOUCHES), Binary(">", Time(), Number(9.0)))
    kinds = ("max", "min", "time_of_max", "time_of_min", "mean", "integral")
    asked = [Reduction(kind, NOT_A_NUMBER, where) for kind in kinds for where in wheres]
    require_equal([Reduction("final", Time()), *asked])


def test_the_first_of_equals_is_the_extreme_even_if_all_are_infinite() -> None:
    infinite = Binary("/", Number(1.0), Binary("-", PARTS[0], PARTS[0]))
    values = (Number(1.0), infinite, Unary("-", infinite), Norm((infinite, PARTS[1])), Norm(PARTS))
    kinds = ("max", "min", "time_of_max", "time_of_min")
    asked = [Reduction(kind, value, where) for kind in kinds for value in values for where in (None, TOUCHES)]
    require_equal([Reduction("final", Time()), *asked])
