"""Wrong time series: each is refused before the run, in a sentence with the input and both values."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from orchestration import System, SystemDescriptionError, TimeSeries, prepare
from tests.sharing import made_once
from tests.unit.orchestration.small_models import build_small_models, system

T = np.array([0.0, 1.0, 2.0])
FLAT = (T, np.ones(3))


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> System:
    """Return a system of 2 s with a free input of each type, and one that is connected."""
    small = {path.stem: path for path in made_once(tmp_path_factory, "small", build_small_models).glob("*.fmu")}
    return system(small, {"plant": "Integrator", "relay": "Relay", "switch": "Switch"}, "plant.x -> relay.u")


WRONG: dict[str, tuple[Callable[[], Any], str]] = {
    "unknown input": (
        lambda: {"plant.v": FLAT},
        r"^inputs: there is no input plant\.v; did you mean plant\.u\?$",
    ),
    "name without a component": (lambda: {"u": FLAT}, r"^inputs: there is no input u; "),
    "unknown component": (lambda: {"planet.u": FLAT}, r"there is no input planet\.u; did you mean plant\.u"),
    "an output": (lambda: {"plant.x": FLAT}, r"plant\.x is not an input, but of causality output; only inputs take"),
    "a parameter": (
        lambda: {"plant.through": FLAT},
        r"plant\.through is not an input, but of causality parameter; set it, or",
    ),
    "connected": (lambda: {"relay.u": FLAT}, r"relay\.u has a source already, plant\.x; leave out the connection or"),
    "time goes back": (
        lambda: {"plant.u": ([0.0, 2.0, 1.0], [1, 2, 3])},
        r"^inputs: plant\.u: its time goes from 2 s to 1 s at point 2; times must increase\.$",
    ),
    "time stands": (lambda: {"plant.u": ([0.0, 1.0, 1.0], [1, 2, 3])}, r"goes from 1 s to 1 s at point 2"),
    "time is NaN": (lambda: {"plant.u": ([0.0, np.nan, 2.0], [1, 2, 3])}, r"plant\.u: its time is nan at point 1"),
    "value is NaN": (
        lambda: {"plant.u": (T, [1.0, 2.0, np.nan])},
        r"^inputs: plant\.u: its value is nan at t = 2 s \(point 2\); fill or drop such points first\.$",
    ),
    "value is infinite": (lambda: {"plant.u": (T, [1.0, np.inf, 0.0])}, r"its value is inf at t = 1 s"),
    "lengths": (
        lambda: {"plant.u": (T, [1.0, 2.0])},
        r"^inputs: plant\.u: it has 3 times, but 2 values; one value for each time is needed\.$",
    ),
    "empty": (lambda: {"plant.u": ([], [])}, r"^inputs: plant\.u: it has no points; at least one is needed\.$"),
    "time of two dimensions": (lambda: {"plant.u": ([T, T], FLAT[1])}, r"its time has the shape \(2, 3\); \(n,\) is"),
    "too short": (
        lambda: {"plant.u": ([0.0, 1.5], [1, 2])},
        r'^inputs: plant\.u is given from 0 s to 1\.5 s, but the run goes from 0 s to 2 s; .*outside="hold"',
    ),
    "begins late": (lambda: {"plant.u": ([0.1, 3.0], [1, 2])}, r"given from 0\.1 s to 3 s, but the run goes from 0 s"),
    "two columns for a scalar": (
        lambda: {"plant.u": (T, np.ones((3, 2)))},
        r"^inputs: plant\.u takes values of the shape \(3,\), not \(3, 2\)\.$",
    ),
    "unit of another dimension": (
        lambda: {"plant.u": TimeSeries(*FLAT, unit="kN")},
        r"^inputs: plant\.u has the unit m, its series kN, which does not become m\.$",
    ),
    "unknown unit": (lambda: {"plant.u": TimeSeries(*FLAT, unit="furlong")}, r"its series furlong, which is not known"),
    "linear Integer": (
        lambda: {"relay.n": TimeSeries(*FLAT, interpolation="linear")},
        r"relay\.n is of type Integer, which is held between points; it cannot be linear",
    ),
    "half an Integer": (
        lambda: {"relay.n": (T, [0, 1.5, 2])},
        r"relay\.n is of type Integer; its value 1\.5 at t = 1 s is not an integer of 32 bits",
    ),
    "a long Integer": (lambda: {"relay.n": (T, [0, 2**31, 2])}, r"its value 2\.14748365e\+09 at t = 1 s is not an"),
    "no Boolean": (lambda: {"relay.even": (T, [0, 1, 2])}, r"relay\.even is of type Boolean; its value 2 at t = 2 s"),
    "texts": (lambda: {"plant.u": (T, ["a", "b", "c"])}, r"plant\.u: its values are not numbers, but such as 'a'"),
    "complex": (lambda: {"plant.u": (T, [1j, 2, 3])}, r"plant\.u: its values are not numbers"),
    "nothing": (lambda: {"plant.u": None}, r"plant\.u: None is not \(time, values\), a TimeSeries, or a column"),
    "a constant": (
        lambda: {"plant.u": 3.0},
        r"plant\.u: 3\.0 is not .*; give a constant as a start value, with sys",
    ),
    "values alone": (lambda: {"plant.u": np.ones(3)}, r"an array of shape \(3,\) is not .*; give its time, too"),
    "ragged": (lambda: {"plant.u": (T, [[1], [2, 3], [4]])}, r"its values do not form an array, because their lengths"),
    "dates": (
        lambda: pd.DataFrame({"plant.u": FLAT[1]}, pd.date_range("2024-01-01", periods=3)),
        r"plant\.u: its times are not numbers, but such as '2024-01-01.*in s from the start of the run",
    ),
    "name is not a text": (lambda: {("plant", "u"): FLAT}, r"the name \('plant', 'u'\) is not a text"),
    "a number": (lambda: 3.0, r"^inputs: 3\.0 is not a mapping of names to \(time, values\), a pandas DataFrame"),
    "a plain array": (lambda: np.ones((3, 2)), r"^inputs: an array of shape \(3, 2\) is not a mapping"),
    "table without time": (
        lambda: pd.DataFrame({"plant.u": FLAT[1], "relay.n": FLAT[1]}),
        r"its first column is plant\.u; the first column, or one called time, must hold the time",
    ),
    "time in kN": (lambda: pd.DataFrame({"time [kN]": T, "plant.u": FLAT[1]}), r"its time has the unit kN, which does"),
    "array without coordinate": (
        lambda: xr.Dataset({"plant.u": ("x", FLAT[1])}),
        r"plant\.u: its dimension x has no coordinate; give it the times in s",
    ),
    "array without dimension": (lambda: {"plant.u": xr.DataArray(1.0)}, r"plant\.u: it has no dimension"),
}


@pytest.mark.parametrize("name", WRONG)
@pytest.mark.filterwarnings("ignore:Unconnected inputs")
def test_a_wrong_series_is_refused(made: System, name: str) -> None:
    make, words = WRONG[name]
    with pytest.raises(SystemDescriptionError, match=words) as refused:
        prepare(made, inputs=make())
    assert len(str(refused.value)) <= 300


FILES: dict[str, tuple[str, str | None, str]] = {
    "missing": ("a.csv", None, r"a\.csv: the time series cannot be read: No such file"),
    "suffix": ("a.txt", "time,plant.u\n0,1\n", r"a\.txt: time series are read from \.csv or \.parquet, not from \.txt"),
    "without a suffix": ("a", "time,plant.u\n0,1\n", r"not from a file without a suffix"),
    "empty": ("a.csv", "", r"a\.csv does not hold time series: it is empty; the first line must name the columns"),
    "header only": ("a.csv", "time,plant.u\n", r"plant\.u: it has no points"),
    "semicolons": ("a.csv", "time;plant.u\n0;1\n", r"its columns are separated by semicolons; separate them by commas"),
    "texts": ("a.csv", "time,plant.u\n0,one\n1,two\n", r"a\.csv does not hold time series: .*one"),
    "an empty cell": ("a.csv", "time,plant.u\n0,1\n1,\n2,1\n", r"plant\.u: its value is nan at t = 1 s \(point 1\)"),
    "a short line": ("a.csv", "time,plant.u\n0,1\n1\n", r"a\.csv does not hold time series: .*2 columns"),
    "numbers for a header": ("a.csv", "0,1\n1,2\n2,3\n", r"there is no input 1; "),
    "a column twice": ("a.csv", "time,plant.u,plant.u\n0,1,1\n2,1,1\n", r"the column plant\.u is there twice"),
    "wrong unit": ("a.csv", "time,plant.u [N]\n0,1\n2,1\n", r"plant\.u has the unit m, its series N, which does not"),
    "no Parquet": ("a.parquet", "time,plant.u\n0,1\n", r"a\.parquet does not hold time series: "),
}


@pytest.mark.parametrize("name", FILES)
@pytest.mark.filterwarnings("ignore:Unconnected inputs")
def test_a_wrong_file_is_refused(made: System, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    file, text, words = FILES[name]
    monkeypatch.chdir(tmp_path)
    if text is not None:
        Path(file).write_text(text, encoding="utf-8")
    with pytest.raises(SystemDescriptionError, match=words) as refused:
        prepare(made, inputs=file)
    assert len(str(refused.value)) <= 300


@pytest.mark.parametrize("choice", [{"interpolation": "cubic"}, {"outside": "zero"}])
def test_an_unknown_choice_is_refused(choice: dict[str, str]) -> None:
    with pytest.raises(SystemDescriptionError, match=r"^A time series: there is no .*; there are '"):
        TimeSeries(*FLAT, **choice)


def test_an_element_that_its_array_gives_too_is_refused(fmu_folder: Path) -> None:
    plant = System.of({"plant": fmu_folder / "Plant.fmu"})
    pair = (T, np.ones((3, 2)))
    with pytest.raises(
        SystemDescriptionError, match=r"plant\.tau\[1\] is given twice, by plant\.tau and by plant\.tau\[1\]"
    ):
        prepare(plant, 1.0, 0.1, inputs={"plant.tau": pair, "plant.tau[1]": FLAT})
    with pytest.raises(SystemDescriptionError, match=r"plant\.tau takes values of the shape \(3, 2\), not \(3,\)"):
        prepare(plant, 1.0, 0.1, inputs={"plant.tau": FLAT})
    with pytest.raises(SystemDescriptionError, match=r"plant\.tau takes values of the shape \(3, 2\), not \(3, 3\)"):
        prepare(plant, 1.0, 0.1, inputs={"plant.tau": (T, np.ones((3, 3)))})
