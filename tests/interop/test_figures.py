"""Evidence that every figure's package, and one with a scaled connection, runs in two other engines as here.

50 steps of each of the paper's systems, with the wall moved before the arm's start; then the whole of the
adaptive ones at the earlier calibration, 100,000 steps with contact, noise and saturation.
``test_jacobi.py`` compares the whole of fig2, ``tests.interop.matrix`` that of all six. ecos sums its times
and libcosim rounds them to nanoseconds, on which no value of these FMUs depends by more than the last
bits of a trajectory; agreement is asked to 1e-9 of each signal's size, and bitwise equality is the rule.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import Result, System, simulate
from orchestration.paper.scenarios import ALL_SCENARIOS, SCENARIOS
from tests.interop.peers import run_ecospy, run_libcosim, unavailable

STEPS = 50
AGREEMENT = 1e-9

needs_ecospy = pytest.mark.skipif(bool(unavailable("ecospy")), reason=str(unavailable("ecospy")))
needs_libcosim = pytest.mark.skipif(bool(unavailable("libcosimpy")), reason=str(unavailable("libcosimpy")))
figures = pytest.mark.parametrize("figure", [name for name in SCENARIOS if name.startswith("fig")])

adaptive_figures = pytest.mark.parametrize("figure", ["fig5-first", "fig6-first", "fig7-first"])
WATCHED = [
    *(f"plant.{name}[{i}]" for name in ("q", "dq", "ddq", "F_ext") for i in (1, 2)),
    *(f"sensor.F_hat[{i}]" for i in (1, 2)),
    *(f"controller.{name}[{i}]" for name in ("tau_cmd", "x_t", "e", "p_hat") for i in (1, 2)),
    *(f"actuator.tau[{i}]" for i in (1, 2)),
]  # every state of the loop is seen in these; libcosim would be five times slower with a Boolean among them


def figure_system(fmu_folder: Path, figure: str) -> System:
    """The system of a figure, with the wall before the arm's start so that there is contact."""
    scenario = SCENARIOS[figure]
    system = scenario.system({identifier: fmu_folder / f"{identifier}.fmu" for identifier in scenario.models.values()})
    return system.set({"plant.wall_offset": -1.501, "trajectory.wall_offset": -1.501})


def ours(system: System, *, nanoseconds: bool = False) -> Result:
    """Our Jacobi run, on the engine's clock."""
    step_ns = round(system.run_step() * 1e9)
    times = np.array([(k * step_ns) / 1e9 for k in range(STEPS + 1)]) if nanoseconds else None
    return simulate(system, STEPS * system.run_step(), system.run_step(), "jacobi", times=times)


def assert_agree(values: np.ndarray, rows: np.ndarray) -> None:
    """Within `AGREEMENT` of the largest value of each column."""
    assert values.shape == rows.shape
    assert np.isfinite(values).all()
    size = np.maximum(np.abs(rows).max(axis=0), 1.0)
    assert (np.abs(values - rows) / size).max() <= AGREEMENT


@figures
@needs_ecospy
def test_ecos_agrees(fmu_folder: Path, figure: str, tmp_path: Path) -> None:
    system = figure_system(fmu_folder, figure)
    result = ours(system)
    values = run_ecospy(system.write(tmp_path / "figure.ssp"), system.run_step(), STEPS, result.names)
    assert_agree(values, result.rows)


@figures
@needs_libcosim
def test_libcosim_agrees(fmu_folder: Path, figure: str, tmp_path: Path) -> None:
    system = figure_system(fmu_folder, figure)
    result = ours(system, nanoseconds=True)
    package = system.write(tmp_path / "figure.ssp")
    values = run_libcosim(package, round(system.run_step() * 1e9), STEPS, result.names)
    assert_agree(values, result.rows[1:])


def test_there_are_six_figures_and_contact(fmu_folder: Path) -> None:
    assert [name for name in SCENARIOS if name.startswith("fig")] == [f"fig{i}" for i in range(2, 8)]
    assert np.abs(ours(figure_system(fmu_folder, "fig2"))["plant.F_ext[1]"]).max() > 1  # N


def whole(fmu_folder: Path, figure: str, tmp_path: Path) -> tuple[System, Path, int]:
    """A figure as it is, its package, and the number of its steps."""
    scenario = ALL_SCENARIOS[figure]
    system = scenario.system({identifier: fmu_folder / f"{identifier}.fmu" for identifier in scenario.models.values()})
    return system, system.write(tmp_path / "whole.ssp"), round(system.run_stop_time() / system.run_step())


@adaptive_figures
@needs_ecospy
def test_ecos_agrees_to_the_end(fmu_folder: Path, figure: str, tmp_path: Path) -> None:
    system, package, steps = whole(fmu_folder, figure, tmp_path)
    result = simulate(system, algorithm="jacobi")
    assert np.abs(result["plant.F_ext[1]"]).max() > 100  # N, in contact
    values = run_ecospy(package, system.run_step(), steps, WATCHED)
    assert_agree(values, np.column_stack([result[name] for name in WATCHED]))


@adaptive_figures
@needs_libcosim
def test_libcosim_agrees_to_the_end(fmu_folder: Path, figure: str, tmp_path: Path) -> None:
    system, package, steps = whole(fmu_folder, figure, tmp_path)
    step_ns = round(system.run_step() * 1e9)
    result = simulate(system, algorithm="jacobi", times=np.arange(steps + 1) * step_ns / 1e9)
    values = run_libcosim(package, step_ns, steps, WATCHED)
    assert_agree(values, np.column_stack([result[name] for name in WATCHED])[1:])


def scaled(fmu_folder: Path) -> System:
    """Fig. 2 with torques that arrive doubled and with 0.1 N.m added, as if the motor were miscalibrated."""
    system = figure_system(fmu_folder, "fig2")
    return replace(
        system,
        connections=tuple(
            replace(c, factor=2.0, offset=0.1) if c.input.startswith("tau") and c.target == "plant" else c
            for c in system.connections
        ),
    )


@needs_ecospy
def test_ecos_scales_as_we_do(fmu_folder: Path, tmp_path: Path) -> None:
    system = scaled(fmu_folder)
    result = ours(system)
    values = run_ecospy(system.write(tmp_path / "scaled.ssp"), system.run_step(), STEPS, result.names)
    assert_agree(values, result.rows)


@needs_libcosim
def test_libcosim_scales_as_we_do(fmu_folder: Path, tmp_path: Path) -> None:
    system = scaled(fmu_folder)
    assert sum(c.scale.factor == 2.0 for c in system.connections) == 2
    result = ours(system, nanoseconds=True)
    values = run_libcosim(system.write(tmp_path / "scaled.ssp"), round(system.run_step() * 1e9), STEPS, result.names)
    assert_agree(values, result.rows[1:])
    plain = ours(figure_system(fmu_folder, "fig2"), nanoseconds=True)
    assert np.abs(result["plant.dq[1]"] - plain["plant.dq[1]"]).max() > 1e-3  # rad/s
