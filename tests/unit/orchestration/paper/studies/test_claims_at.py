"""The runs at a setting and the verdicts of the claims: the chain of bounds and limits, the bits, what needs what."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from orchestration.errors import SimulationError
from orchestration.paper.calibrate import laboratory, noise_bound
from orchestration.paper.calibrations import EACH_JOINT, FIRST, LARGEST, NORM
from orchestration.paper.laboratory import Job, Laboratory
from orchestration.paper.measure import ESTIMATE, RECORDED, at_ticks, largest_norm
from orchestration.paper.scenarios import UNSATURATED
from orchestration.paper.studies import measured
from orchestration.paper.studies.claims_at import COSTLY, QUESTIONS, RUNS, Evidence, evidence_at, verdicts
from orchestration.paper.studies.native_runs import NativeLaboratory
from orchestration.paper.studies.raw_rows import Row
from orchestration.paper.studies.runs_at import FIXED_MASS, FREE, row_at
from orchestration.paper.troubles import HEALTHY, TROUBLES
from orchestration.results.result import Result

QUICK = {**FIRST.values, "sample_time": 5e-5, "noise_hold": 1.7e-4}
GOOD = {
    "m2_settled": 0.1,
    "m2_at_contact": 0.01,
    "m2_in_contact": 0.1,
    "m2_fluctuation": 0.06,
    "m2_recovery": 0.01,
    "torque_1": 100.0,
    "torque_2": 50.0,
    "e_start": 1e-3,
    "e_free": 1e-5,
    "e_contact": 1e-4,
    "e_contact_rms": 1e-5,
    "e_max": 1e-3,
    "force_error": 10.0,
    "end": 1e-5,
    "force_peak": 600.0,
}
WORSE = {**GOOD, "e_contact": 1.05e-4, "force_error": 10.5}  # larger, and not clearly so
LESS_TORQUE = {**WORSE, "torque_1": 60.0, "torque_2": 30.0}
RUN_BY_RUN: Mapping[str, Mapping[str, float]] = {
    "fig2": {"e_max": 1e-4, "force_peak": 500.0, "force_steady": 40.0, "end": 1e-5, "at_a": 1e-3, "at_b": 1e-3}
    | {"phases": 2.0, "touching": 0.8, "x_t_before": 1e-6, "x_t_later": 1e-2},
    "fig4": {"e_max": 1e-2, "force_peak": 600.0, "force_steady": 40.0},
    "fig5": {**GOOD, "x_t_before": 1e-6, "x_t_end": 1e-4, "V_growth": 0.9, "case_c": 3.0, "gamma_ratio": 0.5},
    "fig6": {**WORSE, "V_excess": 1e-3, "V_rises_outside": 0.0, "V_largest": 0.5, "V_end": 1e-3},
    "fig7": LESS_TORQUE,
    FREE: LESS_TORQUE,
    measured.NO_CORIOLIS: LESS_TORQUE,
    "spong-ortega": GOOD,
    FIXED_MASS: {"e_start": 3e-3},
    **{measured.at_divisor(name, n): {"e_contact": 2e-4} for name in ("fig5", "fig7") for n in measured.DIVISORS},
    **{
        measured.at_gain(start, gain): {"rise": 0.0, "rms_ratio": 0.5, "e_ratio": 0.5, "largest": 1 / gain}
        for start in measured.STARTS
        for gain in measured.K_D_GRID
    },
    **{
        measured.in_trouble(algorithm, trouble): {"e_later": 1e-3 if trouble == HEALTHY else 2e-3, "e_last": 1e-4}
        for algorithm in (1, 2)
        for trouble in TROUBLES
    },
}


COSTLY_NUMBERS = {
    name
    for name in measured.UNITS
    if name.startswith(("K_d", "algorithm", measured.NO_CORIOLIS)) or "/" in name or ".V_" in name
} - {"fig5.V_growth", "fig5.V_rise"}


def numbers(**changed: Mapping[str, float]) -> dict[str, float]:
    """The numbers of a setting at which all claims hold, with those of some runs changed."""
    runs = {name: {**values, **changed.get(name.replace("-", "_"), {})} for name, values in RUN_BY_RUN.items()}
    found = {f"{run}.{name}": value for run, values in runs.items() for name, value in values.items()}
    return {**found, "torque_limit_1": 75.0, "torque_limit_2": 37.5}


def evidence(given: Mapping[str, float]) -> Evidence:
    return Evidence([Row(given, {})])


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


@pytest.mark.parametrize(
    "job",
    [Job("fig5", {"sensor.seed": 3, "sensor.noise_period": 6e-5}), Job("fig7", {}, 1e-4), Job("fig7", {}, 1e-4, 1.0)],
)
def test_native_runs_have_the_bits_of_the_master(masters: Laboratory, natives: NativeLaboratory, job: Job) -> None:
    expected, found = (lab.run(job, (*RECORDED, ESTIMATE)) for lab in (masters, natives))
    assert found.names == expected.names
    assert found.rows.tobytes() == expected.rows.tobytes()
    assert found.at_ticks(ESTIMATE).tobytes() == expected.at_ticks(ESTIMATE).tobytes()


def test_numbers_of_runs_feed_later_runs(natives: NativeLaboratory) -> None:
    watched = Watched(natives)
    row = row_at(watched, QUICK, 5)
    noisy = [job for job in watched.jobs if job.scenario in RUNS and "sensor.seed" in job.changes]
    silent, fig5, fig6, fig7, *_ = noisy
    assert [job.scenario for job in watched.jobs[:2]] == ["fig2", "fig4"]
    assert {job.sample_time for job in watched.jobs[:2]} == {None}, "they are sampled as their scenarios are"
    assert {job.sample_time for job in watched.jobs[2:]} == {5e-5}
    assert silent.changes["sensor.noise_bound"] == 0
    bound = fig5.changes["sensor.noise_bound"]
    assert bound == QUICK["noise_share"] * row.numbers["peak"] == fig6.changes["controller.noise_bound"]
    assert fig5.changes["sensor.noise_std"] == bound / 3
    assert fig5.changes["sensor.noise_period"] == 3 * 5e-5  # 3.4 ticks, rounded
    assert fig5.changes["sensor.seed"] == fig7.changes["sensor.seed"] == 5
    for i in (1, 2):
        limit = 0.75 * row.numbers[f"fig5.torque_{i}"]
        assert fig6.changes[f"actuator.tau_max[{i}]"] == fig7.changes[f"actuator.tau_max[{i}]"] == limit
        assert row.numbers[f"torque_limit_{i}"] == limit
    assert UNSATURATED.items() <= fig5.changes.items()
    assert not row.failures
    assert set(row.numbers) == set(measured.UNITS) - COSTLY_NUMBERS


def test_costly_numbers_are_measured_if_asked_for(natives: NativeLaboratory) -> None:
    found = row_at(natives, {**QUICK, "sample_time": 1e-4, "noise_hold": 1e-4}, 5, costly=True).numbers
    assert set(found) >= COSTLY_NUMBERS
    assert set(found) <= set(measured.UNITS)


def test_fig7_is_run_without_limits_only_where_it_reaches_them(natives: NativeLaboratory) -> None:
    free, watched = row_at(natives, QUICK, 5), Watched(natives)
    assert free.numbers["fig7.saturated_1"] == free.numbers["fig7.saturated_2"] == 0.0
    assert free.numbers[f"{FREE}.e_max"] == free.numbers["fig7.e_max"]
    low = {"actuator.tau_max[1]": 100.0, "actuator.tau_max[2]": 100.0}
    row = row_at(watched, QUICK, 5, low)
    assert row.numbers["fig7.saturated_1"] > 0
    assert row.numbers[f"{FREE}.e_max"] == free.numbers["fig7.e_max"] != row.numbers["fig7.e_max"]


def test_later_seeds_have_the_limits_of_the_first(natives: NativeLaboratory) -> None:
    watched = Watched(natives)
    found = evidence_at(watched, QUICK, [5, 6])
    limits = {job.changes["actuator.tau_max[1]"] for job in watched.jobs if job.scenario == "fig6"}
    assert limits == {found.torque_limits[0]} == {0.75 * found.noise["fig5"][0].torque[0]}
    assert [len(found.noise[name]) for name in RUNS] == [2] * len(RUNS)


def test_bound_at_the_chosen_values_is_that_of_the_calibration(masters: Laboratory, natives: NativeLaboratory) -> None:
    from orchestration.paper.studies.open_values import CHOSEN

    watched = Watched(natives, {"fig6": "no", "fig7": "no", "spong-ortega": "no"})
    found = row_at(watched, CHOSEN, 1)
    assert found.numbers["noise_bound"] == noise_bound(masters)


@pytest.mark.parametrize("reading", [EACH_JOINT, LARGEST, NORM])
def test_readings_of_the_largest_torque(natives: NativeLaboratory, reading: float) -> None:
    watched = Watched(natives)
    found = row_at(watched, {**QUICK, "torque_reading": reading}, 1).numbers
    fig5 = next(job for job in watched.jobs if job.scenario == "fig5" and job.changes["sensor.noise_bound"])
    torque = at_ticks(natives.run(fig5, RECORDED), "controller.tau_cmd")
    largest = np.abs(torque).max(axis=0)
    allowed = {EACH_JOINT: largest, LARGEST: [largest.max()] * 2, NORM: [largest_norm(torque)] * 2}[reading]
    assert [found["torque_limit_1"], found["torque_limit_2"]] == [0.75 * limit for limit in allowed]


def test_everything_holds_where_all_numbers_are_good() -> None:
    found = verdicts(evidence(numbers()), costly=True)
    assert tuple(found) == QUESTIONS
    assert [name for name, holds in found.items() if not holds] == ["C7 clearly", "C10 clearly"]
    assert set(QUESTIONS) - set(verdicts(evidence(numbers()))) == set(COSTLY)


@pytest.mark.parametrize(
    ("run", "changed", "fail"),
    [
        ("fig2", {"x_t_later": 1e-5}, {"C1"}),
        ("fig2", {"at_b": 0.06}, {"C2"}),
        ("fig4", {"e_max": 9e-4}, {"C3a"}),
        ("fig4", {"force_peak": 540.0}, {"C3b"}),
        ("fig6", {"m2_settled": 0.5}, {"C4"}),
        ("fig6", {"m2_fluctuation": 0.04}, {"C5"}),
        ("fig6", {"m2_recovery": 0.2}, {"C6"}),
        ("fig6", {"force_error": 9.9}, {"C7"}),
        ("fig7", {"torque_2": 38.0}, {"C8"}),
        ("fixed_mass", {"e_start": 1.9e-3}, {"C9"}),
        ("fig7", {"e_contact": 1e-4}, {"C10"}),
        ("fig5/10", {"e_contact": 4e-4}, {"C12b"}),
        ("fig7_no_coriolis", {"e_contact": 4e-4}, {"C12c"}),
        ("fig5", {"x_t_end": 2e-3}, {"C13"}),
        ("fig5", {"V_growth": 1.1}, {"C14a"}),
        ("K_d 300 true", {"rms_ratio": 1.1}, {"C14b"}),
        ("K_d 300 wrong", {"largest": 1.0}, {"C14c"}),
        ("spong_ortega", {"end": 2e-3}, {"C16"}),
        ("fig5", {"gamma_ratio": 1.1}, {"C17"}),
        ("algorithm 2 stuck", {"e_later": 0.06}, {"C19a"}),
        ("algorithm 1 spike", {"e_last": np.inf}, {"C19b"}),
        ("fig6", {"V_rises_outside": np.nan}, {"C20"}),
        ("fig7_free", {"e_free": 2e-3}, {"accurate 2"}),
    ],
)
def test_each_claim_fails_on_its_own_number(run: str, changed: Mapping[str, float], fail: set[str]) -> None:
    found = verdicts(evidence(numbers(**{run: changed})), costly=True)
    assert {name for name, holds in found.items() if not holds} == fail | {"C7 clearly", "C10 clearly"}


@pytest.mark.parametrize(
    ("broken", "fail"),
    [
        ("fig5", {"C4", "C5", "C6", "C7", "C8", "C10", "C12b", "C13", "C14a", "C17", "stable 1", "accurate 1"}),
        ("fig6", {"C4", "C5", "C6", "C7", "C20"}),
        ("fig7", {"C4", "C5", "C6", "C8", "C9", "C10", "C12b", "C12c"}),
        (measured.NO_CORIOLIS, {"C12c"}),
        (measured.in_trouble(1, HEALTHY), {"C19b"}),
        (FREE, {"stable 2", "accurate 2"}),
        ("spong-ortega", {"C16"}),
        ("fig2", {"C1", "C2", "C3a", "C3b"}),
        (FIXED_MASS, {"C9"}),
    ],
)
def test_a_run_that_failed_fails_what_needs_it(broken: str, fail: set[str]) -> None:
    left = {name: value for name, value in numbers().items() if not name.startswith(f"{broken}.")}
    found = verdicts(evidence(left), costly=True)
    assert {name for name, holds in found.items() if not holds} == fail | {"C7 clearly", "C10 clearly"}


@pytest.mark.parametrize(("ratio", "clearly"), [(1.09, False), (1.11, True)])
def test_clearly_larger_errors(ratio: float, clearly: bool) -> None:
    larger = {name: ratio * GOOD[name] for name in ("e_contact", "force_error")}
    found = verdicts(evidence(numbers(fig6=larger, fig7=larger)))
    assert (found["C7 clearly"], found["C10 clearly"]) == (clearly, clearly)


def test_clear_differences_are_no_more_than_the_claim() -> None:
    """Errors that are much larger are clearly larger, and yet not "slightly larger"."""
    found = verdicts(evidence(numbers(fig7={"e_contact": 100 * GOOD["e_contact"], "force_error": 99.0})))
    assert not found["C10"]
    assert not found["C10 clearly"]


def test_failures_are_kept_with_their_sentences(natives: NativeLaboratory) -> None:
    found = row_at(Watched(natives, {"fig5": "It diverged."}), QUICK, 1)
    assert found.failures == {"silent": "It diverged."}
    assert not {name for name in found.numbers if name.startswith("fig7")}, (
        "without a bound of the noise nothing is run"
    )
    late = row_at(Watched(natives, {"fig7": "It diverged."}), QUICK, 1)
    assert set(late.failures) == {"fig7", FREE, FIXED_MASS}


def test_a_tip_that_never_touches_the_wall_is_a_failure(natives: NativeLaboratory) -> None:
    found = row_at(natives, {**QUICK, "wall_offset": 1.6}, 1)
    assert "never touched the wall" in found.failures["fig2"]
    assert not any(verdicts(Evidence([found])).values())


def test_a_seed_that_failed_fails_them_all() -> None:
    rows = [Row(numbers(), {}), Row(numbers(fig6={"e_max": np.nan}), {})]
    found = Evidence(rows)
    assert "fig6" not in found.noise
    assert len(replace(found, rows=rows[:1]).noise["fig6"]) == 1
