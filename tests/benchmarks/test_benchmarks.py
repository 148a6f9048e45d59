"""The benchmark runs, and compares programs that compute the same; no time is asserted."""

import json
from pathlib import Path

import numpy as np
import pytest

from tests.benchmarks import master
from tests.benchmarks.variants import Bench, BenchmarkError, bench

N_STEPS = 200


@pytest.fixture
def fig2():
    """The system of Fig. 2, ready to run `N_STEPS` steps."""
    about = master.scenario("fig2")
    with bench(about.system(master.fmus(about.units.values())), N_STEPS) as b:
        yield b


def test_every_loop_records_the_same_bits(fig2: Bench) -> None:
    ours = fig2.records(fig2.time_ours, N_STEPS)
    assert len(ours) == N_STEPS + 1
    assert ours.shape[1] == 40
    assert fig2.records(fig2.time_c, N_STEPS).tobytes() == ours.tobytes()
    assert fig2.records(fig2.time_fmpy, N_STEPS).tobytes() == ours.tobytes()
    assert fig2.check_bare(ours) == N_STEPS


def test_a_repetition_begins_where_the_first_began(fig2: Bench) -> None:
    first = fig2.records(fig2.time_c, N_STEPS)
    assert fig2.records(fig2.time_c, N_STEPS).tobytes() == first.tobytes()


def test_a_difference_is_an_error(fig2: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(b: Bench, n: int) -> np.ndarray:
        seconds = b.time_ours(n)
        b.rows[n // 2, 0] += 1e-12
        return seconds

    monkeypatch.setattr(Bench, "time_c", wrong)
    with pytest.raises(BenchmarkError, match=f"c differ from ours, first in row {N_STEPS // 2}"):
        master._check(fig2, N_STEPS)


def test_it_writes_its_numbers(tmp_path: Path) -> None:
    file = tmp_path / "speed.json"
    assert master.main(["--json", str(file), "--steps", str(N_STEPS), "--repetitions", "1"]) == 0
    result = json.loads(file.read_text(encoding="utf-8"))
    for name in (*master.FAST, *master.SLOW):
        assert "unavailable" in result[name] or result[name]["minimum_ns"] > 0
    assert result["checks"]["c_equals_ours_bitwise"]
    assert set(result["per_fmu"]) == {"trajectory", "sensor", "controller", "actuator", "plant"}
    assert result["per_fmu"]["plant"].keys() == {"bare", "set", "do_step", "get"}
    assert {"ratios", "machine", "versions"} <= result.keys()
