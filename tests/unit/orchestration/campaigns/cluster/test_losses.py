"""A run that kills workers costs its row, and a scheduler that stays away ends a campaign with a sentence."""

import math
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import dask.config
import pytest
from distributed import LocalCluster

from orchestration.campaigns.cluster.executor import ClusterExecutor
from orchestration.errors import ClusterError
from tests.unit.orchestration.campaigns.cluster.engines import (
    Arithmetic,
    Deadly,
    a_task,
    in_chunks,
    some_points,
)
from tests.unit.orchestration.campaigns.cluster.machines import machines
from tests.unit.orchestration.campaigns.cluster.test_executor import joined

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
ROWS = 60
ENDS = 2  # workers that a chunk may end before Dask gives the chunk up
SETTINGS = {
    "distributed.scheduler.allowed-failures": ENDS - 1,
    # A local cluster gives up a worker that it does not see for some time, s, as on a machine that is busy.
    "distributed.deploy.lost-worker-timeout": 600,
}


@pytest.fixture
def processes() -> Iterator[Any]:
    """Two workers in processes of their own, which are started again when they die."""
    with (
        dask.config.set(SETTINGS),
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster,
    ):
        yield cluster


def test_a_run_that_kills_every_worker_costs_its_row_only(processes: LocalCluster) -> None:
    task, points = a_task(), some_points(ROWS)
    executor = ClusterExecutor(task, processes, partial(Deadly, number=17))
    try:
        numbers, measured, messages = joined(list(executor.map(iter(in_chunks(points, 4)))))
    finally:
        executor.close()
    here = Arithmetic(task).make(points).measured[:, 0]
    assert numbers == list(range(ROWS))
    assert [k for k in range(ROWS) if measured[k, 0] != here[k]] == [17]
    assert math.isnan(measured[17, 0])
    assert messages[17].startswith(f"The run ended the process of its worker, {ENDS} times, at last that of tcp://")
    assert not any(message for k, message in enumerate(messages) if k != 17)


def test_a_scheduler_that_stays_away_is_an_error(tmp_path: Path) -> None:
    with machines(tmp_path) as cluster:
        executor = ClusterExecutor(a_task(), cluster.address, Arithmetic, patience=1.0)
        running = executor.map(iter(in_chunks(some_points(ROWS), 1)))
        next(running)
        cluster.kill_scheduler()
        with pytest.raises(ClusterError, match=r"was lost, and was out of reach for 1 s.* resume the study from its"):
            list(running)
        executor.close()
