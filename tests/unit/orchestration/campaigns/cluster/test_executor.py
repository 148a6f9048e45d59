"""Chunks go to the workers of a cluster, a few at a time, and come back once each, with the bits of one process."""

import os
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import cloudpickle
import numpy as np
import pytest
from distributed import Client, LocalCluster

from orchestration.campaigns.cluster.delivery import Delivery, make_runs
from orchestration.campaigns.cluster.executor import ClusterExecutor
from orchestration.campaigns.cluster.flights import PER_THREAD
from orchestration.campaigns.engines.engine import Outcomes, Points
from orchestration.errors import ClusterError
from tests.unit.orchestration.campaigns.cluster.engines import (
    Arithmetic,
    Closing,
    a_task,
    import_something,
    in_chunks,
    refuse,
    some_points,
)

ROWS = 200


@pytest.fixture(scope="module")
def processes() -> Iterator[Any]:
    """Two workers in processes of their own."""
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster:
        yield cluster


@pytest.fixture(scope="module")
def threads() -> Iterator[Any]:
    """Two workers with two threads each, in this process."""
    with LocalCluster(n_workers=2, threads_per_worker=2, processes=False, dashboard_address=":0") as cluster:
        yield cluster


@pytest.fixture
def executor(threads: LocalCluster) -> Iterator[ClusterExecutor]:
    """An executor with workers in this process."""
    made = ClusterExecutor(a_task(), threads, Arithmetic)
    yield made
    made.close()


def joined(outcomes: list[Outcomes]) -> tuple[list[int], np.ndarray, list[str]]:
    """Numbers, measures and messages of all rows, in the order of the numbers."""
    numbers = np.concatenate([one.numbers for one in outcomes])
    order = np.argsort(numbers)
    messages = [message for one in outcomes for message in one.messages]
    measured = np.concatenate([one.measured for one in outcomes])
    return numbers[order].tolist(), measured[order], [messages[k] for k in order]


def test_two_processes_give_the_bits_of_this_one(processes: LocalCluster) -> None:
    task, points = a_task(), some_points(ROWS)
    executor = ClusterExecutor(task, processes, Arithmetic)
    try:
        numbers, measured, messages = joined(list(executor.map(iter(in_chunks(points, 7)))))
    finally:
        executor.close()
    here = Arithmetic(task).make(points)
    assert numbers == list(range(ROWS))
    assert measured[:, 0].tobytes() == here.measured[:, 0].tobytes()
    assert os.getpid() not in measured[:, 1]
    assert messages == [""] * ROWS


@pytest.mark.parametrize("given", ["address", "client", "cluster"])
def test_a_cluster_is_an_address_a_client_or_a_cluster(processes: LocalCluster, given: str) -> None:
    with Client(processes, set_as_default=False) as client:
        cluster: Any = {"address": processes.scheduler_address, "client": client, "cluster": processes}[given]
        executor = ClusterExecutor(a_task(), cluster, Arithmetic)
        assert len(list(executor.map(iter(in_chunks(some_points(3), 1))))) == 3
        executor.close()
        assert client.status == "running"  # what was given stays as it was


def test_few_chunks_are_in_flight(executor: ClusterExecutor) -> None:
    taken, answered, ahead = [0], 0, []

    def chunks() -> Iterator[Points]:
        for chunk in in_chunks(some_points(100), 1):
            taken[0] += 1
            yield chunk

    for _ in executor.map(chunks()):
        answered += 1
        ahead.append(taken[0] - answered)
    assert executor.workers == 4
    assert ahead[0] == 4 - 1  # the first chunks tell how long chunks take
    assert max(ahead) == PER_THREAD * 4 - 1


def test_an_interrupt_leaves_what_is_in_flight(executor: ClusterExecutor) -> None:
    class Interrupted(Iterator[Points]):
        """Chunks that interrupt once, as Ctrl-C does."""

        def __init__(self) -> None:
            self.left = in_chunks(some_points(20), 1)

        def __next__(self) -> Points:
            if len(self.left) == 7:
                self.left.clear()
                raise KeyboardInterrupt
            if not self.left:
                raise StopIteration
            return self.left.pop(0)

    running, outcomes = executor.map(Interrupted()), []
    with pytest.raises(KeyboardInterrupt):
        outcomes.extend(running)  # keeps what came before
    outcomes += running
    assert joined(outcomes)[0] == list(range(13))


def test_a_task_travels_once_to_each_worker_and_is_closed_there(
    threads: LocalCluster, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    arrivals: list[str] = []
    setup = Delivery.setup
    monkeypatch.setattr(
        Delivery, "setup", lambda delivery, worker: (arrivals.append(worker.address), setup(delivery, worker))[1]
    )
    executor = ClusterExecutor(a_task(), threads, partial(Closing, folder=tmp_path))
    outcomes = list(executor.map(iter(in_chunks(some_points(40), 1))))
    assert len(outcomes) == 40
    assert sorted(arrivals) == sorted(worker.address for worker in threads.workers.values())
    assert list(tmp_path.iterdir()) == []
    executor.close()
    assert len(list(tmp_path.iterdir())) == 2  # one engine for each worker, though both have two threads


def test_a_chunk_is_small(executor: ClusterExecutor) -> None:
    one = cloudpickle.dumps((make_runs, executor._payload.name, some_points(1)))
    many = cloudpickle.dumps((make_runs, executor._payload.name, some_points(101)))
    assert len(executor._payload.package) > 100_000  # bytes, five FMUs
    assert len(one) < 2000
    assert len(many) - len(one) == 100 * 8 * 4  # a number, two values and a step for each run


def test_campaigns_with_one_task_do_not_take_it_from_each_other(
    executor: ClusterExecutor, threads: LocalCluster
) -> None:
    other = ClusterExecutor(a_task(), threads, Arithmetic)
    running = executor.map(iter(in_chunks(some_points(60), 1)))
    first = next(running)
    other.close()
    assert joined([first, *running])[0] == list(range(60))


def test_an_engine_that_cannot_be_made_is_an_error_with_the_worker(threads: LocalCluster) -> None:
    with pytest.raises(ClusterError, match=r"Worker inproc://.* cannot make the runs: StudyError: System fig7 has no"):
        ClusterExecutor(a_task(), threads, refuse)
    assert not any("adaptimp" in name for worker in threads.workers.values() for name in worker.plugins)


def test_a_module_that_a_worker_lacks_is_told(threads: LocalCluster) -> None:
    with pytest.raises(ClusterError, match=r"ModuleNotFoundError: .*no_such_module.*; install it there"):
        ClusterExecutor(a_task(), threads, import_something)


def test_chunks_are_called_back_when_nobody_wants_them(executor: ClusterExecutor) -> None:
    next(executor.map(iter(in_chunks(some_points(100), 1))))
    assert executor._at_work[0]._chunks
    executor.close()
    assert not executor._at_work[0]._chunks


def test_other_versions_are_refused_before_the_first_run(
    threads: LocalCluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    versions = Client.get_versions

    def with_another_worker(client: Client, **options: Any) -> Any:
        found: Any = versions(client, **options)
        found["workers"]["tcp://old:1"] = {"packages": {**found["client"]["packages"], "adaptimp": "0.0.1"}}
        return found

    monkeypatch.setattr(Client, "get_versions", with_another_worker)
    with pytest.raises(ClusterError, match=r"Worker tcp://old:1 has adaptimp 0\.0\.1, but this program adaptimp"):
        ClusterExecutor(a_task(), threads, Arithmetic)


@pytest.mark.parametrize(
    ("cluster", "message"),
    [
        ("nowhere", r"cluster is 'nowhere': missing port number .*; give an address such as tcp://10\.0\.0\.5:8786\."),
        ("http://here:80", r"cluster is 'http://here:80': unknown address scheme"),
        (8786, r"cluster is 8786; give an address such as .* or a LocalCluster\."),
    ],
)
def test_what_is_no_cluster_is_told(cluster: Any, message: str) -> None:
    with pytest.raises(ClusterError, match=message):
        ClusterExecutor(a_task(), cluster, Arithmetic)


def test_a_scheduler_that_is_not_there_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("orchestration.campaigns.cluster.connection.FIRST", 0.5)
    with pytest.raises(ClusterError, match=r"No scheduler of Dask was reached at tcp://127\.0\.0\.1:1 within 0\.5 s"):
        ClusterExecutor(a_task(), "tcp://127.0.0.1:1", Arithmetic)  # nobody listens at port 1


def test_a_cluster_without_workers_is_told() -> None:
    with (
        LocalCluster(n_workers=0, processes=False, dashboard_address=":0") as cluster,
        pytest.raises(ClusterError, match=r"has had no worker for 0\.5 s; start one with dask worker inproc://"),
    ):
        ClusterExecutor(a_task(), cluster, Arithmetic, patience=0.5)


def test_dask_is_asked_for_where_it_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("orchestration.campaigns.cluster.executor.find_spec", lambda _: None)
    with pytest.raises(ClusterError, match=r"needs Dask; install it with pip install 'adaptimp\[cluster\]'\."):
        ClusterExecutor(a_task(), "tcp://10.0.0.5:8786", Arithmetic)
