"""The runs at a setting: the chain of bounds and limits, the bits of single runs, the verdicts of the claims."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from orchestration.errors import SimulationError
from orchestration.paper.calibrate import laboratory, noise_bound
from orchestration.paper.calibrations import EACH_JOINT, LARGEST, NORM
from orchestration.paper.claims import criteria
from orchestration.paper.laboratory import Job, Laboratory
from orchestration.paper.measure import ESTIMATE, RECORDED, Summary
from orchestration.paper.numbers import NOISE_SHARE
from orchestration.paper.scenarios import UNSATURATED
from orchestration.paper.studies.claims_at import QUESTIONS, SCENARIOS, Evidence, evidence_at, verdicts
from orchestration.paper.studies.native_runs import NativeLaboratory
from orchestration.paper.studies.open_values import CHOSEN
from orchestration.results.result import Result

QUICK = {**CHOSEN, "sample_time": 5e-5, "noise_hold": 1.7e-4, "torque_reading": EACH_JOINT}
GOOD = Summary(
    m2_settled=0.1,
    m2_at_contact=0.01,
    m2_in_contact=0.1,
    m2_fluctuation=0.15,
    m2_recovery=0.01,
    torque=np.array([100.0, 50.0]),
    e_start=1e-3,
    e_free=1e-5,
    e_contact=1e-4,
    e_contact_rms=1e-5,
    e_max=1e-3,
    force_error=10.0,
    end=1e-5,
)
WORSE = replace(GOOD, e_contact=1.05e-4, force_error=10.5)  # larger, and not clearly so
LESS_TORQUE = replace(WORSE, torque=np.array([60.0, 30.0]))
ALL_HOLD = Evidence(
    {"fig5": [GOOD], "fig6": [WORSE], "fig7": [LESS_TORQUE], "spong-ortega": [GOOD]},
    np.array([75.0, 37.5]),
    {criteria.TIRT_BEFORE_CONTACT: 1e-6, criteria.TIRT_AT_END: 1e-4},
)


@dataclass(frozen=True)
class Watched:
    """A laboratory that keeps its jobs, and fails where it is told."""

    laboratory: NativeLaboratory
    fail: Mapping[str, str] = field(default_factory=dict)
    jobs: list[Job] = field(default_factory=list)

    def run(self, job: Job, record: Collection[str]) -> Result:
        """Run one job, or fail."""
        self.jobs.append(job)
        if job.scenario in self.fail:
            raise SimulationError(self.fail[job.scenario])
        return self.laboratory.run(job, record)


@pytest.fixture(scope="module")
def masters() -> Laboratory:
    return laboratory()


@pytest.fixture(scope="module")
def natives(masters: Laboratory) -> NativeLaboratory:
    return NativeLaboratory(masters.fmus)


@pytest.mark.parametrize("job", [Job("fig5", {"sensor.seed": 3, "sensor.noise_period": 6e-5}), Job("fig7", {}, 1e-4)])
def test_native_runs_have_the_bits_of_the_master(masters: Laboratory, natives: NativeLaboratory, job: Job) -> None:
    expected, found = (lab.run(job, (*RECORDED, ESTIMATE)) for lab in (masters, natives))
    assert found.names == expected.names
    assert found.rows.tobytes() == expected.rows.tobytes()
    assert found.at_ticks(ESTIMATE).tobytes() == expected.at_ticks(ESTIMATE).tobytes()


def test_numbers_of_runs_feed_later_runs(natives: NativeLaboratory) -> None:
    watched = Watched(natives)
    found = evidence_at(watched, QUICK, [5, 6])
    names = [job.scenario for job in watched.jobs]
    assert names == ["fig5", "ideal", *(name for name in SCENARIOS for _ in range(2))]
    jobs = dict(zip(names, watched.jobs, strict=True))
    assert {job.sample_time for job in watched.jobs} == {5e-5}
    assert watched.jobs[0].changes["sensor.noise_bound"] == 0
    bound = jobs["fig5"].changes["sensor.noise_bound"]
    assert bound == jobs["fig7"].changes["sensor.noise_bound"] == jobs["fig6"].changes["controller.noise_bound"]
    assert jobs["fig5"].changes["sensor.noise_std"] == bound / QUICK["noise_ratio"]
    assert jobs["fig5"].changes["sensor.noise_period"] == 3 * 5e-5  # 3.4 ticks, rounded
    assert [job.changes["sensor.seed"] for job in watched.jobs if job.scenario == "fig6"] == [5, 6]
    largest = found.noise["fig5"][0].torque
    for name in ("fig6", "fig7"):
        assert [jobs[name].changes[f"actuator.tau_max[{i}]"] for i in (1, 2)] == [*(0.75 * largest)]
    for name in ("fig5", "spong-ortega"):
        assert UNSATURATED.items() <= jobs[name].changes.items()
    assert set(found.noise) == set(SCENARIOS)
    assert not found.failures


def test_bound_at_the_chosen_values_is_that_of_the_calibration(masters: Laboratory, natives: NativeLaboratory) -> None:
    watched = Watched(natives, {"fig6": "no", "fig7": "no", "spong-ortega": "no"})
    evidence_at(watched, CHOSEN, [1])
    assert CHOSEN["noise_share"] == NOISE_SHARE
    assert watched.jobs[2].changes["sensor.noise_bound"] == noise_bound(masters)


@pytest.mark.parametrize("reading", [LARGEST, NORM])
def test_one_limit_for_both_joints(natives: NativeLaboratory, reading: float) -> None:
    setting = {**QUICK, "torque_reading": reading}
    found = evidence_at(natives, setting, [1])
    largest = found.noise["fig5"][0].torque
    assert found.torque_limits is not None
    one, two = found.torque_limits
    assert one == two
    if reading == LARGEST:
        assert one == 0.75 * largest.max()
    else:
        assert 0.75 * largest.max() <= one <= 0.75 * np.hypot(*largest)


def test_verdicts_at_the_chosen_values_are_those_of_the_claims(natives: NativeLaboratory) -> None:
    """With one seed; docs/claims.md has the same ones over 30 seeds."""
    found = verdicts(evidence_at(natives, CHOSEN, [1]))
    assert {claim for claim in QUESTIONS[:9] if found[claim]} == {"C4", "C5", "C6", "C8", "C9", "C16"}


@pytest.mark.parametrize(
    ("broken", "fail"),
    [
        ("fig5", {"C4", "C5", "C6", "C7", "C8", "C10", "C13", "accurate 1"}),
        ("fig6", {"C4", "C5", "C6", "C7"}),
        ("fig7", {"C4", "C5", "C6", "C8", "C9", "C10", "accurate 2"}),
        ("spong-ortega", {"C16"}),
    ],
)
def test_a_run_that_failed_fails_what_needs_it(broken: str, fail: set[str]) -> None:
    assert [name for name, holds in verdicts(ALL_HOLD).items() if not holds] == ["C7 clearly", "C10 clearly"]
    noise = {name: summaries for name, summaries in ALL_HOLD.noise.items() if name != broken}
    found = verdicts(replace(ALL_HOLD, noise=noise))
    assert {name for name, holds in found.items() if not holds} == fail | {"C7 clearly", "C10 clearly"}


@pytest.mark.parametrize(("ratio", "clearly"), [(1.09, False), (1.11, True)])
def test_clearly_larger_errors(ratio: float, clearly: bool) -> None:
    larger = replace(LESS_TORQUE, e_contact=ratio * GOOD.e_contact, force_error=ratio * GOOD.force_error)
    found = verdicts(replace(ALL_HOLD, noise={**ALL_HOLD.noise, "fig6": [larger], "fig7": [larger]}))
    assert (found["C7 clearly"], found["C10 clearly"]) == (clearly, clearly)


def test_clear_differences_are_no_more_than_the_claim() -> None:
    """Errors that are much larger are clearly larger, and yet not "slightly larger"."""
    much = replace(LESS_TORQUE, e_contact=100 * GOOD.e_contact)
    found = verdicts(replace(ALL_HOLD, noise={**ALL_HOLD.noise, "fig7": [replace(much, force_error=99.0)]}))
    assert not found["C10"]
    assert not found["C10 clearly"]


def test_failures_are_kept_with_their_sentences(natives: NativeLaboratory) -> None:
    found = evidence_at(Watched(natives, {"fig5": "It diverged."}), QUICK, [1])
    assert found.failures == {"fig5": "It diverged."}
    assert not found.noise, "without a bound of the noise nothing can be run"
    late = Watched(natives, {"fig7": "It diverged."})
    assert evidence_at(late, QUICK, [1]).failures == {"fig7": "It diverged."}


def test_a_tip_that_never_touches_the_wall_is_a_failure(natives: NativeLaboratory) -> None:
    found = evidence_at(natives, {**QUICK, "wall_offset": 1.6}, [1])
    assert "never touched the wall" in found.failures["fig5"]
    assert not any(verdicts(found).values())
