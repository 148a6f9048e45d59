"""Evidence that a run warns of walls that differ between connected components, and of nothing else."""

import math
import re
import warnings
from pathlib import Path

import numpy as np
import pytest

from orchestration import DifferentWallsWarning, Factor, Study, System, diagnose, scenario, simulate
from orchestration.master.walls import different_walls
from orchestration.paper.built_fmus import built
from orchestration.paper.scenarios import SCENARIOS, VARIANTS
from tests.unit.orchestration.checked import edited

WALL = float(np.max(scenario("fig2")["plant"]["wall_offset"]))  # m, of the paper's runs
MILLIMETRE = '<Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit>'


def said_by(system: System) -> list[str]:
    """What a short run says about walls, in the place of the caller."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", DifferentWallsWarning)
        simulate(system, stop_time=0.01)
    assert {w.filename for w in caught} <= {__file__}
    return [str(w.message) for w in caught]


def test_an_offset_that_differs_is_said_with_both_values_and_what_to_do() -> None:
    assert said_by(scenario("fig2").set({"plant.wall_offset": 1.4})) == [
        f"trajectory.wall_offset = {WALL:g} m, but plant.wall_offset = 1.4 m: both are told of one wall;"
        " set both to the same value."
    ]


def test_a_normal_that_differs_is_said_once_although_two_numbers_differ() -> None:
    (said,) = said_by(scenario("fig2").set({"plant.wall_normal": [0.0, -1.0]}))
    assert said.startswith("trajectory.wall_normal = (-1, 0), but plant.wall_normal = (0, -1):")


@pytest.mark.parametrize("name", [*SCENARIOS, *VARIANTS])
def test_no_figure_of_the_paper_has_two_walls(name: str) -> None:
    assert different_walls(scenario(name)) == []


def test_a_wall_that_is_moved_in_both_is_one_wall() -> None:
    moved = {f"{name}.wall_offset": 1.4 for name in ("plant", "trajectory")}
    assert different_walls(scenario("fig2").set(moved)) == []


def test_rounding_is_no_difference() -> None:
    turned = {"plant.wall_normal": [-1.0, 0.0], "trajectory.wall_normal": [math.cos(math.pi), math.sin(math.pi)]}
    assert different_walls(scenario("fig2").set(turned)) == []


def test_numbers_of_a_model_of_the_plant_may_differ() -> None:
    wrong = {"controller.l": [1.1, 0.9], "controller.gravity": 9.81}
    assert different_walls(scenario("fig2").set(wrong)) == []


def in_millimetres(description: str) -> str:
    """A description of VirtualTrajectory whose wall_offset is in mm."""
    units = description.replace("<UnitDefinitions>", f"<UnitDefinitions>{MILLIMETRE}")
    place = r'(<ScalarVariable name="wall_offset".*?<Real) declaredType="Length" unit="m" start="[^"]*"'
    return re.sub(place, r'\1 unit="mm" start="1450.0"', units, flags=re.DOTALL)


def test_walls_are_compared_and_told_in_one_unit(tmp_path: Path) -> None:
    foreign = edited(built("VirtualTrajectory"), tmp_path, in_millimetres)
    system = scenario("fig2").replace("trajectory", foreign)
    assert np.isclose(system["trajectory"]["wall_offset"], 1000 * WALL)  # mm
    assert different_walls(system) == []
    (found,) = different_walls(system.set({"trajectory.wall_offset": 1400.0}))
    assert found.told == ("trajectory.wall_offset = 1400 mm", f"plant.wall_offset = {1000 * WALL:g} mm")
    assert different_walls(system.set(found.agreed)) == []


def test_components_without_a_connection_may_have_walls_of_their_own() -> None:
    fig2 = scenario("fig2").set({"plant.wall_offset": 1.4})
    alone = System.of({"arm": fig2["plant"], "other": scenario("fig2")["plant"]})
    assert different_walls(alone) == []


def test_the_start_value_that_is_advised_does() -> None:
    system = scenario("fig2").set({"plant.wall_offset": 1.4, "plant.wall_normal": [0.0, -1.0]})
    for found in different_walls(system):
        system = system.set(found.agreed)
    assert different_walls(system) == []
    assert np.array_equal(system["trajectory"]["wall_normal"], [0.0, -1.0])


def test_the_doctor_tells_it_with_a_command() -> None:
    moved = scenario("fig2").set({"plant.wall_offset": 1.4})
    (finding,) = (f for f in diagnose(moved, stop_time=0.01).findings if f.id == "different-walls")
    assert (finding.severity.value, finding.subject) == ("warning", "trajectory.wall_offset")
    assert finding.figures == {"trajectory": [WALL], "plant": [1.4]}
    assert "{'trajectory.wall_offset': 1.4}" in finding.command


def warned(study: Study) -> list[str]:
    """What a study says about walls."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", DifferentWallsWarning)
        study.run()
    return [str(w.message) for w in caught]


def test_a_study_that_moves_one_wall_says_it_once() -> None:
    study = Study(scenario("fig2"), measure="max(abs(controller.e[1]))", stop_time=0.01)
    said = warned(study.grid({"plant.wall_offset": [WALL, 1.42, 1.41]}))
    assert len(said) == 1
    assert "plant.wall_offset = 1.42 m" in said[0]


def test_a_study_that_moves_both_walls_says_nothing() -> None:
    """The start values of the system differ, but those of no run do."""
    both = Factor("wall_offset", ["plant.wall_offset", "trajectory.wall_offset"], [1.45, 1.44])  # m
    study = Study(scenario("fig2").set({"plant.wall_offset": 1.4}), measure="max_e", stop_time=0.01)
    assert warned(study.grid(both)) == []
