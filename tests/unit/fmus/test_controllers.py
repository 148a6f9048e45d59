"""Controllers' FMUs: what they refuse, what they show at first, which parameters act when."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from tests.driver import Driver, RefusedError, Value

Open = Callable[..., Driver]
TS = 1e-4  # s
CRAIG, SLOTINE_LI, SPONG_ORTEGA = (
    "CraigAdaptiveImpedance",
    "SlotineLiAdaptiveImpedance",
    "SpongOrtegaAdaptiveImpedance",
)
ADAPTIVE = (CRAIG, SLOTINE_LI, SPONG_ORTEGA)
ROBUST = (CRAIG, SPONG_ORTEGA)
P_HAT = [f"p_hat[{i + 1}]" for i in range(6)]
TAU = ("tau_cmd[1]", "tau_cmd[2]")


def require_refused(driver: Driver, start: dict[str, Value], sentence: str) -> None:
    """Initialization fails, and the log says why."""
    with pytest.raises(RefusedError):
        driver.initialize(start)
    texts = list(driver.messages)
    assert any(re.search(sentence, text) for text in texts), texts


@pytest.mark.parametrize("controller", ROBUST)
@pytest.mark.parametrize(("psi", "axis"), [((170.0, 100.0), 1), ((100.0, 180.0), 2)])
def test_algorithm_1_needs_psi_below_b_over_m(
    open_fmu: Open, controller: str, psi: tuple[float, float], axis: int
) -> None:
    """(14): B/M = 170 1/s by default, the bound itself is excluded."""
    start: dict[str, Value] = {"Psi[1]": psi[0], "Psi[2]": psi[1]}
    require_refused(open_fmu(controller), start, rf"Psi\[{axis}\] must be below B\[{axis}\]/M\[{axis}\]")
    open_fmu(controller).initialize({"Psi[1]": 169.9, "Psi[2]": 169.9})


def test_algorithm_2_takes_any_positive_psi(open_fmu: Open) -> None:
    open_fmu(SLOTINE_LI).initialize({"Psi[1]": 1000.0, "Psi[2]": 171.0})


@pytest.mark.parametrize("controller", ADAPTIVE)
def test_a_start_outside_of_the_projection_is_refused(open_fmu: Open, controller: str) -> None:
    bounds: dict[str, Value] = {"p_start[2]": 2.5, "p_max[2]": 2.0}
    sentence = r"p_start\[2\] must lie within p_min\[2\] and p_max\[2\]"
    require_refused(open_fmu(controller), bounds | {"projection": True}, sentence)
    open_fmu(controller).initialize(bounds)  # off: the bounds mean nothing
    open_fmu(controller).initialize(bounds | {"p_max[2]": 2.5, "projection": True})  # at the bound is within


@pytest.mark.parametrize("controller", ["HoganImpedance", *ADAPTIVE])
def test_a_stretched_arm_is_refused(open_fmu: Open, controller: str) -> None:
    require_refused(open_fmu(controller), {"q[2]": 0.0}, "The arm is singular")


@pytest.mark.parametrize("controller", [CRAIG, SPONG_ORTEGA, "HoganImpedance3R"])
@pytest.mark.parametrize("masses", [{"p_start[2]": 0.0}, {"p_start[1]": 0.0, "p_start[2]": 0.0}])
def test_a_model_without_mass_is_named_by_laws_that_invert_its_inertia(
    open_fmu: Open, controller: str, masses: dict[str, Value]
) -> None:
    inertia, variable = {CRAIG: ("H_hat", "p_hat"), SPONG_ORTEGA: ("H_0", "p_start")}.get(controller, ("H", "p_start"))
    if controller == "HoganImpedance3R":
        masses = masses | {"p_start[3]": 0.0}
    last = 3 if controller == "HoganImpedance3R" else 2
    sentence = (
        rf"^{inertia} is singular because of the masses {variable}\[1\] to {variable}\[{last}\],.*"
        rf" Size of a pivot of {inertia}, kg\.m2 \(value 0, must be positive\)\.$"
    )
    require_refused(open_fmu(controller), masses, sentence)


def test_laws_that_do_not_invert_the_inertia_take_a_model_without_mass(open_fmu: Open) -> None:
    for controller in ("HoganImpedance", SLOTINE_LI):
        driver = open_fmu(controller)
        driver.initialize({"p_start[2]": 0.0})
        driver.step(0.0, TS)
        assert np.isfinite(driver.get(*TAU)).all()


def test_an_estimate_without_mass_is_named(open_fmu: Open) -> None:
    """Projected on p_min = 0 the estimate of m2 is 0, and H_hat singular."""
    driver = open_fmu(CRAIG)
    driver.initialize({"Gamma[2]": 5e4, "projection": True})
    with pytest.raises(
        RefusedError, match=r"H_hat is singular because of the masses p_hat\[1\] to .* projection with p_min > 0"
    ):
        fall(driver)
    assert driver.get("p_hat[2]")[0] > 0  # the last tick that was accepted


def test_a_negative_estimate_is_no_error(open_fmu: Open) -> None:
    """Its H_hat has an inverse; runs of the paper's task come back from there."""
    driver = open_fmu(CRAIG)
    driver.initialize({"Gamma[2]": 5e4})
    fall(driver)
    assert driver.get("p_hat[2]")[0] < 0


@pytest.mark.parametrize("controller", ADAPTIVE)
@pytest.mark.parametrize(("name", "value"), [("update_divisor", 0), ("Gamma[2]", -1.0), ("dead_zone", -0.1)])
def test_values_without_meaning_are_refused(open_fmu: Open, controller: str, name: str, value: Value) -> None:
    with pytest.raises(RefusedError):
        open_fmu(controller).set({name: value})


@pytest.mark.parametrize("controller", ["HoganImpedance", *ADAPTIVE])
def test_the_estimate_starts_at_p_start(open_fmu: Open, controller: str) -> None:
    driver, start = open_fmu(controller), [1.5, 2.5, 0.1, 0.2, 0.3, 0.4]
    driver.initialize({f"p_start[{i + 1}]": value for i, value in enumerate(start)})
    np.testing.assert_array_equal(driver.get(*P_HAT), start)
    driver.step(0, TS)
    np.testing.assert_array_equal(driver.get(*P_HAT), start)  # tick 0 shows it too


def test_the_conventional_controller_never_adapts(open_fmu: Open) -> None:
    driver = open_fmu("HoganImpedance")
    driver.initialize({"p_start[2]": 2.5})
    for k in range(5):
        driver.set({"q[1]": -0.72 + 0.001 * k})
        driver.step(k * TS, TS)
    np.testing.assert_array_equal(driver.get(*P_HAT), [2, 2.5, 0, 0, 0, 0])
    assert "saturated[1]" not in driver.variables


def moving(driver: Driver, k: int) -> float:
    """Make step k with an error of 5 mm and some acceleration; gives the estimate of m2 shown then."""
    driver.set({"q[1]": -0.7227342478 + 0.003, "ddq[1]": 5.0, "ddq[2]": -9.0, "F_hat[1]": -30.0})
    driver.step(k * TS, TS)
    return float(driver.get("p_hat[2]")[0])


def fall(driver: Driver) -> None:
    """Make 200 steps with an error and an acceleration that make the estimate of m2 fall."""
    driver.set({"q[1]": -0.7227342478 + 0.003, "ddq[1]": 5.0, "ddq[2]": 9.0})
    for k in range(200):
        driver.step(k * TS, TS)


@pytest.mark.parametrize("controller", ADAPTIVE)
def test_gamma_is_tunable_from_the_next_tick_on(open_fmu: Open, controller: str) -> None:
    driver = open_fmu(controller)
    driver.initialize()
    m2 = [moving(driver, k) for k in range(3)]
    driver.set({"Gamma[2]": 0.0})
    m2 += [moving(driver, 3), moving(driver, 4)]
    assert m2[0] == 1.0  # tick 0
    assert abs(m2[2] - m2[1]) > 1e-6
    # Tick 2 updated with the old gain; from tick 3 on nothing moves.
    assert m2[3] != m2[2]
    assert m2[4] == m2[3]


@pytest.mark.parametrize("controller", ROBUST)
def test_noise_bound_acts_above_the_contact_threshold(open_fmu: Open, controller: str) -> None:
    driver = open_fmu(controller)
    driver.initialize({"noise_bound": 90.0, "contact_threshold": 5.0, "gamma_margin": 1.0})
    seen = []
    for k, force in enumerate([3.0, 5.0, 5.0 + 1e-12, 5.0]):
        driver.set({"q[1]": -0.7227342478 + 1e-4, "F_hat[1]": -0.6 * force, "F_hat[2]": 0.8 * force})
        driver.step(k * TS, TS)
        seen.append([*driver.get("gamma", "gamma_bound", "F_c[1]")])
    on = [values[0] > 0 and values[2] != 0 for values in seen]
    assert on == [False, False, True, False]
    np.testing.assert_array_equal(np.abs(np.array(seen)[[0, 1, 3]]), 0)


def test_the_acceleration_stays_out_of_the_first_torque(open_fmu: Open) -> None:
    """phi_hat(0) = 0: at initialization the variant has no algebraic loop through the plant."""
    torques = []
    for ddq in (0.0, 40.0):
        driver = open_fmu(SPONG_ORTEGA)
        driver.initialize({"p_start[2]": 2.5, "ddq[1]": ddq, "ddq[2]": -ddq, "q[1]": -0.72})
        torques.append(driver.get(*TAU))
    np.testing.assert_array_equal(*torques)
    # Once phi_hat has moved, it enters.
    later = []
    for ddq in (0.0, 40.0):
        driver = open_fmu(SPONG_ORTEGA)
        driver.initialize({"p_start[2]": 2.5})
        moving(driver, 0)
        driver.set({"ddq[1]": ddq})
        driver.step(TS, TS)
        later.append(driver.get(*TAU))
    assert np.abs(later[0] - later[1]).max() > 1e-6


def test_null_damping_is_for_arms_with_a_null_space(open_fmu: Open) -> None:
    assert "null_damping" not in open_fmu("HoganImpedance").variables
    torques = []
    for damping in (0.0, 20.0):
        driver = open_fmu("HoganImpedance3R")
        driver.initialize({"null_damping": damping, "dq[3]": 2.0})
        torques.append(driver.get(*TAU, "tau_cmd[3]"))
    assert np.abs(torques[0] - torques[1]).max() > 0.1


@pytest.mark.parametrize(
    ("controller", "gains"),
    [
        (CRAIG, ("kg2.s2/m2", "N2.s4/rad2", "N2.s2")),
        (SPONG_ORTEGA, ("kg2.s2/m2", "N2.s4/rad2", "N2.s2")),
        (SLOTINE_LI, ("kg.s2/m2", "N.m.s2/rad2", "N.m")),
    ],
)
def test_units_follow_the_parameters(open_fmu: Open, controller: str, gains: tuple[str, ...]) -> None:
    """Gamma carries p'/(its gradient): (19) is in p^2 s^2/m^2, (33) in p^2/(N.m)."""
    variables = open_fmu(controller).variables
    assert [variables[name].unit for name in P_HAT] == ["kg"] * 2 + ["N.m.s/rad"] * 2 + ["N.m"] * 2
    assert [variables[f"Gamma[{i + 1}]"].unit for i in range(6)] == [unit for unit in gains for _ in range(2)]
