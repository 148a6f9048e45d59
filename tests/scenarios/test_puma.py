"""Evidence for the paper's task with a PUMA 560: constants follow from runs; docs/puma-claims.md says what holds."""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from orchestration import Result
from orchestration.paper import evidence as made
from orchestration.paper import spatial_numbers as space
from orchestration.paper.built_fmus import fmus
from orchestration.paper.cases import FIGURES, PUMA_CASE
from orchestration.paper.claims.claim import Claim
from orchestration.paper.claims.evaluation import IN_SPACE, QUESTIONS
from orchestration.paper.evidence import Evidence
from orchestration.paper.laboratory import Job, Laboratory
from orchestration.paper.measure import at_ticks, contact, summarize
from orchestration.paper.numbers import NOISE_SHARE, TORQUE_SHARE
from orchestration.paper.spatial_scenarios import SPATIAL

PAGE = (Path(__file__).parents[2] / "docs" / "puma-claims.md").read_text(encoding="utf-8")
OF_ONE_RUN = ("C1", "C2", "C3a", "C3b", "C13", "C17")
"""Claims whose numbers need one run of each figure, and no function of the C library."""
OF_SEEDS = ("C4", "C5", "C6", "C8", "C9", "C10", "C16")
"""Claims whose verdicts two seeds decide; C7 compares errors that differ by chance."""
EQUATIONS = ("C15", "C18")
ROUNDED = 0.005 + 1e-9  # of a number that is kept with two digits behind the point


@pytest.fixture(scope="module")
def laboratory() -> Laboratory:
    """The FMUs of the PUMA."""
    return Laboratory(fmus(sorted({model for scenario in SPATIAL.values() for model in scenario.models.values()})))


@pytest.fixture(scope="module")
def evidence(laboratory: Laboratory) -> Evidence:
    """The runs of the figures."""
    runs = {name: laboratory.run(Job(name)) for name in dict.fromkeys(PUMA_CASE.runs[figure] for figure in FIGURES)}
    return Evidence(laboratory, {figure: runs[PUMA_CASE.runs[figure]] for figure in FIGURES}, PUMA_CASE)


def answer(name: str, evidence: Evidence) -> Claim:
    (question,) = (question for question in QUESTIONS if question.id == name)
    return question.answer(evidence)


def verdicts() -> Mapping[str, str]:
    return dict(re.findall(r"^## (C\d+[a-c]?): (.+)$", PAGE, re.MULTILINE))


def test_the_page_has_all_claims() -> None:
    assert tuple(verdicts()) == tuple(IN_SPACE)
    assert f"{sum(verdict == 'holds' for verdict in verdicts().values())} of {len(IN_SPACE)} claims hold." in PAGE


@pytest.mark.parametrize("name", OF_ONE_RUN)
def test_the_page_says_what_is_measured(name: str, evidence: Evidence) -> None:
    claim = answer(name, evidence)
    assert claim.verdict == verdicts()[name]
    assert f"- Measured: {claim.measured}.\n" in PAGE


@pytest.mark.parametrize("name", EQUATIONS)
def test_equations_hold_for_six_joints(name: str, evidence: Evidence) -> None:
    assert answer(name, evidence).verdict == verdicts()[name] == "holds"


@pytest.mark.parametrize("name", OF_SEEDS)
def test_two_seeds_agree_with_thirty(name: str, evidence: Evidence, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(made, "SEEDS", (1, 2))
    assert answer(name, evidence).verdict == verdicts()[name]


def test_the_bound_of_the_noise_is_a_share_of_the_peak(laboratory: Laboratory) -> None:
    quiet = {f"{name}.noise_bound": 0.0 for name in ("sensor", "controller")} | {"sensor.noise_std": 0.0}
    result = laboratory.run(Job("puma-craig", quiet), PUMA_CASE.columns("plant.F_ext", "plant.x"))
    assert space.NOISE_BOUND == pytest.approx(NOISE_SHARE * contact(result).peak, abs=ROUNDED)


def test_torque_limits_are_a_share_of_the_largest_torques(evidence: Evidence) -> None:
    largest = np.abs(at_ticks(evidence.results["fig5"], "controller.tau_cmd")).max(axis=0)
    assert np.array(space.TORQUE_LIMITS) == pytest.approx(TORQUE_SHARE * largest, abs=ROUNDED)
    assert (largest < space.EFFORT).all(), "a PUMA 560 has no such motors"


def test_a_longer_period_lets_f_c_chatter(laboratory: Laboratory, evidence: Evidence) -> None:
    """The reason for the sampling period that the scenario states."""
    coarse = laboratory.run(Job("puma-craig", sample_time=1e-4), PUMA_CASE.by_joint("controller.tau_cmd"))
    fine = np.abs(at_ticks(evidence.results["fig5"], "controller.tau_cmd")).max(axis=0)
    ratio = np.abs(at_ticks(coarse, "controller.tau_cmd")).max(axis=0) / fine
    assert 1.7 < ratio.max() < 1.9


def test_the_payload_is_found_by_both_algorithms_and_believed_by_neither(evidence: Evidence) -> None:
    ideal: Result = evidence.results["fig2"]
    for figure in ("fig5", "fig6", "fig7"):
        result = evidence.results[figure]
        assert result[PUMA_CASE.shape.estimate][0] == space.BELIEVED_PAYLOAD
        summary = summarize(result, ideal["plant.F_ext"])
        assert abs(result[PUMA_CASE.shape.estimate][-1] - space.TRUE_PAYLOAD) < 0.002  # kg, 0.2 %
        assert summary.e_max < 0.5e-3  # m; 1 mm with the wrong payload
        assert summary.end < 0.02e-3
