"""Tests of recorded results: every choice of columns gives the same bits, and CSV files keep all bits."""

import csv
from pathlib import Path

import numpy as np
import pytest

from orchestration import Options, OrchestrationError, Result, System, SystemDescriptionError, simulate
from tests.unit.orchestration.small_models import chain, mixed

STEPS = 300
CHOSEN = ("plant.F_ext[1]", "actuator.saturated[2]", "trajectory.x_v[1]", "plant.q[2]")  # in no order
IN_CONTACT = {"plant.wall_offset": -1.501, "trajectory.wall_offset": -1.501}  # m


@pytest.fixture(scope="module")
def awkward() -> Result:
    """Result with numbers whose decimal digits are hard to print without loss."""
    values = np.random.default_rng(2).integers(0, 2**64, 4000, dtype=np.uint64, endpoint=False)
    numbers = values.view(np.float64)
    rows = numbers[np.isfinite(numbers)][:3000].reshape(-1, 3)
    rows[0] = (-0.0, np.nextafter(0, 1), np.finfo(float).max)
    names = ("a.x[1]", 'b."odd", name', "c.y")
    return Result(np.arange(len(rows)) * 1e-4, names, rows)


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
def test_chosen_columns_equal_those_of_a_full_record_bitwise(fig2: System, algorithm: str) -> None:
    system = fig2.set(IN_CONTACT)
    stop = STEPS * system.run_step()
    full = simulate(system, stop, algorithm=algorithm)
    some = simulate(system, stop, algorithm=algorithm, options=Options(record=CHOSEN))
    assert some.names == CHOSEN
    assert np.ptp(some["plant.F_ext[1]"]) > 0
    for name in CHOSEN:
        assert some[name].tobytes() == full[name].tobytes()
        assert some.units[name] == full.units[name]


def test_a_column_asked_for_twice_appears_once(small: dict[str, Path]) -> None:
    result = simulate(mixed(small), options=Options(record=["switch.y", "source.n", "switch.y"]))
    assert result.names == ("switch.y", "source.n")
    np.testing.assert_array_equal(result["switch.y"], simulate(mixed(small))["switch.y"])


def test_recording_nothing_still_runs(small: dict[str, Path], tmp_path: Path) -> None:
    result = simulate(mixed(small), options=Options(record=()))
    assert result.rows.shape == (17, 0)
    result.write_csv(tmp_path / "times.csv")
    assert (tmp_path / "times.csv").read_text().splitlines()[:2] == ['"time"', "0"]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("relay.z", r"relay has no variable z; it has sample_time, offset, u, n, even, y, m, odd"),
        ("relais.y", r"System small has no component relais; it has source, relay, switch, plant"),
        ("relay", r"'relay' is not of the form component\.variable, such as source\."),
        ("relay.u", r"relay\.u is a Real of causality input; only outputs"),
        ("relay.offset", r"relay\.offset is a Real of causality parameter; only outputs"),
    ],
)
def test_what_cannot_be_recorded_is_refused(small: dict[str, Path], name: str, message: str) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        simulate(mixed(small), options=Options(record=[name]))


def test_unknown_column_lists_the_recorded_ones(small: dict[str, Path]) -> None:
    result = simulate(chain(small, 1), options=Options(record=["source.n", "relay1.y"]))
    for lookup in (result.__getitem__, result.at_ticks, result.vector):
        with pytest.raises(OrchestrationError, match=r"no column source\.u.*; recorded are source\.n, relay1\.y"):
            lookup("source.u")


def test_vectors_and_time_are_columns(fig2: System) -> None:
    result = simulate(fig2, 10 * fig2.run_step())
    np.testing.assert_array_equal(
        result.vector("plant.q"), np.column_stack([result["plant.q[1]"], result["plant.q[2]"]])
    )
    assert result.vector("controller.p_hat").shape == (11, 6)
    np.testing.assert_array_equal(result["time"], result.time)


def test_csv_keeps_every_bit(awkward: Result, tmp_path: Path) -> None:
    path = tmp_path / "new" / "awkward.csv"
    awkward.write_csv(path)
    with path.open(newline="") as file:
        header, *lines = csv.reader(file)
    assert header == ["time", "a.x[1]", 'b."odd", name', "c.y"]
    read = np.array([[float(cell) for cell in line] for line in lines])
    assert read[:, 0].tobytes() == awkward.time.tobytes()
    assert read[:, 1:].tobytes() == awkward.rows.tobytes()
    assert sorted(p.name for p in path.parent.iterdir()) == ["awkward.csv"]


def test_same_result_same_bytes(awkward: Result, tmp_path: Path) -> None:
    for name in ("1.csv", "2.csv"):
        awkward.write_csv(tmp_path / name)
    assert (tmp_path / "1.csv").read_bytes() == (tmp_path / "2.csv").read_bytes()


def test_a_file_that_cannot_be_written_leaves_nothing_behind(awkward: Result, tmp_path: Path) -> None:
    (tmp_path / "taken.csv").mkdir()
    with pytest.raises(OrchestrationError, match=r"taken\.csv: the result cannot be written: "):
        awkward.write_csv(tmp_path / "taken.csv")
    assert [p.name for p in tmp_path.iterdir()] == ["taken.csv"]


def test_an_interrupted_write_keeps_the_old_file(
    awkward: Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "result.csv"
    path.write_text("old")

    def full_disk(self: Path, target: Path) -> None:  # noqa: ARG001
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full_disk)
    with pytest.raises(OrchestrationError, match="No space left on device"):
        awkward.write_csv(path)
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("result.csv", "old")]
