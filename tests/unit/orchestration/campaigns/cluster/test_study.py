"""A study has the same bits on a cluster, in threads and run by run, whatever is killed meanwhile."""

import os
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import dask.config
import pandas as pd
import pytest
from distributed import LocalCluster

from orchestration import Result, Study, scenario
from orchestration.campaigns.engines.engine import Outcomes
from tests.unit.orchestration.campaigns.cluster.machines import Machines, machines

ROWS = 200
RANGES = {"plant.K_f": "1e4:1e6 log", "plant.mu": "0:0.3", "controller.K_d": "50:400"}
MEASURES = ("max(abs(controller.e[1]))", "rms(norm(controller.e), where=norm(plant.F_ext) > 0)")
SHORT = 0.02  # s, 200 steps
# m, half a millimetre beside the tip, which is in contact from 8 ms on
NEAR = {"plant.wall_offset": -1.4995, "trajectory.wall_offset": -1.4995}


def a_study(*measures: Any) -> Study:
    """Runs of Fig. 7's loop that differ in three values."""
    system = scenario("fig7").set(NEAR).with_sample_time(1e-4)
    study = Study(system, measure=[*MEASURES, *measures], stop_time=SHORT)
    return study.samples(RANGES, n=ROWS, method="random", seed=7)


@pytest.fixture(scope="module")
def processes() -> Iterator[Any]:
    """Two workers in processes of their own, which are started again when they die."""
    with (
        dask.config.set({"distributed.deploy.lost-worker-timeout": 600}),
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster,
    ):
        yield cluster


@pytest.fixture(scope="module")
def undisturbed() -> pd.DataFrame:
    """The table of the study from threads of this process."""
    return table(a_study().run(workers=2))


def table(made: Any) -> pd.DataFrame:
    """A table that is complete."""
    assert isinstance(made, pd.DataFrame)
    assert made["status"].tolist() == ["complete"] * ROWS
    assert made[list(MEASURES)].notna().to_numpy().all()
    return made


def test_threads_workers_and_single_runs_give_the_same_bits(processes: LocalCluster, undisturbed: pd.DataFrame) -> None:
    study = a_study()
    pd.testing.assert_frame_equal(table(study.run(cluster=processes)), undisturbed, check_exact=True)
    assert all(undisturbed[measure].nunique() == ROWS for measure in MEASURES)
    for _, row in undisturbed.iterrows():
        result = study.result(row)
        assert [result.measure(measure) for measure in MEASURES] == [row[measure] for measure in MEASURES]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL")
def test_a_killed_worker_changes_nothing(processes: LocalCluster, undisturbed: pd.DataFrame, tmp_path: Path) -> None:
    killed, kill = tmp_path / "killed", signal.SIGKILL

    def once(result: Result) -> float:
        """Kill the process that evaluates the first measure."""
        if not killed.exists():
            killed.touch()
            os.kill(os.getpid(), kill)
        return float(len(result.time))

    made = table(a_study(once).run(cluster=processes))
    assert killed.exists()
    pd.testing.assert_frame_equal(made.drop(columns="once"), undisturbed, check_exact=True)


class Restart:
    """Progress that restarts the scheduler of a cluster after some chunks."""

    def __init__(self, cluster: Machines, after: int) -> None:
        self.cluster, self.left = cluster, after

    def begin(self, total: int, names: Sequence[str], place: Callable[[int], str]) -> None:
        """Note nothing."""

    def add(self, outcomes: Outcomes, kept: bool) -> None:  # noqa: ARG002
        """Count a chunk."""
        self.left -= 1
        if self.left == 0:
            self.cluster.kill_scheduler()
            self.cluster.start()

    def end(self) -> None:
        """Note nothing."""


def test_a_restarted_scheduler_changes_nothing_in_the_store(undisturbed: pd.DataFrame, tmp_path: Path) -> None:
    study, store = a_study(), tmp_path / "store"
    with machines(tmp_path) as cluster:
        restart = Restart(cluster, after=3)
        made = table(study.run(cluster=cluster.address, store=store, progress=restart))
    assert restart.left < 0
    pd.testing.assert_frame_equal(made, undisturbed, check_exact=True)
    pd.testing.assert_frame_equal(table(Study.resume(store).run()), undisturbed, check_exact=True)
