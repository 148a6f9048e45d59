"""The program of each figure shows, in every row and column, the bits of the master's run.

Row 0 and the noise are part of it. The program makes 1, 7 or 1000 inner steps at a time.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from orchestration import Result, System, simulate
from orchestration.paper.built_fmus import fmus
from orchestration.paper.scenarios import SCENARIOS
from tests.reference.containers.program import Program

ORDERS = ("gauss-seidel", "jacobi")
CHUNKS = (1, 7, 1000)
CHANGE = {"controller.K[1]": 3000.0, "controller.K[2]": 4500.0}  # N/m, tunable


@cache
def figure(name: str) -> System:
    scenario = SCENARIOS[name]
    return scenario.system(fmus(scenario.models.values()))


@cache
def master(name: str, order: str) -> Result:
    return simulate(figure(name), algorithm=order)


@pytest.mark.parametrize("chunk", CHUNKS)
@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("name", SCENARIOS)
def test_every_row_has_the_bits_of_the_master(name: str, order: str, chunk: int, tmp_path: Path) -> None:
    expected = master(name, order)
    program = Program.of(figure(name), tmp_path, order)
    assert program.names == expected.names
    program.initialize()
    n = (len(expected.time) - 1) // chunk
    rows = program.rows([chunk] * n)
    assert rows.tobytes() == np.ascontiguousarray(expected.rows[: n * chunk + 1 : chunk]).tobytes()
    assert program.time == expected.time[n * chunk]
    assert program.shown().tobytes() == rows[-1].tobytes()


@pytest.mark.parametrize("order", ORDERS)
def test_tunables_changed_in_the_middle_act_as_in_the_master(order: str, tmp_path: Path) -> None:
    system = figure("fig5")
    expected = simulate(system, stop_time=0.2, algorithm=order, changes={0.1: CHANGE})
    program = Program.of(system, tmp_path, order)
    program.initialize()
    half = round(0.1 / system.run_step())
    first = program.rows([1] * half)
    program.set(CHANGE)
    second = program.rows([1] * half)
    assert np.concatenate([first, second[1:]]).tobytes() == expected.rows.tobytes()
    assert expected.rows.tobytes() != simulate(system, stop_time=0.2, algorithm=order).rows.tobytes()


def test_noise_that_is_held_for_several_ticks_is_that_of_the_master(tmp_path: Path) -> None:
    system = figure("fig5")
    system = system.set({"sensor.noise_period": 3 * system.run_step(), "sensor.contact_gated": False})
    expected = simulate(system, stop_time=0.02)
    program = Program.of(system, tmp_path)
    program.initialize()
    rows = program.rows([1] * (len(expected.time) - 1))
    assert rows.tobytes() == expected.rows.tobytes()
    assert len(np.unique(expected["sensor.F_hat"], axis=0)) == np.ceil((len(expected.time) - 1) / 3)


def test_a_copy_of_the_memory_is_a_snapshot(tmp_path: Path) -> None:
    program = Program.of(figure("fig7"), tmp_path)
    program.initialize()
    program.step(5000)
    kept = program.snapshot()
    once = program.rows([1] * 2000)
    program.restore(kept)
    assert program.rows([1] * 2000).tobytes() == once.tobytes()


def test_a_reset_program_runs_as_a_new_one(tmp_path: Path) -> None:
    program = Program.of(figure("fig5"), tmp_path)
    program.initialize()
    once = program.rows([100] * 20)
    program.set(CHANGE)
    program.step(10)
    program.reset()
    program.initialize()
    assert program.rows([100] * 20).tobytes() == once.tobytes()


def test_a_run_may_begin_at_another_time(tmp_path: Path) -> None:
    system = figure("fig2")
    from orchestration import Options

    expected = simulate(system, stop_time=0.8, options=Options(start_time=0.3))
    program = Program.of(system, tmp_path)
    program.initialize(0.3)
    assert program.rows([1] * (len(expected.time) - 1)).tobytes() == expected.rows.tobytes()
    assert program.time == expected.time[-1]
