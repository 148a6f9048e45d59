"""Sensor bias, range and resolution; actuator lag and rate limit: against their formulas, and off by default."""

from collections.abc import Callable

import numpy as np
import pytest

from tests.driver import Driver

Open = Callable[..., Driver]
TS = 1e-4  # s


def measured(sensor: Driver, forces: np.ndarray) -> np.ndarray:
    """F_hat for a sequence of forces, shape (n, 2)."""
    shown = []
    for k, force in enumerate(forces):
        sensor.set({"F_ext[1]": force[0], "F_ext[2]": force[1]})
        sensor.step(k * TS, TS)
        shown.append(sensor.get("F_hat[1]", "F_hat[2]"))
    return np.array(shown)


def test_sensor_rounds_after_bias_and_range(open_fmu: Open) -> None:
    sensor = open_fmu("ForceSensor")
    sensor.initialize({"bias[1]": 1.3, "bias[2]": -0.7, "resolution": 0.5, "range": 20.0})
    forces = np.random.default_rng(7).uniform(-40, 40, (200, 2))
    inside = np.clip(forces + np.array([1.3, -0.7]), -20, 20)
    # The same operations in the same order: equal to the bit.
    np.testing.assert_array_equal(measured(sensor, forces), np.floor(inside / 0.5 + 0.5) * 0.5)


def test_bias_acts_without_contact_noise_does_not(open_fmu: Open) -> None:
    sensor = open_fmu("ForceSensor")
    sensor.initialize({"bias[2]": 2.0, "noise_std": 1.0, "noise_bound": 3.0})
    np.testing.assert_array_equal(measured(sensor, np.zeros((5, 2))), [[0.0, 2.0]] * 5)


def torques(actuator: Driver, commands: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Torque and saturation of joint 1 for a sequence of commands, shape (n,) each."""
    shown = []
    for k, command in enumerate(commands):
        actuator.set({"tau_cmd[1]": command})
        actuator.step(k * TS, TS)
        shown.append(actuator.get("tau[1]", "saturated[1]"))
    table = np.array(shown)
    return table[:, 0], table[:, 1]


def test_lag_is_the_exact_response_to_held_commands(open_fmu: Open) -> None:
    actuator = open_fmu("Actuator")
    actuator.initialize({"time_constant": 1e-3})
    tau, saturated = torques(actuator, np.array([0.0] + [10.0] * 50))
    # tau' = (target - tau) / T from tick 1 on: 10 (1 - exp(-k Ts / T)), with 50 roundings.
    expected = 10 * -np.expm1(-np.arange(51) * TS / 1e-3)
    np.testing.assert_allclose(tau, expected, rtol=0, atol=50 * np.finfo(float).eps * 10)
    assert not saturated.any()


def test_rate_limit_holds_and_is_shown(open_fmu: Open) -> None:
    actuator = open_fmu("Actuator")
    actuator.initialize({"tau_rate_max[1]": 2e4, "tau_max[1]": 15.0})
    tau, saturated = torques(actuator, np.array([0.0] + [20.0] * 10 + [14.0] * 5))
    # 2 N.m per tick up to the limit of 15 N.m; back by 1 N.m in one tick.
    np.testing.assert_allclose(tau[1:9], [2, 4, 6, 8, 10, 12, 14, 15], rtol=0, atol=1e-13)
    np.testing.assert_array_equal(tau[9:], [15.0, 15.0] + [14.0] * 5)
    np.testing.assert_array_equal(saturated, [0] + [1] * 10 + [0] * 5)


@pytest.mark.parametrize("command", [0.0, -1.5, 1e8])
def test_off_by_default_to_the_bit(open_fmu: Open, command: float) -> None:
    actuator = open_fmu("Actuator")
    actuator.initialize()
    tau, saturated = torques(actuator, np.array([3.3, command, -command]))
    np.testing.assert_array_equal(tau, [3.3, command, -command])
    assert not saturated.any()


def test_the_first_tick_starts_at_its_target(open_fmu: Open) -> None:
    actuator = open_fmu("Actuator")
    actuator.initialize({"tau_cmd[1]": 7.0, "time_constant": 1e-2, "tau_rate_max[1]": 1.0})
    assert actuator.get("tau[1]") == 7.0
    assert torques(actuator, np.array([7.0]))[0] == 7.0
