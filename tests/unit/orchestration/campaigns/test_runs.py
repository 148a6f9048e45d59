"""The making of runs: chunks, threads, interrupts, and what a store keeps of them."""

import os
import signal
import threading
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from orchestration import Result, Study, StudyError, StudyInterrupted, System
from orchestration.campaigns import running
from orchestration.campaigns.engines.engine import Outcomes, Points
from orchestration.campaigns.engines.task import Task
from orchestration.campaigns.execution import local
from orchestration.campaigns.execution.campaign import Rows, make_runs
from orchestration.campaigns.execution.chunks import GROWTH, Chunks
from orchestration.campaigns.execution.local import LocalExecutor
from orchestration.campaigns.store.store import Store
from orchestration.errors import StoreError
from tests.unit.orchestration.campaigns.plain import PlainEngine

MEASURE = "top = max(plant.x)"


@pytest.fixture
def study(loop: System) -> Study:
    """Twelve runs of the loop."""
    return Study(loop, MEASURE).grid({"x_start": "1:3:4", "offset": [0.0, 0.5, 1.0]})


@pytest.fixture
def many(study: Study) -> Study:
    """Sixty runs: after the first chunk of one run, the next two have 4 and 16 at most."""
    return study.grid({"relay.n": range(5)})


class Counting(PlainEngine):
    """An engine that remembers which runs it made."""

    made: list[int]

    def make(self, points: Points) -> Outcomes:
        """Make runs, and remember their numbers."""
        self.made.extend(points.numbers.tolist())
        return super().make(points)


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Numbers of the runs that were made."""
    engine = type("Engine", (Counting,), {"made": []})
    monkeypatch.setattr(running, "engine_for", engine)
    return engine.made


class Interrupting:
    """Progress that is interrupted after a number of chunks."""

    def __init__(self, after: int) -> None:
        self.left = after
        self.ended = False

    def begin(self, total: int, names: Sequence[str], place: object) -> None:
        """Take note of nothing."""

    def add(self, outcomes: Outcomes, kept: bool) -> None:
        """Count a chunk, and interrupt after the last one."""
        self.left -= 1 if len(outcomes) and not kept else 0
        if self.left == 0:
            raise KeyboardInterrupt

    def end(self) -> None:
        """Take note of the end."""
        self.ended = True


def points(numbers: np.ndarray) -> Points:
    """Points that are their numbers."""
    return Points(numbers, numbers[:, None].astype(float), np.ones(len(numbers)))


class Squares:
    """An engine whose runs are squares, and that may fail."""

    name = "squares"
    closed = False

    def __init__(self, fails_at: int = -1) -> None:
        self.fails_at = fails_at

    def make(self, points: Points) -> Outcomes:
        """Square the numbers."""
        if self.fails_at in points.numbers:
            msg = "a fault of the engine"
            raise RuntimeError(msg)
        return Outcomes(points.numbers, points.values**2, ("",) * len(points))

    def close(self) -> None:
        """Remember it."""
        self.closed = True


@pytest.mark.parametrize("runs", [0, 1, 2, 1000])
@pytest.mark.parametrize("workers", [1, 2, 5])
def test_each_run_is_in_one_chunk(runs: int, workers: int) -> None:
    chunks = list(Chunks(np.arange(runs), points, lambda: workers))
    assert [n for chunk in chunks for n in chunk.numbers] == list(range(runs))
    sizes = [len(chunk) for chunk in chunks]
    assert all(after <= GROWTH * before for before, after in pairwise(sizes))


@pytest.mark.parametrize("time", [0.2, 0.5])
def test_chunks_take_the_time_that_is_asked_for(time: float, monkeypatch: pytest.MonkeyPatch) -> None:
    clock, sizes = [0.0], []
    monkeypatch.setattr("orchestration.campaigns.execution.chunks.perf_counter", lambda: clock[0])
    for chunk in Chunks(np.arange(10_000), points, lambda: 1, time):
        sizes.append(len(chunk))
        clock[0] += 1e-3 * len(chunk)  # a run takes 1 ms
    assert {max(sizes), sizes[len(sizes) // 2]} <= {round(time / 1e-3), round(time / 1e-3) - 1}  # rounded down


def test_a_stopped_iterator_gives_nothing_more() -> None:
    chunks = Chunks(np.arange(10), points, lambda: 1)
    next(chunks)
    chunks.stop()
    assert list(chunks) == []


@pytest.mark.parametrize("workers", [1, 3])
def test_threads_make_each_chunk_once(workers: int) -> None:
    engine = Squares()
    executor = LocalExecutor(engine, workers)
    outcomes = list(executor.map(Chunks(np.arange(500), points, lambda: workers)))
    executor.close()
    numbers = np.concatenate([found.numbers for found in outcomes])
    assert sorted(numbers.tolist()) == list(range(500))
    assert all((found.measured[:, 0] == found.numbers**2.0).all() for found in outcomes)
    assert engine.closed


def test_a_fault_of_an_engine_is_raised_and_ends_the_threads() -> None:
    executor = LocalExecutor(Squares(fails_at=20), 2)
    with pytest.raises(RuntimeError, match="a fault of the engine"):
        list(executor.map(Chunks(np.arange(10**6), points, lambda: 2)))
    executor.close()
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("campaign")]


def test_threads_rest_while_nobody_takes_what_they_made() -> None:
    numbers = np.arange(400)
    given: list[int] = []

    def recorded(number: int) -> Points:
        given.append(number)
        return points(np.array([number]))

    class OneByOne(Squares):
        def make(self, points: Points) -> Outcomes:
            if len(given) > local.AHEAD:
                too_many.set()
            return super().make(points)

    too_many = threading.Event()
    executor = LocalExecutor(OneByOne(), 1)
    made = executor.map(map(recorded, numbers.tolist()))
    assert not too_many.wait(0.5)
    assert sum(len(outcomes.numbers) for outcomes in made) == len(numbers)
    assert given == numbers.tolist()
    executor.close()


def test_threads_that_rest_end_when_the_executor_is_closed() -> None:
    executor = LocalExecutor(Squares(), 2)
    made = executor.map(Chunks(np.arange(10**6), points, lambda: 2))
    next(made)
    executor.wait()
    executor.close()
    assert not [thread for thread in threading.enumerate() if thread.name.startswith("campaign")]


def test_an_engine_is_left_alone_when_its_run_does_not_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(local, "LONGEST_END", 0.01)
    begun, free = threading.Event(), threading.Event()

    class Endless(Squares):
        def make(self, points: Points) -> Outcomes:
            begun.set()
            free.wait()
            return super().make(points)

    engine = Endless()
    executor = LocalExecutor(engine, 1)
    made = executor.map(Chunks(np.arange(3), points, lambda: 1))
    begun.wait()
    executor.close()
    assert engine.closed
    free.set()
    assert [outcomes.numbers.tolist() for outcomes in made] == [[0]]


def test_the_store_is_read_once_for_many_runs(study: Study) -> None:
    class Finder:
        def __init__(self) -> None:
            self.looks: list[Task] = []

        def found(self, task: Task, points: Points) -> Outcomes:
            self.looks.append(task)
            return Outcomes(points.numbers, np.zeros((len(points), 1)), ("",) * len(points))

        def keep(self, task: Task, points: Points, outcomes: Outcomes) -> None:
            pytest.fail(f"{task}: {len(outcomes.numbers)} of {len(points)} runs were made, though all were found")

    many, finder = study.grid({"relay.n": range(10_000)}), Finder()
    (system,) = many.systems
    job, rows = many._setting.job(system, many._design), Rows.empty(len(many), 1)
    make_runs([job], rows, lambda _: pytest.fail("no run is left"), lambda *_: None, finder)
    assert rows.made.all()
    assert len(many) > 100_000
    assert finder.looks == [job.task]


def test_rows_are_the_same_for_any_number_of_workers(study: Study, made: list[int]) -> None:
    tables = [study.run(workers=workers) for workers in (1, 2, 4)]
    assert tables[0].identical(tables[1])
    assert tables[0].identical(tables[2])
    assert sorted(made) == sorted([*range(12)] * 3)


def test_an_interrupt_keeps_what_is_made(many: Study, made: list[int]) -> None:
    progress = Interrupting(1)
    with pytest.raises(StudyInterrupted, match=r"was interrupted after \d+ of 60 runs; its table has") as stop:
        many.run(workers=1, progress=progress)
    table = stop.value.table
    assert progress.ended
    assert 0 < (table["status"] == "complete").sum() == len(made) < 60
    assert np.isnan(table["top"].where(table["status"] == "missing", drop=True)).all()


def test_ctrl_c_interrupts(many: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    class Pressing(PlainEngine):
        pressed = False

        def make(self, points: Points) -> Outcomes:
            if not self.pressed:
                self.pressed = True
                os.kill(os.getpid(), signal.SIGINT)
            return super().make(points)

    monkeypatch.setattr(running, "engine_for", Pressing)
    with pytest.raises(StudyInterrupted) as stop:
        many.run(workers=1)
    assert (stop.value.table["status"] == "missing").any()


def test_a_store_gives_back_what_it_has(study: Study, made: list[int], tmp_path: Path) -> None:
    first = study.run(store=tmp_path / "runs")
    assert len(made) == 12
    assert study.run(store=tmp_path / "runs").identical(first)
    assert len(made) == 12


def test_runs_of_another_study_are_taken_from_the_store(loop: System, made: list[int], tmp_path: Path) -> None:
    """Runs are found by what they are made of: another study, other factors, the start value set otherwise."""
    Study(loop, MEASURE).grid({"x_start": [1, 2], "offset": [0.0, 1.0]}).run(store=tmp_path)
    other = Study(loop.set({"relay.offset": 1.0}), MEASURE).grid({"x_start": [0, 1, 2]})
    table = other.run(store=tmp_path)
    assert sorted(made) == [0, 0, 1, 2, 3]
    assert table.identical(other.run())


def test_another_measure_makes_runs_again(loop: System, made: list[int], tmp_path: Path) -> None:
    Study(loop, MEASURE).run(store=tmp_path)
    table = Study(loop, "top = min(plant.x)").run(store=tmp_path)
    assert len(made) == 2
    assert table["top"].tolist() == [1.0]


def test_failed_runs_are_made_again_if_that_is_asked_for(
    study: Study, made: list[int], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Slow(PlainEngine):
        def make(self, points: Points) -> Outcomes:
            outcomes = super().make(points)
            late = points.numbers % 3 == 1
            measured = np.where(late[:, None], np.nan, outcomes.measured)
            return Outcomes(points.numbers, measured, tuple("relay: a call took too long." * bool(k) for k in late))

    with monkeypatch.context() as patch:
        patch.setattr(running, "engine_for", Slow)
        slow = study.run(store=tmp_path)
    assert (slow["status"] == "failed").sum() == 4
    assert study.run(store=tmp_path).identical(slow)
    assert made == []
    whole = study.run(store=tmp_path, retry_failed=True)
    assert sorted(made) == [1, 4, 7, 10]
    assert whole.identical(study.run())
    assert study.run(store=tmp_path).identical(whole)
    (kept,) = Store.open(tmp_path).studies()
    assert set(Store.open(tmp_path).table(kept.identity)["message"].to_pylist()) == {""}


def test_an_interrupted_study_is_continued_from_its_store(many: Study, made: list[int], tmp_path: Path) -> None:
    with pytest.raises(StudyInterrupted, match=r"Study\.resume\(.*\)\.run\(\) or adaptimp sweep --resume"):
        many.run(workers=1, store=tmp_path, progress=Interrupting(1))
    assert 0 < len(made) < 60
    resumed = Study.resume(tmp_path)
    assert repr(resumed) == repr(many)
    table = resumed.run()
    assert sorted(made) == list(range(60))
    assert table.identical(many.run())


def test_a_study_with_everything_is_continued(loop: System, tmp_path: Path, made: list[int]) -> None:
    systems = {"a": loop, "b": loop.set({"relay.offset": 0.5})}
    study = Study(systems, ["top = max(plant.x)", "mean(plant.x)"], step=0.0625)
    study = study.samples({"x_start": "normal(1, 0.5)", "switch.flag": "true,false"}, n=4, seed=9)
    study = study.grid({"relay.n": [1, 2]})
    table = study.run(store=tmp_path)
    resumed = Study.resume(tmp_path)
    assert resumed.points.equals(study.points)
    assert resumed.run().equals(table)
    assert len(made) == 16


def last(result: Result) -> float:
    """The last x."""
    return result["plant.x"][-1]


def first(result: Result) -> float:
    """The first x."""
    return result["plant.x"][0]


def test_functions_are_given_again(loop: System, made: list[int], tmp_path: Path) -> None:
    table = Study(loop, [MEASURE, ("end", "m", last)]).grid({"x_start": [1, 2]}).run(store=tmp_path)
    again = Study.resume(tmp_path, measure=[("end", "m", last)]).run()
    assert isinstance(again, xr.Dataset)
    assert again.identical(table)
    assert len(made) == 2
    with pytest.raises(StudyError, match="The study has the function end as a measure; give it again"):
        Study.resume(tmp_path)
    with pytest.raises(StudyError, match="The code of measure end is not that of the study any more"):
        Study.resume(tmp_path, measure={"end": first})


def test_the_study_that_ran_last_is_taken_up(loop: System, made: list[int], tmp_path: Path) -> None:
    for n in (2, 3):
        Study(loop, MEASURE).grid({"x_start": list(range(n))}).run(store=tmp_path)
    assert len(Study.resume(tmp_path)) == 3
    with pytest.raises(StoreError, match="there is no study 0123"):
        Study.resume(tmp_path, study="0123")
    assert len(made) == 3


def test_a_folder_without_a_store_cannot_be_taken_up(tmp_path: Path) -> None:
    with pytest.raises(StoreError):
        Study.resume(tmp_path)


def test_a_task_tells_all_that_decides_its_runs(loop: System) -> None:
    base = Task(loop, ("plant.x_start",), (), 1.0)
    others = [
        Task(loop.set({"relay.offset": 1.0}), ("plant.x_start",), (), 1.0),
        Task(loop, (), (), 1.0),
        Task(loop, ("plant.x_start",), (), 0.5),
        Task(loop, ("plant.x_start",), (), 1.0, "jacobi"),
        Task(loop.ordered(["plant", "source", "relay", "switch"]), ("plant.x_start",), (), 1.0),
    ]
    identities = {task.identity for task in (base, *others)}
    assert len(identities) == 6
    assert Task(loop.set({"plant.x_start": 7.0}), ("plant.x_start",), (), 1.0).identity == base.identity
