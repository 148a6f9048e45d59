"""A paced run beside a clock that the test moves: when it waits, and how late its rows are."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from orchestration import Algorithm, Options, Pace, Result, System, SystemDescriptionError, prepare, simulate, stream
from orchestration.master import simulation as module
from tests.unit.orchestration.runs import ADAPTIVE, ALGORITHMS
from tests.unit.orchestration.small_models import H, system

STEPS = 8
every_algorithm = pytest.mark.parametrize("algorithm", ALGORITHMS.values(), ids=ALGORITHMS.keys())


@dataclass
class Clock:
    """A clock that moves when somebody waits, and by `cost` s whenever it is read."""

    cost: float = 0.0
    now: float = 1000.0
    waits: list[float] = field(default_factory=list)

    def read(self) -> float:
        """Return the time, s."""
        self.now += self.cost
        return self.now

    def sleep(self, seconds: float) -> None:
        """Move the clock, s."""
        self.waits.append(seconds)
        self.now += seconds

    def pace(self, rate: float = 1.0) -> Pace:
        """Return the pace by this clock."""
        return Pace(rate, self.read, self.sleep)


@pytest.fixture
def plant(small: dict[str, Path]) -> System:
    """Return x' = 1."""
    return system(small, {"plant": "Integrator"}, steps=STEPS)


RISING = {0.0: {"plant.u": 1.0}}


@every_algorithm
@pytest.mark.parametrize("rate", [1.0, 2.0, 0.5])
def test_a_run_that_costs_nothing_waits_for_every_row(plant: System, algorithm: Algorithm, rate: float) -> None:
    clock = Clock()
    result = simulate(plant, algorithm=algorithm, pace=clock.pace(rate), changes=RISING)
    steps = np.diff(result.time)
    np.testing.assert_allclose(clock.waits, steps / rate, rtol=1e-12)
    assert clock.now == pytest.approx(1000.0 + STEPS * H / rate)
    np.testing.assert_array_equal(result["lateness"], 0.0)
    assert result.unit("lateness") == "s"
    assert result.lateness is not None
    assert result.lateness.tobytes() == result["lateness"].tobytes()
    assert (result.metadata["pace"], result.metadata["late_rows"]) == (repr(rate), "0")


@every_algorithm
def test_the_clock_changes_no_number(plant: System, algorithm: Algorithm) -> None:
    free = simulate(plant, algorithm=algorithm, changes=RISING)
    paced = simulate(plant, algorithm=algorithm, changes=RISING, pace=Clock().pace())
    assert free.lateness is None
    assert paced.names == (*free.names, "lateness")
    assert paced.time.tobytes() == free.time.tobytes()
    assert all(paced[name].tobytes() == free[name].tobytes() for name in free)


def test_steps_that_cost_more_than_they_last_are_late_and_all_made(plant: System, monkeypatch) -> None:
    """A step of 0.125 s costs 0.2 s here: the first row is 0.075 s late, and the rest are made without waiting."""
    clock = Clock()
    step = module.fixed_step.run

    def slow(operations, plan, grid, span, rows, every):
        clock.now += 0.2 * (span[1] - span[0])
        return step(operations, plan, grid, span, rows, every)

    monkeypatch.setattr(module.fixed_step, "run", slow)
    result = simulate(plant, pace=clock.pace(), changes=RISING)
    assert clock.waits == []
    assert len(result.time) == STEPS + 1
    late = result["lateness"]
    # Steps 1, 2 and 3 to 4 are made in one go each: after 0.2 s one more is due, after 0.4 s two, after 0.8 s three.
    made = 0.2 * np.array([0, 1, 2, 4, 4, 7, 7, 7, 8])
    np.testing.assert_allclose(late[1:], made[1:] - result.time[1:], rtol=1e-9)
    assert late[0] == 0.0
    assert float(result.metadata["lateness_max"]) == late.max()
    assert result.metadata["late_rows"] == str(STEPS)


def test_a_pause_between_two_parts_does_not_count(plant: System) -> None:
    clock = Clock()
    with prepare(plant, changes=RISING, pace=clock.pace()) as run:
        run.run(until=4 * H)
        clock.now += 100.0
        run.run()
        result = run.result()
    np.testing.assert_array_equal(result["lateness"], 0.0)
    assert sum(clock.waits) == pytest.approx(STEPS * H)


def test_compiling_does_not_count(plant: System, monkeypatch) -> None:
    """The clock starts after the loop was called once without a step."""
    clock, spans = Clock(), []
    step = module.fixed_step.run

    def compiling(operations, plan, grid, span, rows, every):
        clock.now += 0.0 if spans else 20.0
        spans.append(span)
        return step(operations, plan, grid, span, rows, every)

    monkeypatch.setattr(module.fixed_step, "run", compiling)
    result = simulate(plant, pace=clock.pace(), changes=RISING)
    assert spans[0] == (0, 0)
    np.testing.assert_array_equal(result["lateness"], 0.0)


def test_every_nth_row_has_the_lateness_of_its_own_time(plant: System) -> None:
    clock = Clock(cost=0.01)
    result = simulate(plant, options=Options(every=4, pace=clock.pace(), changes=RISING))
    np.testing.assert_array_equal(result.time, [0.0, 4 * H, 8 * H])
    np.testing.assert_array_equal(result["lateness"], 0.0)
    assert clock.now >= 1000.0 + STEPS * H


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_files_keep_the_lateness(plant: System, tmp_path: Path, suffix: str) -> None:
    result = simulate(plant, pace=Clock().pace(), changes=RISING)
    result.write(tmp_path / f"x.{suffix}")
    again = Result.read(tmp_path / f"x.{suffix}")
    assert again["lateness"].tobytes() == result["lateness"].tobytes()
    if suffix == "parquet":
        assert again.unit("lateness") == "s"
        assert again.metadata["lateness_max"] == result.metadata["lateness_max"]


def test_a_stream_is_paced_too(plant: System, tmp_path: Path) -> None:
    clock = Clock()
    assert stream(tmp_path / "x.parquet", plant, pace=clock.pace(), changes=RISING) == STEPS + 1
    assert clock.now == pytest.approx(1000.0 + STEPS * H)
    streamed = Result.read(tmp_path / "x.parquet")
    assert streamed.names[-1] == "lateness"
    assert streamed.metadata["pace"] == "1.0"


def test_going_back_restores_the_lateness(plant: System) -> None:
    with prepare(plant, changes=RISING, algorithm=ADAPTIVE, pace=Clock().pace()) as run:
        snapshot = run.save()
        run.run()
        whole = run.result().rows.copy()
        run.restore(snapshot)
        run.run()
        assert run.result().rows.tobytes() == whole.tobytes()


@pytest.mark.parametrize("rate", [0, -1.0, float("nan"), float("inf"), "fast", True])
def test_a_pace_must_be_a_positive_number(rate) -> None:
    with pytest.raises(SystemDescriptionError, match=r"pace = .*: simulated seconds per second are needed"):
        Options(pace=rate)
