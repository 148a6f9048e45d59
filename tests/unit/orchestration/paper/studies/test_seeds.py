"""Many seeds at a calibration: the runs are those of the scenarios, and verdicts are counted by hand."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from orchestration.paper.calibrations import CHOSEN_CALIBRATION, FIRST
from orchestration.paper.laboratory import Job
from orchestration.paper.measure import ESTIMATE, RECORDED, summarize
from orchestration.paper.studies.raw_rows import Row
from orchestration.paper.studies.robustness import laboratory
from orchestration.paper.studies.seeds import judged_over, over_seeds, read_seeds, write_seeds
from tests.unit.orchestration.paper.studies.test_claims_at import numbers

N = 2


def test_runs_are_those_of_the_scenarios(tmp_path: Path) -> None:
    lab = laboratory()
    with ThreadPoolExecutor(2) as pool:
        found = over_seeds(lab, FIRST, N, pool)
    summaries = {
        name: [
            summarize(lab.run(Job(f"{name}-first", {"sensor.seed": seed}), (*RECORDED, ESTIMATE)))
            for seed in range(1, N + 1)
        ]
        for name in ("fig5", "fig6")
    }
    ratios = [six.e_contact / five.e_contact for six, five in zip(summaries["fig6"], summaries["fig5"], strict=True)]
    assert found.effects["fig6/fig5 e_contact"].median == np.median(ratios)
    assert found.n == N
    write_seeds(tmp_path / "seeds.json", {"first": found})
    assert read_seeds(tmp_path / "seeds.json") == {"first": found}


def test_verdicts_are_counted() -> None:
    good = Row(numbers(), {})
    bad = Row(numbers(fig6={"m2_recovery": 0.2, "e_contact": 2e-4}), {})
    found = judged_over([good, bad, good, good, good, good], FIRST)
    assert found.yes["C6"] == 5
    assert not found.together["C6"], "the worst of all seeds counts"
    assert found.together["C4"]
    assert found.effects["fig6/fig5 e_contact"].median == pytest.approx(1.05)
    assert found.share("C6").value == pytest.approx(5 / 6)
    assert found.is_of(FIRST)
    assert not found.is_of(CHOSEN_CALIBRATION)


def test_seeds_that_fail_have_no_ratio() -> None:
    failed = Row({name: value for name, value in numbers().items() if not name.startswith("fig6.")}, {"fig6": "no"})
    found = judged_over([Row(numbers(), {}), failed], FIRST)
    assert found.effects["fig6/fig5 e_contact"].larger.n == 1
    assert found.yes["C7"] == 1
    assert not found.together["C7"]
