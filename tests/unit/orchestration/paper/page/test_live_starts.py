"""Start values of the live page: of a scenario, of a controller in another's place, and what settings change."""

from collections.abc import Mapping
from typing import Any

import pytest

from orchestration.paper.page.live_settings import FIGURES, live_settings
from orchestration.paper.page.live_starts import HOMES, Program, starts
from orchestration.paper.scenarios import CRAIG, SLOTINE_LI

OF_FMU = 0.125
"""Start value of every variable of the made-up programs: none of a scenario's."""
PERIODS = ("controller.sample_time", "sensor.sample_time")
HOGAN = "HoganImpedance"


@pytest.fixture(scope="module")
def found() -> dict[str, dict[str, Any]]:
    """Start values with programs that have the variables of the scenarios, and one more that no scenario sets."""
    return starts({controller: program(home) for controller, (home, _) in HOMES.items()})


def program(home: str) -> Program:
    names = [*FIGURES[home].values, *PERIODS, "plant.unknown"]
    variables: list[dict[str, Any]] = [{"name": name, "start": OF_FMU} for name in names]
    return Program(b"", {"description": {"variables": [*variables, {"name": "plant.x[1]", "start": None}]}})


def numbers(figure: str) -> Mapping[str, float]:
    return {path: value.number for path, value in FIGURES[figure].values.items()}


def test_given_are_the_numbers_of_the_scenario(found: dict[str, dict[str, Any]]) -> None:
    given = found["fig5"][CRAIG]["given"]
    assert {path: given[path] for path in numbers("fig5")} == numbers("fig5")
    assert given["plant.unknown"] == OF_FMU
    assert {given[path] for path in PERIODS} == {FIGURES["fig5"].step}
    assert "plant.x[1]" not in given


def test_what_the_program_lacks_is_not_given(found: dict[str, dict[str, Any]]) -> None:
    given = found["fig5"][HOGAN]["given"]
    assert "controller.Psi[1]" in numbers("fig5")
    assert "controller.Psi[1]" not in given
    assert given["controller.B[1]"] == numbers("fig5")["controller.B[1]"]


@pytest.mark.parametrize("figure", FIGURES)
def test_a_scenario_with_its_own_controller_is_that_of_the_command_line(
    figure: str, found: dict[str, dict[str, Any]]
) -> None:
    assert found[figure][FIGURES[figure].models["controller"]]["own"] == {}


def test_another_controller_brings_its_gains_and_takes_the_task(found: dict[str, dict[str, Any]]) -> None:
    own = found["fig2"][SLOTINE_LI]["own"]
    home = numbers("fig7")
    gains = {"controller.Psi[1]", "controller.Psi[2]", "controller.Gamma[2]", "controller.K_d[1]", "controller.K_d[2]"}
    assert own == {path: home[path] for path in gains}


def test_a_setting_changes_the_variables_of_its_figures(found: dict[str, dict[str, Any]]) -> None:
    paths = found["fig5"][CRAIG]["paths"]
    assert paths["K"] == ["controller.K[1]", "controller.K[2]"]
    assert paths["m2"] == ["plant.m[2]"]  # the controller of fig5 is wrong about it
    assert paths["m2_hat"] == ["controller.p_start[2]"]
    assert (paths["Psi_1"], paths["Psi_2"]) == (["controller.Psi[1]", "controller.Psi[2]"], [])
    assert found["fig2"][HOGAN]["paths"]["m2"] == ["plant.m[2]", "controller.p_start[2]"]  # that of fig2 knows it


def test_a_setting_goes_with_the_controller_that_was_switched_to(found: dict[str, dict[str, Any]]) -> None:
    paths = found["fig5"][SLOTINE_LI]["paths"]
    assert (paths["Psi_1"], paths["Psi_2"]) == ([], ["controller.Psi[1]", "controller.Psi[2]"])
    assert paths["gamma_margin"] == []


def test_the_sampling_period_is_that_of_all_components(found: dict[str, dict[str, Any]]) -> None:
    every = [of["paths"] for by_controller in found.values() for of in by_controller.values()]
    assert all(sorted(paths["sample_time"]) == sorted(PERIODS) for paths in every)
    assert all(set(paths) == {setting.key for setting in live_settings()} for paths in every)
