"""Evidence for the runs with a sensor that fails and with a payload beyond the sensor, and for the judgement of C19."""

import numpy as np
import pytest

from orchestration.paper.built_fmus import fmus
from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.sensor_failure import P_MIN, judge
from orchestration.paper.laboratory import Job, Laboratory
from orchestration.paper.numbers import PAYLOAD, PERIOD, TRUE_M2
from orchestration.paper.ready import scenario
from orchestration.paper.scenarios import WITH_FAILURE, WITH_PAYLOAD
from orchestration.paper.troubles import HEALTHY, Errors

CRITERIA = (limits.FAILURE_GROWTH, limits.FAILURE_ERROR, limits.FAILURE_END)
REPORT = ("plant.F_ext[1]", "controller.p_hat[2]", "sensor.F_hat[1]", "sensor.failed", "controller.e[1]")


@pytest.fixture(scope="module")
def laboratory() -> Laboratory:
    """A laboratory for the runs with troubles."""
    runs = (*WITH_FAILURE.values(), *WITH_PAYLOAD.values())
    return Laboratory(fmus(sorted({identifier for run in runs for identifier in run.models.values()})))


def met(errors: dict[str, list[Errors]]) -> list[bool]:
    """Which of the criteria of C19 are met."""
    found = judge(errors).values
    return [criterion.met(found[criterion]) for criterion in CRITERIA]


@pytest.mark.parametrize(
    ("troubled", "expected"),
    [
        ([Errors(4e-3, 1e-6), Errors(49e-3, 1e-3)], [True, True, True]),
        ([Errors(4e-3, 1e-6), Errors(1e-4, 1e-6)], [False, True, True]),  # one of two grows
        ([Errors(4e-3, 1e-6), Errors(51e-3, 1e-6)], [True, False, True]),
        ([Errors(4e-3, 1e-6), Errors(4e-3, 2e-3)], [True, True, False]),
        ([Errors(4e-3, 1e-6), Errors(np.inf, np.inf)], [True, False, False]),
    ],
)
def test_c19_asks_for_errors_that_grow_stay_bounded_and_vanish(troubled: list[Errors], expected: list[bool]) -> None:
    assert met({HEALTHY: [Errors(1e-3, 1e-6)] * 2, "stuck": troubled}) == expected


def test_c19_tells_of_runs_that_end_with_an_error() -> None:
    ended = Errors(np.inf, np.inf)
    errors = {HEALTHY: [Errors(1e-3, 1e-6, 0.9)] * 2, "spike": [Errors(4e-3, 1e-6, -2.0), ended]}
    assert judge(errors).measured.endswith(
        "healthy 1 mm, 0.001 mm at the end, m2_hat >= 0.9 kg;"
        " spike 4 mm, 0.001 mm at the end, m2_hat falls to the negative mass of -2 kg, 1 of 2 runs end with an error"
    )


def test_the_sensor_fails_in_the_midst_of_the_contact(laboratory: Laboratory) -> None:
    result = laboratory.run(Job("sensor-dropout", stop_time=PERIOD / 2 + 0.06), REPORT)
    failed = result["sensor.failed"] > 0
    times = result.time[failed]
    # Outputs of a tick show from the end of its step on.
    step = result.time[1]
    assert times[0] == pytest.approx(PERIOD / 2, abs=1.5 * step)
    assert times[-1] == pytest.approx(PERIOD / 2 + 0.05, abs=1.5 * step)
    assert (result["sensor.F_hat[1]"][failed] == 0).all()
    assert np.abs(result["plant.F_ext[1]"][failed]).max() > 10  # N


def test_a_spike_drives_algorithm_1_to_a_negative_mass_unless_the_estimate_is_bounded(laboratory: Laboratory) -> None:
    free = laboratory.run(Job("sensor-spike-craig"), REPORT)
    projected = {"controller.projection": 1.0, "controller.p_min[2]": P_MIN}
    bounded = laboratory.run(Job("sensor-spike-craig", projected), REPORT)
    assert free["controller.p_hat[2]"].min() < 0
    assert bounded["controller.p_hat[2]"].min() == P_MIN


def test_the_payload_s_force_takes_the_place_of_the_wall_s() -> None:
    system = scenario("fig7-wrist-payload")
    assert system.sources["sensor.F_ext[1]"] == "plant.F_wrist[1]"
    assert system.sources["sensor.F_ext[2]"] == "plant.F_wrist[2]"
    assert len(system.connections) == len(scenario("fig7").connections)


@pytest.mark.parametrize("name", WITH_PAYLOAD)
def test_both_algorithms_learn_the_mass_before_the_sensor(laboratory: Laboratory, name: str) -> None:
    result = laboratory.run(Job(name), ["controller.p_hat[2]"])
    # F_hat carries the payload in both laws, so that the equations of the error are those of an arm without it. As
    # without a payload, the estimate is within 1e-4 kg at the end.
    assert result["controller.p_hat[2]"][-1] == pytest.approx(TRUE_M2 - PAYLOAD, abs=1e-4)
