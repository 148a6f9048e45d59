"""Studies: tables of runs, rows that are repeated, runs that fail, and values that an optimizer asks for."""

import gc
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from orchestration import (
    OrchestrationError,
    Result,
    SimulationError,
    Study,
    StudyError,
    System,
    SystemDescriptionError,
    simulate,
)
from orchestration.campaigns import evaluator
from tests.unit.orchestration.campaigns.plain import PlainEngine
from tests.unit.orchestration.small_models import H

pytestmark = pytest.mark.usefixtures("plain")
HALF: Any = 1.5
GROWTH = (1 + 2 * H) ** 4
"""Factor by which x grows over the four steps of the loop; the number has an exact double."""
OVERFLOW = 1.7e308
"""An offset with which the loop's signals leave the range of doubles."""


@pytest.fixture
def study(loop: System) -> Study:
    """The largest x of the loop."""
    return Study(loop, ["top = max(plant.x)", "ticks = final(source.n)"])


def test_a_grid_becomes_a_dataset_whose_dimensions_are_the_factors(study: Study) -> None:
    table = study.grid({"x_start": [1, 2, 4], "relay.n": [0, 1]}).run()
    assert isinstance(table, xr.Dataset)
    assert dict(table.sizes) == {"x_start": 3, "n": 2}
    assert table["top"].values.tolist() == [[GROWTH * x] * 2 for x in (1, 2, 4)]
    assert table["ticks"].values.tolist() == [[3.0, 3.0]] * 3
    assert set(table["status"].values.ravel()) == {"complete"}
    assert set(table["message"].values.ravel()) == {""}
    assert table["n"].dtype == np.int64


def test_a_dataset_tells_units_and_what_all_runs_share(study: Study) -> None:
    table = study.grid({"relay.offset": [0, 1]}).run()
    assert (table["offset"].attrs, table["top"].attrs) == ({"units": "m", "sets": "relay.offset"}, {"units": "m"})
    assert table.attrs == {"system": "small", "algorithm": "gauss-seidel", "stop_time": 4 * H}


def test_samples_become_a_data_frame(study: Study) -> None:
    table = study.samples({"x_start": "1:2"}, n=4).grid({"offset": [0.0, 0.5]}).run()
    assert isinstance(table, pd.DataFrame)
    assert table.columns.tolist() == ["x_start", "offset", "top", "ticks", "status", "message"]
    assert table.index.name == "run"
    assert len(table) == 8
    without = table[table["offset"] == 0.0]
    assert without["top"].tolist() == (GROWTH * without["x_start"]).tolist()
    assert table.attrs["units"] == {"x_start": "", "offset": "m", "top": "m", "ticks": ""}


def test_a_study_without_a_factor_is_one_run(study: Study) -> None:
    table = study.run()
    assert table[["top", "status"]].to_numpy().tolist() == [[GROWTH, "complete"]]


def test_variants_make_the_same_runs(loop: System) -> None:
    systems = {"one": loop, "two": loop.set({"relay.offset": 1.0})}
    grid = Study(systems, "top = max(plant.x)").grid({"x_start": [1, 2]}).run()
    assert dict(grid.sizes) == {"system": 2, "x_start": 2}
    assert grid["top"].sel(system="one").values.tolist() == [GROWTH, 2 * GROWTH]
    assert (grid["top"].sel(system="two") > grid["top"].sel(system="one")).all()
    frame = Study(systems, "top = max(plant.x)").samples({"x_start": "1:2"}, n=4, seed=3).run()
    first, second = (frame[frame["system"] == name] for name in systems)
    assert first["x_start"].tolist() == second["x_start"].tolist()
    assert (second["top"].to_numpy() > first["top"].to_numpy()).all()


def test_variants_have_the_same_seeds(fig2: System) -> None:
    noisy = fig2.set({"sensor.noise_std": 1.0, "sensor.noise_bound": 3.0, "sensor.contact_gated": False})
    systems = {"soft": noisy.set({"controller.K": 1000.0}), "hard": noisy}
    table = Study(systems, "f = final(sensor.F_hat[1])", stop_time=2e-4).seeds("3-5").run()
    assert table["seed"].values.tolist() == [3, 4, 5]
    assert table["f"].sel(system="soft").values.tolist() == table["f"].sel(system="hard").values.tolist()
    assert len(set(table["f"].sel(system="hard").values)) == 3


def test_the_sample_time_is_that_of_with_sample_time(loop: System) -> None:
    table = Study(loop, "top = max(plant.x)").grid({"sample_time": [H, H / 2]}).run()
    expected = [simulate(loop.with_sample_time(h))["plant.x"].max() for h in (H, H / 2)]
    assert table["top"].values.tolist() == expected


def test_a_run_that_fails_is_a_row_with_its_sentence(study: Study, loop: System) -> None:
    table = study.grid({"offset": [0.0, OVERFLOW, 1.0]}).run()
    assert table["status"].values.tolist() == ["complete", "failed", "complete"]
    assert np.isnan(table["top"].values).tolist() == [False, True, False]
    with pytest.raises(SimulationError) as error:
        simulate(loop.set({"relay.offset": OVERFLOW}))
    assert table["message"].values[1] == str(error.value)


def test_a_function_that_raises_fails_its_rows_only(loop: System) -> None:
    def picky(result: Result) -> float:
        if result["plant.x"][0] > 1.5:
            msg = "too far"
            raise ValueError(msg)
        return result["plant.x"][0]

    table = Study(loop, ["max(plant.x)", picky]).grid({"x_start": [1, 2]}).run()
    assert table["picky"].values[0] == 1.0
    assert np.isnan([table["picky"].values[1], table["max(plant.x)"].values[1]]).all()
    assert table["message"].values[1] == "Measure picky: its function failed with ValueError: too far."


def test_a_measure_without_an_instant_is_nan_in_a_run_that_succeeded(loop: System) -> None:
    table = Study(loop, "high = mean(plant.x, where=plant.x > 100)").run()
    assert table[["status", "message"]].to_numpy().tolist() == [["complete", ""]]
    assert np.isnan(table["high"][0])


@pytest.mark.parametrize("wrong", [{"stop_time": 2.5 * H}, {"step": 0.3 * H}])
def test_a_system_that_cannot_be_run_is_refused_before_the_runs(loop: System, wrong: dict[str, Any]) -> None:
    with pytest.raises(SystemDescriptionError):
        Study(loop, "max(plant.x)", **wrong).grid({"x_start": [1, 2]}).run()


def test_each_row_of_a_data_frame_is_repeated_bit_for_bit(study: Study) -> None:
    extended = study.samples({"x_start": "0:1", "relay.n": range(5), "switch.flag": "true,false"}, n=8)
    table = extended.run()
    for number in range(len(table)):
        assert extended.result(table.iloc[number])["plant.x"].max() == table["top"][number]
        assert extended.result(**table.iloc[number].to_dict())["plant.x"].max() == table["top"][number]


def test_a_point_of_a_dataset_is_repeated(loop: System) -> None:
    study = Study(
        {"a": loop, "b": loop.set({"offset": 1.0} if "offset" in loop else {"relay.offset": 1.0})}, "max(plant.x)"
    )
    study = study.grid({"x_start": [1, 2, 3]})
    point = study.run().sel(system="b").isel(x_start=1)
    assert study.result(point)["plant.x"].max() == float(point["max(plant.x)"])


def test_a_run_is_repeated_by_its_number(study: Study) -> None:
    extended = study.grid({"x_start": [1, 2], "offset": [0.0, 0.5]})
    table = extended.run().to_dataframe().reset_index()
    assert [extended.result(n)["plant.x"].max() for n in range(4)] == table["top"].tolist()
    with pytest.raises(StudyError, match="There is no run 4; the numbers go from 0 to 3"):
        extended.result(4)


def test_traces_of_some_runs_are_written(study: Study, tmp_path: Path) -> None:
    extended = study.samples({"x_start": "1:2"}, n=8)
    worst = extended.run().nlargest(2, "top")
    files = extended.traces(worst.index, tmp_path / "traces")
    assert [file.name for file in files] == [f"run-{n:06d}.parquet" for n in worst.index]
    assert [Result.read(file)["plant.x"].max() for file in files] == worst["top"].tolist()
    with pytest.raises(StudyError, match="There is no run -1"):
        extended.traces([0, -1], tmp_path / "none")
    assert not (tmp_path / "none").exists()


NAMES = [{"x_start": 2.0}, {"plant.x_start": 2.0}]


@pytest.mark.parametrize("values", NAMES)
@pytest.mark.parametrize("factor", ["x_start", "plant.x_start"])
def test_a_factor_is_known_by_each_of_its_names(study: Study, factor: str, values: dict[str, float]) -> None:
    assert study.grid({factor: [1, 2]}).result(**values)["plant.x"][0] == 2.0


def test_further_start_values_may_be_given(study: Study) -> None:
    result = study.grid({"x_start": [1, 2]}).result(x_start=1.0, offset=0.5)
    assert result["relay.y"][1] == 2.5


def test_values_beside_a_row_count_more(study: Study) -> None:
    extended = study.samples({"x_start": "0:1"}, n=2)
    assert extended.result(extended.run().iloc[0], x_start=7.0)["plant.x"][0] == 7.0


def test_the_run_of_a_row_that_failed_fails_again(study: Study) -> None:
    extended = study.samples(pd.DataFrame({"offset": [OVERFLOW]}))
    table = extended.run()
    with pytest.raises(SimulationError, match=re.escape(table["message"][0])):
        extended.result(table.iloc[0])


WRONG: dict[str, tuple[Callable[[Study], Any], type[OrchestrationError], str]] = {
    "a factor is missing": (
        lambda s: s.result(x_start=1.0),
        StudyError,
        "The value of offset is missing; give x_start=",
    ),
    "an unknown name": (lambda s: s.result(x_start=1.0, offset=0, xx=1), StudyError, "Factor xx: no component"),
    "two names of one": (
        lambda s: s.result(**{"x_start": 1.0, "plant.x_start": 1.0}, offset=0),
        StudyError,
        "Factor x_start is given twice",
    ),
    "a whole table": (lambda s: s.result(s.run()), StudyError, "2 values of x_start; choose one"),
    "no row": (lambda s: s.result(5.5), StudyError, "A row is 5.5"),
    "a value that is none": (lambda s: s.result(x_start=None, offset=0), SystemDescriptionError, "x_start = None"),
    "no worker": (lambda s: s.run(workers=0), StudyError, "workers is 0"),
    "half a worker": (lambda s: s.run(workers=HALF), StudyError, "workers is 1.5"),
    "no progress": (lambda s: s.run(progress=3), StudyError, "progress is 3"),
    "a variant that is not there": (lambda s: s.result(system="b", x_start=1, offset=0), StudyError, "no variant"),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_cannot_be_run_is_refused(study: Study, case: str) -> None:
    make, kind, message = WRONG[case]
    with pytest.raises(kind, match=message):
        make(study.grid({"x_start": [1, 2], "offset": [0, 1]}))


@pytest.mark.parametrize(
    ("system", "message"),
    [({}, "The variants of a study"), ({"a": 5}, "Variant a is 5"), (7, "give a System, its path"), ({1: 2}, "a text")],
)
def test_what_is_no_system_is_refused(system: Any, message: str) -> None:
    with pytest.raises(StudyError, match=message):
        Study(system, "max(plant.x)")


@pytest.mark.parametrize(
    ("times", "message"),
    [
        ({"stop_time": "2"}, "The stop time of a study is '2'"),
        ({"stop_time": float("nan")}, "The stop time of a study is nan"),
        ({"step": 0}, "The step of a study is 0 s; it must be positive"),
        ({"algorithm": 5}, "The algorithm of a study is 5"),
    ],
)
def test_times_that_are_no_numbers_are_refused(loop: System, times: dict[str, Any], message: str) -> None:
    with pytest.raises(StudyError, match=message):
        Study(loop, "max(plant.x)", **times)


def test_a_study_reads_its_system_from_a_package(loop: System, tmp_path: Path) -> None:
    table = Study(loop.write(tmp_path / "loop.ssp"), "top = max(plant.x)", step=H).grid({"x_start": [3]}).run()
    assert table["top"].values.tolist() == [3 * GROWTH]


def test_a_study_says_what_it_is(study: Study) -> None:
    extended = study.grid({"x_start": [1, 2]})
    assert repr(extended) == "<Study of small: 2 runs over x_start, top, ticks>"
    assert (len(extended), extended.units) == (2, {"top": "m", "ticks": ""})
    assert (extended.stop_time, extended.step, extended.algorithm) == (4 * H, H, "gauss-seidel")
    assert [factor.name for factor in extended.factors] == ["x_start"]


def test_one_point_is_evaluated(study: Study) -> None:
    assert study.evaluate({"x_start": 3.0}) == {"top": 3 * GROWTH, "ticks": 3.0, "status": "complete", "message": ""}
    assert study.evaluate(x_start=np.float64(2.0))["top"] == 2 * GROWTH


def test_a_table_of_points_is_evaluated(study: Study) -> None:
    table = study.evaluate(pd.DataFrame({"x_start": [1.0, 2.0, 5.0]}, index=[7, 8, 9]), offset=0.0)
    assert table.index.tolist() == [7, 8, 9]
    assert table["top"].tolist() == [GROWTH, 2 * GROWTH, 5 * GROWTH]


def test_a_point_that_fails_has_nan(study: Study) -> None:
    found = study.evaluate({"offset": OVERFLOW})
    assert np.isnan(found["top"])
    assert found["status"] == "failed"
    assert found["message"]


def test_points_of_several_variants_are_refused(loop: System) -> None:
    study = Study({"a": loop, "b": loop}, "max(plant.x)")
    with pytest.raises(StudyError, match="several systems"):
        study.evaluate(pd.DataFrame({"system": ["a", "b"], "x_start": [1.0, 2.0]}))
    with pytest.raises(StudyError, match="no variant"):
        study.evaluate({"x_start": 1.0})
    assert study.evaluate(pd.DataFrame({"system": ["b"], "x_start": [2.0]}))["max(plant.x)"].tolist() == [2 * GROWTH]


def test_an_engine_is_closed_when_nobody_can_use_it_any_more(loop: System, monkeypatch: pytest.MonkeyPatch) -> None:
    closed = []

    class Closing(PlainEngine):
        def close(self) -> None:
            closed.append(True)

    monkeypatch.setattr(evaluator, "engine_for", Closing)
    study = Study(loop, "max(plant.x)")
    study.evaluate(x_start=1.0)
    study.evaluate(x_start=2.0)
    assert not closed
    del study
    gc.collect()
    assert closed == [True]


def test_an_optimizer_finds_the_least(study: Study) -> None:
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        lambda x: (study.evaluate(x_start=x)["top"] - 3 * GROWTH) ** 2, bounds=(0, 8), method="bounded"
    )
    # the bounded method ends within 1e-5 of the least, its default tolerance
    assert abs(found.x - 3.0) < 1e-4
