"""Tests of recorded results: every choice of columns gives the same bits, and CSV files keep all bits."""

import csv
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from orchestration import Options, OrchestrationError, Result, System, SystemDescriptionError, compare, simulate
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
        ("relay.z", r"relay has no variable z; there are sample_time, offset, u, n and 4 more"),
        ("relais.y", r"System small has no component relais; did you mean relay\?"),
        ("relay", r"'relay' is not of the form component\.variable, such as source\."),
    ],
)
def test_what_cannot_be_recorded_is_refused(small: dict[str, Path], name: str, message: str) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        simulate(mixed(small), options=Options(record=[name]))


def test_unknown_column_lists_the_recorded_ones(small: dict[str, Path]) -> None:
    result = simulate(chain(small, 1), options=Options(record=["source.n", "relay1.y"]))
    for lookup in (result.__getitem__, result.at_ticks):
        with pytest.raises(OrchestrationError, match=r"no column source\.u; did you mean source\.n\?"):
            lookup("source.u")


def test_vectors_and_time_are_columns(fig2: System) -> None:
    result = simulate(fig2, 10 * fig2.run_step())
    np.testing.assert_array_equal(result["plant.q"], np.column_stack([result["plant.q[1]"], result["plant.q[2]"]]))
    assert result["controller.p_hat"].shape == (11, 6)
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


@pytest.fixture
def arm() -> Result:
    """Columns of a vector, a matrix, a scalar, and an array of which an element is missing."""
    names = ("a.x[1]", "a.x[2]", "a.H[1,1]", "a.H[1,2]", "a.H[2,1]", "a.H[2,2]", "b.y", "b.part[2]")
    units = dict.fromkeys(names, "") | {"a.x[1]": "m", "a.x[2]": "m", "b.y": "N"}
    return Result(np.array([0.0, 0.5, 1.0]), names, np.arange(24.0).reshape(3, 8), units, metadata={"system": "s"})


def test_a_result_is_a_mapping(arm: Result) -> None:
    assert isinstance(arm, Mapping)
    assert len(arm) == 8
    assert list(arm) == list(arm.keys()) == list(arm.names)
    assert "b.y" in arm
    assert "time" in arm
    assert "a.x" in arm
    assert "b.part" not in arm
    assert 3 not in arm
    assert arm.get("nobody") is None
    assert {name: values.tolist() for name, values in arm.items()}["b.y"] == [6.0, 14.0, 22.0]


def test_arrays_have_their_shape(arm: Result) -> None:
    assert arm["a.x"].tolist() == [[0.0, 1.0], [8.0, 9.0], [16.0, 17.0]]
    assert arm["a.H"].shape == (3, 2, 2)
    assert arm["a.H"][0].tolist() == [[2.0, 3.0], [4.0, 5.0]]
    assert arm.at_ticks("a.x").shape == (2, 2)
    assert (arm.unit("a.x"), arm.unit("a.H"), arm.unit("time"), arm.unit("b.y")) == ("m", "", "s", "N")


def test_a_wrong_name_is_a_key_error_that_helps(arm: Result) -> None:
    with pytest.raises(KeyError) as caught:
        arm["a.X[3]"]
    assert str(caught.value) == "The result has no column a.X[3]; the elements of a.x are a.x[1] to a.x[2]."
    with pytest.raises(OrchestrationError, match=r"no column nothing; there are a\.x, a\.H, b\.y, b\.part\.$"):
        arm["nothing"]


def test_equality_is_bitwise(arm: Result) -> None:
    assert arm == replace(arm)
    assert arm != replace(arm, rows=arm.rows + 1)
    assert arm != replace(arm, units={})
    holes = replace(arm, rows=np.full((3, 8), np.nan))
    assert holes == replace(holes, rows=holes.rows.copy())
    assert arm != "a result"
    with pytest.raises(TypeError, match="unhashable"):
        hash(arm)


def test_pandas_and_xarray_get_everything(arm: Result) -> None:
    frame = arm.to_pandas()
    assert frame.index.name == "time"
    assert frame["b.y"].tolist() == [6.0, 14.0, 22.0]
    assert frame.attrs["units"]["a.x[1]"] == "m"
    assert frame.attrs["metadata"] == {"system": "s"}
    dataset = arm.to_xarray()
    assert dataset["a.H"].sel(time=0.5).values.tolist() == [[10.0, 11.0], [12.0, 13.0]]
    assert dataset["a.x"].attrs["units"] == "m"
    assert dataset["b.part[2]"].dims == ("time",)
    assert dataset.attrs["system"] == "s"
    assert dataset["time"].attrs["units"] == "s"


def test_plot_has_a_panel_for_each_unit(arm: Result) -> None:
    panels = arm.plot("a.x", "b.*")
    assert [panel.get_ylabel() for panel in panels] == ["a.x (m)", "b.y (N)", "b.part"]
    assert [line.get_label() for line in panels[0].get_lines()] == ["a.x[1]", "a.x[2]"]
    assert panels[-1].get_xlabel() == "time (s)"
    axes = Figure().add_subplot()
    assert arm.plot("b.y", ax=axes)[0] is axes
    with pytest.raises(OrchestrationError, match=r"have the units m, N; one panel takes one unit"):
        arm.plot("a.x", "b.y", ax=axes)
    with pytest.raises(KeyError, match=r"no column a\.z\*"):
        arm.plot("a.z*")


def test_reprs_are_short(arm: Result) -> None:
    assert repr(arm) == ("<Result: 3 rows, t = 0 to 1 s, 8 columns (a.x[1], a.x[2], a.H[1,1], a.H[1,2], and 4 more)>")
    wide = Result(np.zeros(2), tuple(f"component.signal{i}" for i in range(1000)), np.zeros((2, 1000)))
    assert len(repr(wide)) < 200
    assert len(wide._repr_html_()) < 3500
    assert "<td>a.x [2]</td><td>m</td>" in arm._repr_html_()
    assert "&lt;b&gt;" in replace(arm, status="failed", message="<b>")._repr_html_()


def test_compare_finds_where_and_by_how_much(arm: Result) -> None:
    assert compare(arm, replace(arm)).identical
    other = replace(arm, rows=arm.rows.copy())
    other.rows[1, 6] += 8.0
    found = compare(arm, other)
    assert not found.identical
    assert (found.worst.name, found.worst.largest, found.worst.at, found.worst.relative) == ("b.y", 8.0, 0.5, 0.5)
    assert found.worst.first == 0.5
    assert found.worst.rms == pytest.approx(8.0 / 3**0.5)
    assert len(found.to_pandas()) == 8


def test_compare_uses_common_communication_points(arm: Result) -> None:
    coarse = Result(arm.time[::2], ("b.y", "c.z"), np.column_stack([arm["b.y"][::2], [1.0, np.nan]]))
    found = compare(arm, coarse)
    assert (found.n_rows, found.only_in_second) == (2, ("c.z",))
    assert len(found.only_in_first) == 7
    assert found.differences[0].largest == 0.0
    with pytest.raises(OrchestrationError, match=r"no common communication point: 0 to 1 s and 7 to 8 s"):
        compare(arm, Result(np.array([7.0, 8.0]), ("b.y",), np.zeros((2, 1))))


def test_compare_without_a_common_column_has_no_worst_one(arm: Result) -> None:
    other = Result(arm.time, ("c.z",), np.zeros((3, 1)))
    found = compare(arm, other)
    assert repr(found) == "<Comparison: 0 columns, 3 rows, no common column>"
    assert not found.identical
    with pytest.raises(OrchestrationError, match=r"no common column: a\.x\[1\], .* \.\.\., and c\.z; record the same"):
        _ = found.worst


def test_compare_counts_nan_as_the_largest_difference(arm: Result) -> None:
    other = replace(arm, rows=arm.rows.copy())
    other.rows[2, 0] = np.nan
    worst = compare(arm, other).worst
    assert (worst.name, worst.at) == ("a.x[1]", 1.0)
    assert np.isnan(worst.largest)


def test_names_arrays_and_patterns_are_recorded(fig2: System) -> None:
    stop = 3 * fig2.run_step()
    assert simulate(fig2, stop, record="plant.x").names == ("plant.x[1]", "plant.x[2]")
    assert simulate(fig2, stop, record="plant.x[2]").names == ("plant.x[2]",)
    some = simulate(fig2, stop, record=["controller.e", "plant.?x[*]", "plant.x[1]", "controller.e[1]"])
    assert some.names == ("controller.e[1]", "controller.e[2]", "plant.dx[1]", "plant.dx[2]", "plant.x[1]")
    with pytest.raises(SystemDescriptionError, match=r"^record: no output fits 'plnt\.\*'; did you mean plant\."):
        simulate(fig2, stop, record="plnt.*")
    with pytest.raises(SystemDescriptionError, match=r"^A name in record is 3, of type int; give a text"):
        Options(record=["plant.x", 3])  # pyright: ignore[reportArgumentType] - it is refused
    with pytest.raises(SystemDescriptionError, match=r"^record is given twice"):
        simulate(fig2, stop, record="plant.x", options=Options(record="plant.q"))


def test_a_path_is_run_and_progress_is_told(fig2: System, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, stop = fig2.write(tmp_path / "fig2.ssp"), 3 * fig2.run_step()
    told: list[tuple[int, int]] = []
    result = simulate(str(path), stop, progress=lambda done, total: told.append((done, total)))
    assert result == simulate(fig2, stop, progress=True)
    assert told[-1] == (3, 3)
    assert capsys.readouterr().out == ""
