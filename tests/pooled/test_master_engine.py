"""A campaign of runs with FMUs of another tool: a crash, a hang or a divergence costs its row, and nothing else."""

import threading
import time
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from orchestration import Isolation, SimulationError, Study, simulate
from orchestration.campaigns.engines.engine import Outcomes, Points
from orchestration.campaigns.engines.isolated import isolation_of
from orchestration.campaigns.engines.master import MasterEngine
from orchestration.campaigns.engines.task import Task
from orchestration.campaigns.measuring.measure import Measure
from orchestration.errors import StudyError
from tests.pooled.conftest import Pooled
from tests.pooled.fmus import Deed

STOP, STEP = 1.0, 0.125
VARIED = ("source.p", "m.p", "m.deed")


def ends(result) -> dict[str, float]:
    return {"end": float(result["m.y"][-1]), "sum": float(np.add.accumulate(result["m.y"])[-1])}


MEASURES = (Measure.of(ends, name=["end", "sum"], columns=["m.y"]), Measure.of(lambda r: len(r.time), name="rows"))


def task_of(system, **more) -> Task:
    return Task(system, VARIED, MEASURES, STOP, **more)


def points_of(deeds: Iterable[int]) -> Points:
    """One run for each deed, each with other parameters."""
    listed = list(deeds)
    n = len(listed)
    values = np.column_stack([1.0 + np.arange(n), 10.0 - np.arange(n) / 8, listed])
    return Points(np.arange(n), values, np.full(n, STEP))


def made(engine: MasterEngine, points: Points, workers: int, size: int = 5) -> Outcomes:
    """Make all points in chunks, by so many threads."""
    chunks = iter([points[k : k + size] for k in range(0, len(points), size)])
    lock, found = threading.Lock(), []

    def work() -> None:
        while True:
            with lock:
                chunk = next(chunks, None)
            if chunk is None:
                return
            found.append(engine.make(chunk))

    threads = [threading.Thread(target=work) for _ in range(workers)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    found.sort(key=lambda outcomes: int(outcomes.numbers[0]))
    return Outcomes(
        np.concatenate([o.numbers for o in found]),
        np.concatenate([o.measured for o in found]),
        tuple(message for o in found for message in o.messages),
    )


def truth(task: Task, values: np.ndarray) -> tuple[list[float], str]:
    """Measures of a run of its own, and why it failed; FMUs that crash are isolated."""
    isolate = isolation_of(task) if values[2] != Deed.NOTHING else None
    try:
        result = simulate(task.system_of(values), task.stop_time, STEP, task.algorithm, isolate=isolate)
    except SimulationError as error:
        return [np.nan] * 3, str(error)
    return [*ends(result).values(), len(result.time)], ""


def require_truth(task: Task, points: Points, outcomes: Outcomes, rows: Iterable[int]) -> None:
    for k in rows:
        measured, message = truth(task, points.values[k])
        assert outcomes.messages[k] == message
        assert outcomes.measured[k].tobytes() == np.array(measured).tobytes()


def children() -> list[str]:
    """Processes of this one, whichever thread has started them."""
    tasks = Path("/proc/self/task").iterdir()
    return [process for task in tasks for process in (task / "children").read_text().split()]


@pytest.mark.parametrize("workers", [1, 2])
def test_a_third_of_the_runs_fails_and_the_others_have_their_bits(pooled: Pooled, workers: int) -> None:
    before = set(children())
    bad = [Deed.CRASH, Deed.DIVERGE, Deed.END, Deed.REFUSE, Deed.NOT_A_NUMBER, Deed.FATAL, Deed.CRASH, Deed.DISCARD]
    deeds = [bad[k // 3 % len(bad)] if k % 3 == 1 else Deed.NOTHING for k in range(60)]
    deeds[31] = Deed.HANG
    points, task = points_of(deeds), task_of(pooled(), isolation=Isolation(["m"], time_limit=10.0))
    engine = MasterEngine(task)
    try:
        outcomes = made(engine, points, workers)
    finally:
        engine.close()
    assert set(children()) <= before
    assert outcomes.numbers.tolist() == list(range(60))
    for k, deed in enumerate(deeds):
        assert bool(outcomes.messages[k]) == (deed != Deed.NOTHING)
        assert np.isnan(outcomes.measured[k]).all() == (deed != Deed.NOTHING)
    assert outcomes.messages[31].startswith("m: fmi2DoStep did not return within 10 s at t = 0.5 s (step 4); ")
    require_truth(task, points, outcomes, [k for k in range(60) if deeds[k] != Deed.HANG])


def test_what_ends_the_simulation_is_a_row_as_of_simulate(pooled: Pooled) -> None:
    task, points = task_of(pooled()), points_of([Deed.NOTHING, Deed.TERMINATE, Deed.NOTHING, Deed.TERMINATE])
    engine = MasterEngine(task)
    outcomes = engine.make(points)
    engine.close()
    assert outcomes.messages == ("",) * 4
    assert outcomes.measured[:, 2].tolist() == [9, 5, 9, 5]
    require_truth(task, points, outcomes, range(4))


def test_foreign_fmus_are_isolated_unless_the_task_says_otherwise(pooled: Pooled) -> None:
    task = task_of(pooled())
    isolation = isolation_of(task)
    assert isolation is not None
    assert isolation.components == ("source", "m")
    none = Isolation(())
    assert isolation_of(replace(task, isolation=none)) is none
    engine = MasterEngine(replace(task, isolation=none))
    points = points_of([Deed.NOTHING] * 4)
    before = children()
    outcomes = engine.make(points)
    assert children() == before
    engine.close()
    require_truth(task, points, outcomes, range(4))


def test_a_measure_that_fails_costs_its_row(pooled: Pooled) -> None:
    def careful(result) -> float:
        if result["m.y"][-1] < 9.95:
            msg = "too small"
            raise ValueError(msg)
        return 1.0

    task = replace(task_of(pooled(), isolation=Isolation(())), measures=(Measure.of(careful),))
    engine = MasterEngine(task)
    outcomes = engine.make(points_of([Deed.NOTHING] * 3))
    engine.close()
    failed = "Measure careful: its function failed with ValueError: too small."
    assert outcomes.messages == ("", "", failed)
    assert np.isnan(outcomes.measured[:, 0]).tolist() == [False, False, True]


def test_closing_ends_runs_that_hang(pooled: Pooled) -> None:
    before, first = set(children()), threading.Event()

    def noted(result) -> float:
        first.set()
        return float(result["m.y"][-1])

    task = replace(task_of(pooled(), isolation=Isolation(["m"], time_limit=None)), measures=(Measure.of(noted),))
    engine, failures = MasterEngine(task), list[BaseException]()

    def work() -> None:
        try:
            engine.make(points_of([Deed.NOTHING, Deed.HANG, Deed.HANG]))
        except BaseException as error:
            failures.append(error)

    thread = threading.Thread(target=work)
    thread.start()
    assert first.wait(300)
    time.sleep(0.5)  # the second run hangs by now, or will be ended before
    engine.close()
    thread.join(300)
    assert not thread.is_alive()
    assert [type(error) for error in failures] == [StudyError]
    assert set(children()) <= before
    with pytest.raises(StudyError, match="the campaign was ended"):
        engine.make(points_of([Deed.NOTHING]))


def test_a_study_isolates_fmus_of_other_tools_and_repeats_a_row(pooled: Pooled) -> None:
    study = Study(pooled(), MEASURES[0], stop_time=STOP, step=STEP).grid(
        {"m.deed": [float(Deed.NOTHING), float(Deed.CRASH)], "source.p": [1.0, 2.0, 3.0]}
    )
    table = study.run(workers=2)
    assert isinstance(table, xr.Dataset)
    assert table["status"].values.tolist() == [["complete"] * 3, ["failed"] * 3]
    for p in (1.0, 2.0, 3.0):
        row = table.sel(p=p)
        assert row["end"].values[0] == study.result(deed=0.0, p=p)["m.y"][-1]
        with pytest.raises(SimulationError) as failed:
            study.result(deed=1.0, p=p)
        assert row["message"].values[1] == str(failed.value)
