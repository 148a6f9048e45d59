"""The paper's task with position and angle of the tip: through a contact, with unknown masses, estimates converge.

Plant3RPose slides down the wall with its hand pointing into it. Everything is as in tests/scenarios/test_redundant.py,
but three task coordinates are those of a square Jacobian, so that the adaptive laws of the paper apply.
"""

from functools import cache

import numpy as np
import pytest

from fmus import start
from orchestration import Result, System
from orchestration.paper.built_fmus import fmus
from tests.scenarios.adaptive import norms, run

STEP, FINE = 1e-4, 2e-5  # s
HOGAN, CRAIG, SLOTINE_LI, SPONG_ORTEGA = (
    "HoganImpedance3RPose",
    "CraigAdaptiveImpedance3RPose",
    "SlotineLiAdaptiveImpedance3RPose",
    "SpongOrtegaAdaptiveImpedance3RPose",
)
MASSES = np.array(start.POSE_ARM.masses)  # kg
WRONG = {"controller.p_start[3]": 1.5}  # kg, of 0.5 kg: three times the payload with its hand
UNITS = {
    "trajectory": "VirtualTrajectoryPose",
    "sensor": "ForceSensorPose",
    "actuator": "Actuator3R",
    "plant": "Plant3RPose",
}


@cache
def result(controller: str, *changes: tuple[str, float], step: float = STEP, stop_time: float = 2.0) -> Result:
    """The wall task, by default one turn of 2 s."""
    models = {"trajectory": "", "sensor": "", "controller": controller} | UNITS
    files = fmus(models.values())
    system = System.connected_by_name(
        "pose", {name: files[model] for name, model in models.items()}, stop_time=stop_time
    )
    return run(system.set(dict(changes)).with_sample_time(step))


def contact(made: Result) -> np.ndarray:
    """Which communication points are in contact."""
    return norms(made, "plant.F_ext") > 0


def test_with_true_masses_position_and_angle_follow_their_reference() -> None:
    made = result(HOGAN)
    force, touching = norms(made, "plant.F_ext"), np.flatnonzero(contact(made))
    x, e = made["plant.x"], made["controller.e"]
    assert made.time[touching[0]] == pytest.approx(0.918, abs=0.005)  # s, as for the other arms
    assert made.time[touching[-1]] == pytest.approx(1.076, abs=0.005)
    assert x[touching[0], 1] > 0 > x[touching[-1], 1]  # down the wall, a to b
    assert 100 < force.max() < 1000  # N
    assert (made["plant.F_ext"][:, 2] == 0).all()  # a point contact
    # The force of a tick is held, too small by half a tick of its growth: an impulse of Ts F / 2 (test_redundant.py),
    # which a tip of at least the hand's mass takes up, and (3) damps. The hand turns it into an angle by its length.
    position = STEP * force.max() / (2 * MASSES[-1]) / (340.0 / 2.0)
    assert np.abs(e[:, :2]).max() <= position
    assert np.abs(e[:, 2]).max() <= position / start.POSE_ARM.link_lengths[2]
    assert np.linalg.norm(x[-1] - [*start.X_V, start.ORIENTATION]) <= 1e-5


def test_the_wrong_mass_degrades_the_conventional_law() -> None:
    true, wrong = result(HOGAN), result(HOGAN, *WRONG.items())
    for axes in (slice(0, 2), slice(2, 3)):
        largest = [np.abs(made["controller.e"][:, axes]).max() for made in (true, wrong)]
        assert largest[1] > 20 * largest[0]


@pytest.mark.parametrize("controller", [CRAIG, SLOTINE_LI, SPONG_ORTEGA])
def test_the_payload_is_learned_before_the_contact_and_again_after_it(controller: str) -> None:
    """C4 to C6 of the paper's table, for three task coordinates."""
    made = result(controller, *WRONG.items())
    m3, touching = made["controller.p_hat[3]"], contact(made)
    first, last = np.flatnonzero(touching)[[0, -1]]
    assert abs(m3[np.searchsorted(made.time, 0.5)] - MASSES[2]) < 0.025  # kg, of 1 kg at the start: C4, quickly
    assert abs(m3[first] - MASSES[2]) < 0.005
    assert np.abs(m3[first:last] - MASSES[2]).max() < 0.2 * MASSES[2]  # C5
    assert abs(m3[-1] - MASSES[2]) < 0.002  # C6
    e = made["controller.e"]
    late = (made.time > 0.5) & ~touching
    wrong = result(HOGAN, *WRONG.items())["controller.e"]
    assert np.abs(e[late]).max() < 0.1 * np.abs(wrong[late]).max()


def test_all_masses_unknown_are_learned_by_algorithm_2() -> None:
    """Each estimate starts 50 % to 140 % too large, and ends within 0.1 %."""
    assumed = (3.0, 1.0, 1.2)
    changes = {f"controller.p_start[{i + 1}]": mass for i, mass in enumerate(assumed)}
    changes |= {f"controller.Gamma[{i + 1}]": 4.0 for i in range(3)}
    made = result(SLOTINE_LI, *changes.items())
    estimates = made["controller.p_hat"][:, :3]
    np.testing.assert_array_equal(estimates[0], assumed)
    np.testing.assert_allclose(estimates[-1], MASSES, rtol=1e-3)


@pytest.mark.parametrize("controller", [CRAIG, SPONG_ORTEGA])
def test_with_zero_gains_algorithm_1_repeats_the_conventional_run_bit_for_bit(controller: str) -> None:
    conventional, idle = result(HOGAN), result(controller, ("controller.Gamma[3]", 0.0))
    for name in ("plant.x", "plant.F_ext", "controller.tau_cmd", "controller.p_hat"):
        np.testing.assert_array_equal(idle[name], conventional[name])


@pytest.mark.parametrize("controller", [CRAIG, SPONG_ORTEGA])
def test_noise_of_forces_and_moments_is_rejected(controller: str) -> None:
    """With errors of up to 42 N and 6 N.m in contact F_c acts in all three coordinates, and the estimate stays.

    A sampled F_c chatters, so the boundary layer is 1 cm/s and the sampling period is short.
    """
    noise = {"sensor.noise_std": 20.0, "sensor.noise_bound": 60.0, "controller.noise_bound": 60.0}
    changes = WRONG | noise | {"controller.gamma_eps": 1e-2}
    made = result(controller, *changes.items(), step=FINE, stop_time=1.2)
    touching = contact(made)
    assert np.abs(made["sensor.F_hat"][:, 2]).max() > 5  # N.m, of noise alone
    assert (np.abs(made["controller.F_c"][touching]).max(axis=0) > [5, 5, 0.5]).all()  # N, N, N.m
    assert np.abs(made["controller.p_hat[3]"][touching] - MASSES[2]).max() < 0.2 * MASSES[2]  # C5
    assert np.abs(made["controller.e"][touching]).max() < 2e-4  # m and rad
