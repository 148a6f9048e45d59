"""Predicted stability over the factors of a study: the verdicts of its systems, one by one."""

import math

import numpy as np
import pytest
import xarray as xr

from orchestration import Study, plot_table, scenario
from orchestration.analysis.stability.verdict import judged

SAMPLE_TIMES = [1e-3, 7e-3]  # s; the shorter one is stable


@pytest.fixture(scope="module")
def study() -> Study:
    plan = Study(scenario("fig2"), "max_e", stop_time=0.1, algorithm="jacobi")
    return plan.grid({"sample_time": SAMPLE_TIMES, "controller.K": [4000.0, -1e9]})  # N/m; K must be positive


def predicted(study: Study, at: float = 0.0) -> xr.Dataset:
    table = study.stability(at)
    assert isinstance(table, xr.Dataset)
    return table


def test_growth_rates_are_those_of_the_systems(study: Study) -> None:
    table = predicted(study)
    for sample_time in SAMPLE_TIMES:
        verdict = scenario("fig2").with_sample_time(sample_time).stability(algorithm="jacobi")
        found = float(table["growth_rate"].sel(sample_time=sample_time, K=4000.0))
        assert (found > 0) is not verdict.stable
        assert found == (min(verdict.growth_rate, 0.0) if verdict.stable else verdict.growth_rate)
    assert table["growth_rate"].attrs == {"units": "1/s"}
    assert table["sample_time"].attrs["units"] == "s"
    assert list(table.data_vars) == ["growth_rate", "status", "message"]


def test_a_system_that_cannot_be_judged_is_a_row_with_its_sentence(study: Study) -> None:
    table = predicted(study)
    assert (table["status"].sel(K=-1e9) == "failed").all()
    assert np.isnan(table["growth_rate"].sel(K=-1e9)).all()
    assert all("controller" in text for text in table["message"].sel(K=-1e9).values)
    assert (table["status"].sel(K=4000.0) == "complete").all()


def test_the_time_of_the_verdict_counts() -> None:
    system = scenario("fig2")
    plan = Study(system, "max_e").grid({"plant.K_f": [1e5, 1e6]})  # N/m; the wall is touched at 1 s only
    free, touching = (predicted(plan, at)["growth_rate"].values for at in (0.0, 1.0))
    assert free[0] == free[1]
    assert touching[0] != touching[1]
    point = judged(system, at=1.0)
    assert touching[0] == min(0.0, math.log(point.radius) / point.step)


def test_a_picture_shows_the_predicted_border(study: Study) -> None:
    growth = predicted(study)
    figure = plot_table(growth, "growth_rate", stability=growth, limit=0.0)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[-1] == "predicted border of stability (rings: unstable)"
    rings = next(line for line in figure.axes[0].lines if line.get_marker() == "o")
    assert np.size(rings.get_xdata()) == int((~(growth["growth_rate"] <= 0)).sum())
