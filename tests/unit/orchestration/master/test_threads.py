"""Runs in several threads at the same time do not disturb each other."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from orchestration import System, simulate
from orchestration.master.algorithm import Algorithm
from tests.reference.problems import PROBLEMS
from tests.unit.orchestration.runs import ALGORITHMS, SAMPLE_TIME, paper
from tests.unit.orchestration.small_models import mixed

THREADS, REPEATED = 2, 4


@pytest.fixture(scope="module")
def jobs(small: dict[str, Path], fmu_folder: Path) -> list[tuple[System, Algorithm]]:
    """Return small runs of several systems with every algorithm, ordered so that neighbours differ."""
    h = 2.0**-9
    systems = [
        mixed(small),
        PROBLEMS["force-displacement"].system(h, 100 * h),
        PROBLEMS["feedthrough"].system(h, 100 * h),
        paper(fmu_folder, "fig5").with_sample_time(SAMPLE_TIME),
    ]
    systems[-1] = System("fig5", systems[-1].components, systems[-1].connections, SAMPLE_TIME, 100 * SAMPLE_TIME)
    return [(system, algorithm) for algorithm in ALGORITHMS.values() for system in systems]


def rows(job: tuple[System, Algorithm]) -> tuple[bytes, bytes]:
    """Return the times and rows of a run as bytes."""
    result = simulate(job[0], algorithm=job[1])
    return result.time.tobytes(), result.rows.tobytes()


def test_threads_give_the_bits_of_one(jobs: list[tuple[System, Algorithm]]) -> None:
    alone = [rows(job) for job in jobs]
    assert len(set(alone)) > len(jobs) // 2  # different runs
    with ThreadPoolExecutor(THREADS) as pool:
        together = list(pool.map(rows, jobs * REPEATED))
    assert together == alone * REPEATED


def test_the_same_run_in_both_threads(jobs: list[tuple[System, Algorithm]]) -> None:
    for job in jobs[-4:]:
        with ThreadPoolExecutor(THREADS) as pool:
            assert len(set(pool.map(rows, [job] * 8))) == 1
