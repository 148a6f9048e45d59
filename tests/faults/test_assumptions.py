"""Evidence that a scenario says what of it is assumed, and why: as a system, in its package, on the command line."""

from pathlib import Path

import pytest

from orchestration import System
from orchestration.paper.scenarios import SCENARIOS
from tests.faults.cli import Command

# What section V leaves open: the wall and its law, the depth of the segment, the start, gravity, the sampling.
OPEN = {
    *(f"{component}.{name}" for component in ("plant", "trajectory") for name in ("wall_normal[1]", "wall_normal[2]")),
    *("plant.wall_offset", "trajectory.wall_offset", "trajectory.depth"),
    *("plant.q_start[1]", "plant.q_start[2]", "plant.gravity", "controller.gravity"),
    *("plant.dq_start[1]", "plant.dq_start[2]", "plant.D_f", "plant.mu"),
    *(f"{component}.sample_time" for component in ("trajectory", "sensor", "controller", "actuator")),
}
# Adaptation, and noise: its shape, when there is any, and which.
ADAPTIVE = {"controller.Gamma[2]", *(f"controller.Psi[{i}]" for i in (1, 2))}
NOISE = {f"sensor.{name}" for name in ("noise_bound", "noise_std", "noise_period", "contact_gated", "seed")}
LIMITS = {"actuator.tau_max[1]", "actuator.tau_max[2]"}
ALGORITHM_1 = ADAPTIVE | NOISE | {"controller.gamma_margin", "controller.gamma_eps"}
FURTHER = {
    **{name: set[str]() for name in ("fig2", "fig3", "fig4")},
    "fig5": ALGORITHM_1,
    "fig6": ALGORITHM_1 | LIMITS,
    "fig7": ADAPTIVE | NOISE | LIMITS | {f"controller.K_d[{i}]" for i in (1, 2)},
}


def system(fmu_folder: Path, name: str) -> System:
    scenario = SCENARIOS[name]
    return scenario.system({component: fmu_folder / f"{component}.fmu" for component in scenario.models.values()})


@pytest.mark.parametrize("name", SCENARIOS)
def test_all_that_the_paper_leaves_open_is_annotated(fmu_folder: Path, tmp_path: Path, name: str) -> None:
    made = system(fmu_folder, name)
    assert set(made.assumptions) == OPEN | FURTHER[name]
    assert all(text.startswith("assumed: ") and len(text) > 15 for text in made.assumptions.values())
    for path in made.assumptions:
        component, variable = made.resolve(path)
        assert variable.name in component.start, "the value is in the package, not left to the FMU"
    again = System.read(System.read(made.write(tmp_path / "one.ssp")).write(tmp_path / "two.ssp"))
    assert again.assumptions == made.assumptions
    assert (tmp_path / "one.ssp").read_bytes() == (tmp_path / "two.ssp").read_bytes()


def test_export_counts_them_and_run_prints_them(adaptimp: Command, tmp_path: Path) -> None:
    exported = adaptimp("export", "fig7", "--out", "fig7.ssp")
    assert exported.out == "wrote fig7.ssp: 5 components, 22 connections, 31 assumed values with their reasons\n"
    for name in ("fig7", "fig7.ssp"):
        outcome = adaptimp("run", name, "--assumptions", "--out", "x.csv")
        assert (outcome.code, outcome.err) == (0, "")
        words = " ".join(outcome.out.replace("│", " ").split())
        for path in OPEN | FURTHER["fig7"]:
            assert f"{path} = " in words
        assert "plant.wall_offset = 1.436 m" in words
        assert "sensor.contact_gated = true" in words
        assert "plant.gravity = 0 m/s2 the plane of motion is horizontal" in words
        assert words.endswith("fig7: 31 assumed values")
    assert [file.name for file in tmp_path.iterdir()] == ["fig7.ssp"], "nothing was run"


def test_they_follow_what_is_asked_for(adaptimp: Command, fmu_folder: Path) -> None:
    conventional = ("--controller", fmu_folder / "HoganImpedance.fmu")
    outcome = adaptimp("run", "fig5", *conventional, "--set", "trajectory.depth=0.02", "--assumptions")
    assert "Psi" not in outcome.out
    assert "depth" not in outcome.out
    assert outcome.out.endswith("fig5: 23 assumed values\n")


def test_a_package_may_mark_nothing(adaptimp: Command, fmu_folder: Path, tmp_path: Path) -> None:
    System.connected_by_name("lone", {"plant": fmu_folder / "Plant.fmu"}).write(tmp_path / "lone.ssp")
    outcome = adaptimp("run", "lone.ssp", "--assumptions")
    assert (outcome.code, outcome.out) == (0, "lone: nothing is marked as assumed.\n")
