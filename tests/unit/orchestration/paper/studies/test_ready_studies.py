"""The ready studies: their runs are those of the claims, their tables are read as the claims are judged."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from orchestration import Study
from orchestration.paper.calibrations import CHOSEN_CALIBRATION
from orchestration.paper.claims import criteria
from orchestration.paper.evidence import GAMMA_GRID_FACTORS
from orchestration.paper.laboratory import Job
from orchestration.paper.studies.gain_map import accurate, gain_map
from orchestration.paper.studies.payload import payload_and_wall
from orchestration.paper.studies.ready import READY_STUDIES
from orchestration.paper.studies.robustness import laboratory
from orchestration.paper.studies.seeds import seeds_study
from orchestration.paper.studies.summary_measure import ideal_force, summary_measure, summary_of
from orchestration.paper.studies.tuning import LIMITS, cost, gains_study, tuned_by_optuna, tuned_by_scipy
from tests.unit.examples import failures


def grid(study: Study) -> xr.Dataset:
    """The table of a study of a grid."""
    table = study.run()
    assert isinstance(table, xr.Dataset)
    return table


@pytest.mark.parametrize(
    "function", [gain_map, gains_study, payload_and_wall, seeds_study, tuned_by_optuna, tuned_by_scipy]
)
def test_examples(function: Callable[..., Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert not failures(function.__name__, function, tmp_path, monkeypatch)


@pytest.mark.parametrize(("name", "good", "failed"), [("fig5", 6, 21), ("fig7", 41, 0)])
def test_map_of_seven_goes_over_two_decades(name: str, good: int, failed: int) -> None:
    """C11 asks the same of the part of these decades that both algorithms allow."""
    table = grid(gain_map(name))
    assert table["Psi"].to_numpy() == pytest.approx([100.0 * 10.0 ** (k / 3) for k in range(-3, 4)], rel=1e-12)
    if name == "fig5":
        assert table["Gamma"].to_numpy().tolist() == [
            factor * CHOSEN_CALIBRATION.values["Gamma_1"] for factor in GAMMA_GRID_FACTORS
        ]
    assert int(accurate(table).sum()) == good
    assert int((table["status"] == "failed").sum()) == failed


def test_rows_of_the_seeds_are_runs_of_the_scenario() -> None:
    lab = laboratory()
    table = grid(seeds_study("fig6", lab, 2))
    expected = summary_measure(ideal_force(lab)).function
    assert expected is not None
    columns = [
        f"{name}[{i}]" for name in ("controller.e", "controller.tau_cmd", "plant.F_ext", "plant.x") for i in (1, 2)
    ]
    row = {str(name): values.sel(seed=2) for name, values in table.items()}
    found = expected(lab.run(Job("fig6", {"sensor.seed": 2}), [*columns, "controller.p_hat[2]"]))
    assert isinstance(found, dict)
    assert {name: float(row[name]) for name in found} == found
    summary = summary_of(row)
    assert summary.torque.tolist() == [found["torque_1"], found["torque_2"]]
    assert summary.force_error == found["force_error"]


def test_cost_is_the_largest_ratio_and_infinite_for_failures() -> None:
    measured = {name: 0.5 * criterion.limit for name, criterion in LIMITS.items()}
    assert cost(measured) == 0.5
    assert cost({**measured, "e_free": 3e-4}) == pytest.approx(3)
    assert criteria.FREE_ERROR.limit == 1e-4
    assert cost({**measured, "m2_settled": np.nan}) == np.inf
    rows = {name: np.array([value, np.nan]) for name, value in measured.items()}
    np.testing.assert_array_equal(cost(rows), [0.5, np.inf])


def test_optimizers_repeat_their_runs() -> None:
    study = gains_study()
    once, again = (tuned_by_optuna(study, trials=5, seed=3) for _ in range(2))
    assert once == again
    found = study.evaluate(dict(once.gains))
    assert cost(found) == once.cost


@pytest.mark.parametrize("name", READY_STUDIES)
def test_ready_studies_can_be_made(name: str) -> None:
    ready = READY_STUDIES[name]
    study = ready.make()
    expected = 1000 if name.startswith("seeds-") else 2 * 100 if name == "payload" else 256 if "fig7" in name else 49
    assert len(study) == (25**2 if "fine" in name else expected)
    assert ready.summary
