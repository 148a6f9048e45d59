"""Evidence for what is said at the end of a campaign: counts, the commonest failure, extremes and their places."""

import json

import numpy as np
import pandas as pd
import pytest

from orchestration.cli.codes import ExitCode
from orchestration.cli.sweep_report import SweepReport, commonest

UNITS = {"peak_force": "N", "max_e": "m"}
FRAME = pd.DataFrame(
    {
        "K_f": [1e4, 1e5, 1e6, 1e6],
        "seed": [1, 1, 1, 2],
        "peak_force": [3.0, 2.0, np.nan, 9.5],
        "max_e": [np.nan] * 4,
        "status": ["complete", "complete", "failed", "complete"],
        "message": ["", "", "plant: q[1] is NaN at t = 0.1 s.", ""],
    }
)


@pytest.fixture
def report() -> SweepReport:
    report = SweepReport("fig5", "gauss-seidel")
    report.take(FRAME, ("K_f", "seed"), UNITS)
    return report


def test_the_object_has_counts_extremes_and_places(report: SweepReport) -> None:
    found = json.loads(report.json())
    assert (found["runs"], found["complete"], found["failed"], found["exit_code"]) == (4, 3, 1, 0)
    assert found["factors"] == ["K_f", "seed"]
    assert found["measures"]["peak_force"] == {
        "unit": "N",
        "min": 2.0,
        "min_at": {"K_f": 1e5, "seed": 1},
        "max": 9.5,
        "max_at": {"K_f": 1e6, "seed": 2},
    }
    assert found["measures"]["max_e"] == {"unit": "m", "min": None, "min_at": {}, "max": None, "max_at": {}}
    assert found["failures"] == [{"message": "plant: q[1] is NaN at t = 0.1 s.", "runs": 1}]


def test_sentences_and_table_say_the_same(report: SweepReport) -> None:
    report.from_store, report.rate, report.seconds = 2, 120.0, 0.0166
    assert report.sentences() == [
        "4 runs: 3 complete, 1 failed; 2 were in the store; 120 runs/s, 0.0166 s",
        "1 run failed: plant: q[1] is NaN at t = 0.1 s.",
    ]
    lines = [" ".join(line.split()) for line in report.table(120).splitlines()]
    assert "peak_force N min 2 K_f=100000, seed=1" in lines
    assert "peak_force N max 9.5 K_f=1e+06, seed=2" in lines


@pytest.mark.parametrize("columns", [30, 60])
def test_a_narrow_table_stays_whole(report: SweepReport, columns: int) -> None:
    text = report.table(columns)
    assert max(map(len, text.splitlines())) <= columns
    assert "K_f=1e+06," in text


def test_messages_that_differ_in_numbers_are_one_kind() -> None:
    messages = [f"plant: q[1] is {value} at t = {time} s." for value, time in (("1e300", 0.5), ("-2.5e+301", 1))]
    others = ["plant: q[2] is 1e300 at t = 0.5 s.", "controller: other."]
    assert commonest([*others, *messages]) == [
        {"message": messages[0], "runs": 2},
        *({"message": other, "runs": 1} for other in others),
    ]


def test_only_a_campaign_without_a_complete_run_failed(report: SweepReport) -> None:
    assert (report.status, report.exit_code) == ("complete", ExitCode.SUCCESS)
    report.take(FRAME.query("status == 'failed'"), ("K_f", "seed"), UNITS)
    assert (report.status, report.exit_code) == ("failed", ExitCode.FAILED)
    assert report.message == "1 run failed, and none is complete: plant: q[1] is NaN at t = 0.1 s."
