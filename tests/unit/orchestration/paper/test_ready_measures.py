"""Ready measures: they measure the scenarios, their units are known, and the page lists them."""

import math
from pathlib import Path

import pytest

from orchestration import Result, scenario, simulate
from orchestration.paper.ready_measures import IN_SPACE, READY, as_markdown
from orchestration.results.measures.formula import Formula
from orchestration.results.measures.parser import parse_formula

PAGE = Path(__file__).parents[4] / "docs" / "objects" / "measures.md"
FORMULAS = {name: parse_formula(formula) for name, (formula, _) in READY.items()}
PLANAR = {name: formula for name, formula in FORMULAS.items() if name not in IN_SPACE}
SPATIAL = {name: FORMULAS[name] for name in IN_SPACE}


def recorded(formulas: list[Formula]) -> list[str]:
    return sorted({column for formula in formulas for column in formula.columns})


@pytest.fixture(scope="module")
def fig5() -> Result:
    return simulate(scenario("fig5"), record=recorded(list(PLANAR.values())))


@pytest.fixture(scope="module")
def puma() -> Result:
    return simulate(scenario("puma"), record=recorded(list(SPATIAL.values())))


@pytest.mark.parametrize("name", PLANAR)
def test_a_ready_measure_is_a_number_of_fig5_with_its_unit(name: str, fig5: Result) -> None:
    assert math.isfinite(FORMULAS[name].evaluate(fig5))
    assert FORMULAS[name].unit(fig5.unit) or name == "share_saturated"


@pytest.mark.parametrize("name", SPATIAL)
def test_a_measure_in_space_is_a_number_of_puma_with_its_unit(name: str, puma: Result) -> None:
    assert math.isfinite(FORMULAS[name].evaluate(puma))
    assert FORMULAS[name].unit(puma.unit) in {"m", "rad", "N", "kg"}


def test_formulas_stand_in_their_own_way_of_writing() -> None:
    assert [str(formula) for formula in FORMULAS.values()] == [formula for formula, _ in READY.values()]


def test_measures_without_an_estimate_serve_known_robots_and_other_controllers() -> None:
    formulas = {name: found for name, found in PLANAR.items() if "controller.p_hat[2]" not in found.columns}
    assert {name.partition("_")[0] for name in PLANAR.keys() - formulas.keys()} == {"m2"}
    result = simulate(scenario("fig2", controller="SlotineLiAdaptiveImpedance"), record=recorded([*formulas.values()]))
    assert all(math.isfinite(found.evaluate(result)) for found in formulas.values())


def test_the_page_lists_all_of_them(fig5: Result, puma: Result) -> None:
    units = {name: formula.unit((puma if name in SPATIAL else fig5).unit) for name, formula in FORMULAS.items()}
    assert PAGE.read_text(encoding="utf-8").endswith(f"\n\n{as_markdown(units)}")
