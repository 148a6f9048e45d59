"""Time series as values, and what they are made of: arrays, files, and tables of other libraries."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from orchestration import Result, System, SystemDescriptionError, TimeSeries, prepare, simulate
from orchestration.master.driven import driven_inputs
from orchestration.master.kernel import series
from orchestration.master.time_series import series_of
from tests.unit.orchestration.small_models import H, system

T = np.array([0.0, 0.5, 2.0])
U = np.array([1.0, 3.0, -1.0])
N = np.array([4, 5, 6])
COLUMNS = {"relay.u": U, "relay.n": N}


def structured() -> np.ndarray:
    """Return the array that fmpy takes as input."""
    return np.array(list(zip(T, U, N, strict=True)), [("time", float), ("relay.u", float), ("relay.n", int)])


def dataset() -> xr.Dataset:
    """Return a Dataset over time, with a unit."""
    return xr.Dataset({name: ("time", values) for name, values in COLUMNS.items()}, {"time": T})


SOURCES: dict[str, Callable[[], Any]] = {
    "pairs": lambda: {name: (T, values) for name, values in COLUMNS.items()},
    "lists": lambda: {name: [T.tolist(), values.tolist()] for name, values in COLUMNS.items()},
    "series": lambda: {name: TimeSeries(T, values) for name, values in COLUMNS.items()},
    "frame": lambda: pd.DataFrame(COLUMNS, index=T),
    "frame with a named index": lambda: pd.DataFrame(COLUMNS, index=pd.Index(1000 * T, name="t [ms]")),
    "frame with a column time": lambda: pd.DataFrame({"relay.u": U, "time": T, "relay.n": N}),
    "frame with a first column": lambda: pd.DataFrame({"t [s]": T, **COLUMNS}),
    "frame over differences of times": lambda: pd.DataFrame(COLUMNS, index=pd.to_timedelta(T, unit="s")),
    "columns of a frame": lambda: dict(pd.DataFrame(COLUMNS, index=T).items()),
    "dataset": dataset,
    "variables of a dataset": lambda: dict(dataset().data_vars.items()),
    "structured": structured,
    "result": lambda: Result(T, tuple(COLUMNS), np.column_stack(list(COLUMNS.values())).astype(float)),
}


@pytest.mark.parametrize("make", SOURCES.values(), ids=SOURCES.keys())
def test_every_source_gives_the_same_series(make: Callable[[], Any]) -> None:
    found = series_of(make())
    assert list(found) == list(COLUMNS)
    for name, values in COLUMNS.items():
        np.testing.assert_allclose(found[name].time, T, rtol=1e-15)
        np.testing.assert_array_equal(found[name].values, values)
        assert found[name].values.dtype == np.float64


FILES: dict[str, Callable[[Path], object]] = {
    "csv": lambda path: path.write_text("time,relay.u,relay.n\n0,1,4\n0.5,3,5\n2,-1,6\n"),
    "csv with a mark and units": lambda path: path.write_bytes(
        b'\xef\xbb\xbf"t [ms]","relay.u [m]","relay.n"\r\n0,1,4\r\n500,3,5\r\n2000,-1,6\r\n'
    ),
    "csv with the time last": lambda path: path.write_text("relay.u,relay.n,time\n1,4,0\n3,5,0.5\n-1,6,2\n"),
    "parquet of a result": lambda path: SOURCES["result"]().write(path),
    "parquet of pandas": lambda path: SOURCES["frame"]().to_parquet(path),
    "parquet of pandas with a name": lambda path: SOURCES["frame"]().rename_axis("time").to_parquet(path),
}


@pytest.mark.parametrize("name", FILES)
def test_every_file_gives_the_same_series(tmp_path: Path, name: str) -> None:
    path = tmp_path / f"measured.{name.split()[0]}"
    FILES[name](path)
    for source in (path, str(path)):
        found = series_of(source)
        assert list(found) == list(COLUMNS)
        for column, values in COLUMNS.items():
            np.testing.assert_allclose(found[column].time, T, rtol=1e-15)
            np.testing.assert_array_equal(found[column].values, values)
            assert found[column].source == path.name


def test_what_a_result_gives_can_be_given_back(fig2: System, tmp_path: Path) -> None:
    """As a result, a file, a DataFrame or a Dataset, with units, and arrays as elements or as a whole."""
    result = simulate(fig2, 1e-3, record=["plant.tau", "controller.x_v"])
    result.write(tmp_path / "x.parquet")
    units = {"plant.tau[1]": "N.m", "plant.tau[2]": "N.m", "controller.x_v[1]": "m", "controller.x_v[2]": "m"}
    for source in (result, tmp_path / "x.parquet", result.to_pandas()):
        found = series_of(source)
        assert {name: one.unit for name, one in found.items()} == units
        assert all(one.values.tobytes() == result[name].tobytes() for name, one in found.items())
    whole = series_of(result.to_xarray())
    assert {name: (one.unit, one.values.shape) for name, one in whole.items()} == {
        "plant.tau": ("N.m", (11, 2)),
        "controller.x_v": ("m", (11, 2)),
    }
    columns = series_of({"plant.tau[1]": result.to_pandas()["plant.tau[1]"]})
    assert columns["plant.tau[1]"].unit == "N.m"


def test_arrays_are_not_copied() -> None:
    given = TimeSeries(T, np.column_stack([U, U]))
    assert np.shares_memory(given.time, T)
    whole = np.zeros((3, 4))
    assert np.shares_memory(TimeSeries(T, whole[:, 1]).values, whole)


def test_choices_for_one_and_for_all(tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    FILES["csv"](path)
    found = TimeSeries.read(path, interpolation="held", outside="hold", units={"relay.u": "mm"})
    assert {(one.interpolation, one.outside) for one in found.values()} == {("held", "hold")}
    assert [one.unit for one in found.values()] == ["mm", ""]
    with pytest.raises(SystemDescriptionError, match=r"units: there is no series relay\.v; there are relay\.u"):
        TimeSeries.read(path, units={"relay.v": "mm"})


def test_its_repr_says_what_it_is() -> None:
    given = TimeSeries(T, np.zeros((3, 2)), "linear", unit="kN", source="x.csv")
    assert repr(given) == "<TimeSeries: 3 points of 2 values, t = 0 to 2 s, linear, in kN, from x.csv>"


@pytest.mark.parametrize(
    ("source", "unit"),
    [
        (lambda: {"relay.u": TimeSeries(T, 1000 * U, unit="mm")}, "mm"),
        (lambda: {"relay.u": pd.Series(1000 * U, T, name="relay.u").pipe(_with, {"unit": "mm"})}, "mm"),
        (lambda: pd.DataFrame({"relay.u": 1000 * U}, T).pipe(_with, {"units": {"relay.u": "mm"}}), "mm"),
        (lambda: pd.DataFrame({"relay.u [mm]": 1000 * U}, T), "mm"),
        (lambda: xr.Dataset({"relay.u": ("time", 1000 * U, {"units": "mm"})}, {"time": T}), "mm"),
        (lambda: xr.Dataset({"relay.u": ("x", U / 1000)}, {"x": ("x", 1000 * T, {"units": "ms"})}), ""),
    ],
)
def test_units_are_converted_to_that_of_the_input(small: dict[str, Path], source: Callable[[], Any], unit: str) -> None:
    (one,) = driven_inputs(system(small, {"relay": "Relay"}), source()).inputs
    np.testing.assert_allclose(one.time, T, rtol=1e-15)
    np.testing.assert_allclose(one.values, U if unit else U / 1000, rtol=1e-15)
    assert one.given.unit == unit


def _with(table: Any, attrs: dict[str, Any]) -> Any:
    """Return a table of pandas with attributes."""
    table.attrs = attrs
    return table


def test_the_default_interpolation_follows_the_input(small: dict[str, Path]) -> None:
    made = system(small, {"plant": "Integrator", "relay": "Relay"})
    given = {name: (T, [0, 1, 0]) for name in ("plant.u", "relay.u", "relay.n", "relay.even")}
    forms = {one.name: one.form for one in driven_inputs(made, given).inputs}
    assert forms == {
        "plant.u": series.Form.LINEAR,
        "relay.u": series.Form.LINEAR,
        "relay.n": series.Form.HELD_DISCRETE,
        "relay.even": series.Form.HELD_DISCRETE,
    }
    relay = made["relay"]
    held = replace(relay.description.variables["u"], variability="discrete")
    description = replace(relay.description, variables={**relay.description.variables, "u": held})
    made = replace(made, components=(made["plant"], replace(relay, description=description)))
    assert [one.form for one in driven_inputs(made, {"relay.u": (T, U)}).inputs] == [series.Form.HELD]


def value_at(t: float, h: float, form: series.Form, cursor: int = 0) -> tuple[float, float, int]:
    """Return value, rate and cursor of the series T, U at a step from t, s, of h, s."""
    place, rate = np.zeros(1), np.zeros(1)
    table = series.new_table(1)
    C = series.Column
    table[1, C.TIMES], table[1, C.VALUES], table[1, C.STRIDE], table[1, C.LAST] = (
        *(T.ctypes.data, U.ctypes.data),
        *(8, len(T) - 1),
    )
    table[1, C.CURSOR], table[1, C.FORM] = cursor, form
    table[1, C.PLACE], table[1, C.RATE] = place.ctypes.data, rate.ctypes.data
    series.give(table, t, h)
    return float(place[0]), float(rate[0]), int(table[1, C.CURSOR])


@pytest.mark.parametrize("cursor", [0, 1, 2])
@pytest.mark.parametrize("t", [-1.0, 0.0, 0.25, 0.4999, 0.5, 0.5 - 1e-13, 1.0, 1.999, 2.0, 3.0])
def test_values_are_those_of_numpy_wherever_the_cursor_stands(t: float, cursor: int) -> None:
    h = 1e-3
    value, rate, at = value_at(t, h, series.Form.LINEAR, cursor)
    assert value == pytest.approx(np.interp(t, T, U), abs=1e-11)
    assert rate == pytest.approx((np.interp(t + h, T, U) - np.interp(t, T, U)) / h, abs=1e-8)
    held, _, reached = value_at(t, h, series.Form.HELD, cursor)
    assert at == reached
    assert held == U[max(0, np.searchsorted(T, t + 1e-12, side="right") - 1)]


def test_within_a_segment_the_rate_is_its_slope_to_the_bit() -> None:
    for t in (0.0, 0.125, 0.3, 0.5, 0.7, 1.9):
        slope = np.diff(U)[int(t >= 0.5)] / np.diff(T)[int(t >= 0.5)]
        assert value_at(t, 0.1, series.Form.LINEAR)[1] == slope


def test_the_end_values_hold_only_if_asked(small: dict[str, Path]) -> None:
    made = system(small, {"plant": "Integrator"}, steps=24)  # to 3 s
    with pytest.raises(SystemDescriptionError, match=r"plant\.u is given from 0 s to 2 s, but the run goes"):
        prepare(made, inputs={"plant.u": (T, U)})
    result = simulate(made, inputs={"plant.u": TimeSeries(T, U, outside="hold")}, record="plant.u")
    np.testing.assert_array_equal(result["plant.u"][17:], np.interp(result.time[16:-1], T, U))
    assert result.time[16] == 16 * H == T[-1]
