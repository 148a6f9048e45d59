"""Controllers' variants: which matrices they refuse, names and start values, what tunes, form (5) and no C_x s."""

import re

import numpy as np
import pytest

from fmus.catalog import VARIANTS
from orchestration import scenario, simulate
from orchestration.check import Severity
from tests.driver import Value
from tests.property.pose import Pose
from tests.property.samples import EPS
from tests.reference import arm as closed
from tests.unit.fmus.test_controllers import TAU, moving, require_refused
from tests.unit.fmus.variants import TS, Open, require_finite_outputs
from tests.unit.orchestration.checked import check
from tests.variant_files import file_of

FULL = [name for name in VARIANTS if name.endswith("Full")]
CRAIG, SLOTINE_LI, SPONG_ORTEGA, HOGAN = (
    "CraigAdaptiveImpedanceFull",
    "SlotineLiAdaptiveImpedanceFull",
    "SpongOrtegaAdaptiveImpedanceFull",
    "HoganImpedanceFull",
)
OURS = [*FULL, "HoganImpedanceMobility", "SlotineLiAdaptiveImpedanceNoCoriolis"]


def mirrored(values: dict[str, Value]) -> dict[str, Value]:
    """The values with those of elements across the diagonal: A[2,1] for A[1,2]."""
    across = {re.sub(r"(\d),(\d)", r"\2,\1", name): value for name, value in values.items()}
    return values | across


@pytest.mark.parametrize("name", OURS)
def test_a_variant_breaks_no_rule_and_shows_finite_outputs(open_variant: Open, name: str) -> None:
    assert [finding for finding in check(file_of(name)).findings if finding.severity is not Severity.NOTE] == []
    require_finite_outputs(open_variant(name))


@pytest.mark.parametrize("name", FULL)
@pytest.mark.parametrize("matrix", ["M", "B", "K"])
def test_an_impedance_that_is_not_positive_definite_is_refused(open_variant: Open, name: str, matrix: str) -> None:
    diagonal = {"M": 2.0, "B": 340.0, "K": 4000.0}[matrix]
    for wrong in (diagonal, -1.5 * diagonal):  # singular, indefinite
        require_refused(
            open_variant(name), mirrored({f"{matrix}[1,2]": wrong}), rf"^{matrix} must be positive definite"
        )
    open_variant(name).initialize(mirrored({f"{matrix}[1,2]": 0.1 * diagonal}))


@pytest.mark.parametrize("name", FULL)
def test_a_matrix_that_is_not_symmetric_is_refused(open_variant: Open, name: str) -> None:
    sentence = r"^M must be symmetric: M\[i,j\] and M\[j,i\] must be equal; set both"
    require_refused(open_variant(name), {"M[1,2]": 0.5}, sentence)


@pytest.mark.parametrize("name", FULL)
def test_an_impedance_tunes_between_steps(open_variant: Open, name: str) -> None:
    driver = open_variant(name)
    driver.initialize()
    driver.step(0.0, TS)
    before = driver.get(*TAU)
    driver.set({"x_v[1]": 1.4} | mirrored({"K[1,2]": 500.0}))
    driver.step(TS, TS)
    coupled = driver.get(*TAU)
    driver.set(mirrored({"K[1,2]": 0.0}))
    driver.step(2 * TS, TS)
    # The coupling pulls the tip across with 500 N/m times 0.1 m: 50 N on an arm of 1.5 m.
    assert np.abs(coupled - before).max() > 10
    assert np.abs(driver.get(*TAU) - coupled).max() > 10


@pytest.mark.parametrize("name", [CRAIG, SLOTINE_LI, SPONG_ORTEGA])
@pytest.mark.parametrize(
    "wrong",
    [{"Gamma[1,2]": 1.0}, {"Gamma[1,1]": 1.0, "Gamma[1,2]": 9.0}, {"Gamma[5,6]": 1e-9}],
    ids=["a known parameter that is coupled", "indefinite", "two known parameters that are coupled"],
)
def test_an_adaptation_gain_that_is_not_semidefinite_is_refused(
    open_variant: Open, name: str, wrong: dict[str, Value]
) -> None:
    require_refused(open_variant(name), mirrored(wrong), "^Gamma must be positive semidefinite")


@pytest.mark.parametrize("name", [CRAIG, SLOTINE_LI, SPONG_ORTEGA])
def test_a_coupled_gain_moves_both_estimates_and_excludes_projection(open_variant: Open, name: str) -> None:
    rank_one = mirrored({"Gamma[1,1]": 4.0, "Gamma[1,2]": 2.0, "Gamma[2,2]": 1.0})
    driver = open_variant(name)
    driver.initialize(rank_one)
    for k in range(3):
        moving(driver, k)
    m1, m2 = driver.get("p_hat[1]", "p_hat[2]") - (2.0, 1.0)
    assert abs(m1) > 1e-6
    # Gamma = (2, 1)' (2, 1): all steps go along (2, 1); each rounds p_hat.
    assert abs(m1 - 2 * m2) <= 10 * EPS * 2
    require_refused(open_variant(name), rank_one | {"projection": True}, "^projection needs a diagonal Gamma")


@pytest.mark.parametrize("name", [CRAIG, SPONG_ORTEGA])
def test_algorithm_1_refuses_gains_for_which_its_lyapunov_function_is_none(open_variant: Open, name: str) -> None:
    sentence = r"^Q of eq\. \(A2\) must be positive definite: strict positive realness"
    require_refused(open_variant(name), {"Psi[1,1]": 170.0}, sentence)  # B/M itself, as in the plain FMU
    require_refused(open_variant(name), mirrored({"Psi[1,2]": 90.0, "B[1,2]": -200.0}), sentence)  # axes too far apart
    open_variant(name).initialize({"Psi[1,1]": 169.9, "Psi[2,2]": 169.9})
    open_variant(name).initialize(mirrored({"Psi[1,2]": 20.0, "B[1,2]": -20.0, "K[1,2]": 200.0}))


def test_algorithm_2_takes_any_definite_psi_and_semidefinite_k_d(open_variant: Open) -> None:
    open_variant(SLOTINE_LI).initialize(mirrored({"Psi[1,1]": 1000.0, "Psi[1,2]": 200.0, "K_d[1,2]": 100.0}))
    require_refused(open_variant(SLOTINE_LI), mirrored({"Psi[1,2]": 100.0}), "^Psi must be positive definite")
    require_refused(open_variant(SLOTINE_LI), mirrored({"K_d[1,2]": 101.0}), "^K_d must be positive semidefinite")


def test_a_sample_that_the_exponential_cannot_span_is_refused(open_variant: Open) -> None:
    require_refused(
        open_variant(HOGAN), {"sample_time": 1.0, "B[1,1]": 3e5}, "^sample_time is too long for the target impedance"
    )
    open_variant(HOGAN).initialize({"sample_time": 1.0, "B[1,1]": 2e5})


@pytest.mark.parametrize("name", ["HoganImpedanceMobility", HOGAN])
def test_form_5_and_full_matrices_repeat_fig_2_to_rounding(name: str) -> None:
    plain, other = simulate(scenario("fig2")), simulate(scenario("fig2", controller=name))
    arm = closed.Arm(1.0, 1.0, 0.0, 1e-2)
    p = np.array([2.0, 1.0, 0, 0, 0, 0])
    worst = 0.0
    for q, dq in zip(plain["plant.q"][::50], plain["plant.dq"][::50], strict=True):
        pose = Pose(arm, q, dq)
        worst = max(worst, np.linalg.cond(pose.J) ** 2 * np.linalg.cond(closed.inertia(arm, p, q)))
    # As in test_impedance_forms.py: W = J H^-1 J' is solved, and its condition is at most cond(J)^2 cond(H). The terms
    # of the torque are at most 1 kN at 1.5 m. Seen: 5e-13 N.m of 2e-11 N.m.
    torque = 2 * EPS * worst * 1500
    assert 0 < torque < 1e-8
    assert np.abs(other["controller.tau_cmd"] - plain["controller.tau_cmd"]).max() <= torque
    # A wrong torque for all of the 2 s, were nothing to correct it: below tau / H t^2 / 2 with H above 0.1 kg.m2.
    assert np.abs(other["plant.x"] - plain["plant.x"]).max() <= 20 * torque


def test_replacing_a_controller_puts_diagonals_into_its_matrices() -> None:
    system = scenario("fig5", controller=CRAIG)
    start, plain = system["controller"].start, scenario("fig5")["controller"].start
    for name in ("M", "B", "K", "Psi"):
        assert [start[f"{name}[{i},{i}]"] for i in (1, 2)] == [plain[f"{name}[{i}]"] for i in (1, 2)]
    assert start["Gamma[2,2]"] == plain["Gamma[2]"]
    assert any("M[1] to M[1,1]" in notice for notice in system.notices)
    assert not any("dropped" in notice for notice in system.notices)


def test_without_its_coriolis_term_algorithm_2_lacks_c_x_s_and_nothing_else(open_variant: Open) -> None:
    """The torques differ by J' C_hat_x s, (32); the estimates move alike, (33)."""
    seen = []
    for name in ("SlotineLiAdaptiveImpedance", "SlotineLiAdaptiveImpedanceNoCoriolis"):
        driver = open_variant(name)
        driver.initialize({"p_start[2]": 2.5, "p_start[3]": 0.3})
        for k in range(3):
            moving(driver, k)
        seen.append((driver.get(*TAU), driver.get("s[1]", "s[2]"), driver.get(*(f"p_hat[{i + 1}]" for i in range(6)))))
    (tau, s, p_hat), (other_tau, other_s, other_p_hat) = seen
    np.testing.assert_array_equal(s, other_s)
    np.testing.assert_array_equal(p_hat, other_p_hat)
    assert abs(p_hat[1] - 2.5) > 1e-6
    q, dq = np.array([-0.7227342478 + 0.003, 1.4454684956]), np.array([2.0943951024, 0.0])
    pose = Pose(closed.Arm(1.0, 1.0, 0.0, 1e-2), q, dq)
    dropped = pose.J.T @ (pose.C_x(p_hat) @ s)
    assert np.linalg.norm(dropped) > 0.01  # N.m
    # The rounding of either torque, of some 100 N.m.
    assert np.abs((other_tau - tau) - dropped).max() <= pose.rounding(p_hat) * 100


def test_a_swap_hands_diagonals_on_in_both_directions() -> None:
    """From the plain controller to the variant and back; only what is off the diagonal is dropped, and that is said."""
    plain = scenario("fig5").set({"controller.K": [4000.0, 500.0], "controller.Psi": [90.0, 110.0]})
    full = plain.replace("controller", file_of(CRAIG))
    assert full["controller"].start["K[2,2]"] == 500.0
    assert "K[2] to K[2,2]" in full.notices[-1]
    coupled = full.set({"controller.K[1,2]": 30.0, "controller.K[2,1]": 30.0})
    back = coupled.replace("controller", file_of("CraigAdaptiveImpedance"))
    assert back["controller"].start == plain["controller"].start
    dropped, moved = back.notices[len(coupled.notices) :]
    assert dropped == "controller: start values dropped, CraigAdaptiveImpedance has no K[1,2], K[2,1]."
    assert moved.startswith("controller: start values moved to diagonals of CraigAdaptiveImpedance: M[1,1] to M[1], ")
    assert "K[2,2] to K[2]" in moved
    assert back.set({"controller.K[2]": 4000.0, "controller.K[1]": 4000.0})["controller"].start["Psi[2]"] == 110.0
