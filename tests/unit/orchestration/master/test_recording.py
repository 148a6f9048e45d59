"""Which rows a run keeps, and which rows remain after an interrupt or a failure, for every algorithm."""

import json
import signal
from pathlib import Path

import numpy as np
import pytest

from orchestration import Options, OrchestrationError, Result, SimulationError, simulate
from orchestration.errors import RunInterrupted
from orchestration.master.simulate import prepare, stream
from tests.unit.orchestration.runs import ADAPTIVE, ALGORITHMS, SAMPLE_TIME, at_zero, crossing, falling, paper
from tests.unit.orchestration.small_models import FIRST, LAST_TICK, H, mixed, system

STEPS = 3000  # several chunks of the compiled loop
FIXED = {name: algorithm for name, algorithm in ALGORITHMS.items() if algorithm.control is None}
every_algorithm = pytest.mark.parametrize("algorithm", ALGORITHMS.values(), ids=ALGORITHMS.keys())
every_fixed = pytest.mark.parametrize("algorithm", FIXED.values(), ids=FIXED.keys())


def decaying(small: dict[str, Path], steps: int):
    """Return `mixed` with x' = 2 x - 4 and x(0) = 2, where x stays, so that a run of any length is finite."""
    return mixed(small, steps=steps).set({"relay.offset": -4.0, "plant.x_start": 2.0})


@every_fixed
@pytest.mark.parametrize("every", [2, 7, 300, STEPS, 2 * STEPS])
def test_every_nth_row_is_kept(small: dict[str, Path], algorithm, every: int) -> None:
    system = decaying(small, STEPS)
    full = simulate(system, algorithm=algorithm)
    thin = simulate(system, algorithm=algorithm, options=Options(every=every))
    assert thin.time.tobytes() == full.time[::every].tobytes()
    assert thin.rows.tobytes() == full.rows[::every].tobytes()


def test_every_nth_controlled_step_is_kept(small: dict[str, Path]) -> None:
    system = mixed(small)
    full = simulate(system, algorithm=ADAPTIVE)
    thin = simulate(system, algorithm=ADAPTIVE, options=Options(every=3))
    assert thin.time.tobytes() == full.time[::3].tobytes()
    assert thin.rows.tobytes() == full.rows[::3].tobytes()


@every_fixed
def test_ticks_that_were_recorded_are_found(small: dict[str, Path], algorithm) -> None:
    """Row k + 1 of a sampled component shows tick k, also if only every third row is kept."""
    system = mixed(small).set({"source.sample_time": 6 * H})
    thin = simulate(system, 24 * H, H, algorithm, options=Options(every=3))
    assert thin.steps_per_tick == {"source": 2}
    np.testing.assert_array_equal(thin.at_ticks("source.u"), FIRST + np.arange(4))
    np.testing.assert_array_equal(thin.tick_times("source.u"), 6 * H * np.arange(4))
    with pytest.raises(
        OrchestrationError, match=r"relay\.y: not every tick of 0\.125 s is recorded; record every step"
    ):
        thin.at_ticks("relay.y")


def test_a_located_crossing_adds_a_row(small: dict[str, Path]) -> None:
    """A crossing adds one row, and moves neither the ticks of sampled components nor the communication points."""
    result = simulate(falling(small), options=at_zero())
    plain = simulate(falling(small))
    points = np.isin(result.time, plain.time)
    np.testing.assert_array_equal(result.time[points], plain.time)
    assert (~points).sum() == 1
    assert 0 <= result.time[~points][0] - crossing() <= 1e-9
    # x passes zero at a speed of at most 4 m/s, so within 1e-9 s x falls by 4e-9 m at most.
    assert -4e-9 <= result["plant.x"][~points][0] <= 0
    for name in ("source.u", "relay.y", "switch.y"):
        np.testing.assert_array_equal(result.tick_times(name), H * np.arange(16))
    np.testing.assert_array_equal(result.at_ticks("source.u"), FIRST + np.arange(16))
    # The plant holds its input. Two shorter steps of Runge-Kutta 4 round differently from one.
    for name in ("relay.y", "plant.x"):
        np.testing.assert_allclose(result[name][points], plain[name], rtol=1e-13)


def test_a_located_crossing_is_recorded_beside_every_nth_step(small: dict[str, Path]) -> None:
    options = at_zero()
    thin = simulate(falling(small), options=Options(every=1000, crossings=options.crossings))
    assert len(thin.time) == 2
    assert thin.time[1] == pytest.approx(crossing(), abs=1e-9)


@every_algorithm
@pytest.mark.parametrize("every", [1, 4])
def test_a_stream_holds_the_rows_of_the_run(small: dict[str, Path], tmp_path: Path, algorithm, every: int) -> None:
    path, options = tmp_path / "run.parquet", Options(every=every)
    expected = simulate(mixed(small), algorithm=algorithm, options=options)
    assert stream(path, mixed(small), algorithm=algorithm, options=options) == len(expected.time)
    found = Result.read(path)
    assert found.names == expected.names
    assert found.time.tobytes() == expected.time.tobytes()
    assert found.rows.tobytes() == expected.rows.tobytes()
    assert found.steps_per_tick == expected.steps_per_tick
    assert sorted(p.name for p in tmp_path.iterdir()) == ["run.parquet"]


@every_algorithm
def test_a_failure_leaves_the_rows_before(small: dict[str, Path], tmp_path: Path, algorithm) -> None:
    broken = system(small, {"fragile": "Fragile", "plant": "Integrator"}, "fragile.k -> plant.u", steps=2 * LAST_TICK)
    with pytest.raises(SimulationError, match=r"fragile: fmi2DoStep returned fmi2Error at t = 5\.125 s") as caught:
        simulate(broken, algorithm=algorithm)
    kept = caught.value.result
    assert kept is not None
    assert kept.time[-1] == (LAST_TICK + 1) * H
    with pytest.raises(SimulationError, match="fragile: fmi2DoStep"):
        stream(tmp_path / "run.parquet", broken, algorithm=algorithm)
    assert [p.name for p in tmp_path.iterdir()] == ["run.partial.parquet"]
    partial = Result.read(tmp_path / "run.partial.parquet")
    assert partial.time.tobytes() == kept.time.tobytes()
    assert partial.rows.tobytes() == kept.rows.tobytes()


@every_algorithm
@pytest.mark.parametrize("by", ["exception", "signal"])
@pytest.mark.usefixtures("heeded")
def test_an_interrupt_leaves_the_rows_before(small: dict[str, Path], algorithm, by: str) -> None:
    whole = simulate(decaying(small, STEPS), algorithm=algorithm)
    seen = []

    def interrupt(done: int, of: int) -> None:
        seen.append((done, of))
        if by == "exception":
            raise KeyboardInterrupt
        signal.raise_signal(signal.SIGINT)

    with pytest.raises(RunInterrupted) as caught:
        simulate(decaying(small, STEPS), algorithm=algorithm, options=Options(progress=interrupt))
    assert len(seen) == 1
    kept = caught.value.result
    assert 1 < len(kept.time) < len(whole.time)
    assert kept.time.tobytes() == whole.time[: len(kept.time)].tobytes()
    assert kept.rows.tobytes() == whole.rows[: len(kept.time)].tobytes()
    assert (kept.status, kept.message) == ("interrupted", "The run was interrupted.")


def test_an_interrupted_stream_leaves_a_partial_file(small: dict[str, Path], tmp_path: Path) -> None:
    def interrupt(_done: int, _of: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(RunInterrupted):
        stream(tmp_path / "run.parquet", decaying(small, STEPS), options=Options(progress=interrupt))
    assert [p.name for p in tmp_path.iterdir()] == ["run.partial.parquet"]
    assert 1 < len(Result.read(tmp_path / "run.partial.parquet").time) < STEPS


@pytest.mark.parametrize("algorithm", [ALGORITHMS["gauss-seidel"], ADAPTIVE], ids=["fixed", "controlled"])
def test_a_file_knows_ticks_and_what_the_algorithm_needed(small: dict[str, Path], tmp_path: Path, algorithm) -> None:
    """Controlled steps do not keep pace with ticks, so a file must give the ticks by their times."""
    system = mixed(small)
    result = simulate(system, algorithm=algorithm)
    stream(tmp_path / "streamed.parquet", system, algorithm=algorithm)
    result.write(tmp_path / "whole.parquet")
    assert len(result.at_ticks("source.u")) < len(result.time)
    for name in ("streamed", "whole"):
        back = Result.read(tmp_path / f"{name}.parquet")
        np.testing.assert_array_equal(back.at_ticks("source.u"), result.at_ticks("source.u"))
        np.testing.assert_array_equal(back.tick_times("source.u"), result.tick_times("source.u"))
        assert back.metadata == result.metadata


def test_what_is_set_on_the_way_is_in_the_metadata(fmu_folder: Path) -> None:
    with prepare(paper(fmu_folder, "fig2"), 4 * SAMPLE_TIME, SAMPLE_TIME) as run:
        run.run(until=SAMPLE_TIME)
        before = run.save()
        run.set({"controller.K[1]": 2000.0})
        after = run.save()
        assert json.loads(run.result().metadata["changes"]) == [[SAMPLE_TIME, "controller.K[1]", 2000.0]]
        run.restore(before)
        assert "changes" not in run.result().metadata
        run.restore(after)
        assert "changes" in run.result().metadata


def test_a_run_is_stepped_inside_its_block_only(small: dict[str, Path]) -> None:
    simulation = prepare(mixed(small), 4 * H, H)
    looks = [lambda: simulation.time, lambda: simulation.count, lambda: simulation.steps_made, simulation.result]
    steps = [simulation.run, simulation.save, lambda: simulation.set({"relay.offset": 1.0})]
    for call in (*looks, *steps):
        with pytest.raises(OrchestrationError, match=r"^System small: the run has not begun; step it inside its block"):
            call()
    with simulation:
        simulation.run()
        snapshot = simulation.save()
    assert (simulation.count, len(simulation.result().time)) == (5, 5)
    for call in (*steps, lambda: simulation.restore(snapshot)):
        with pytest.raises(OrchestrationError, match=r"^System small: the run is over; step it inside its block"):
            call()
