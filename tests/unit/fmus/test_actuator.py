"""Evidence for Actuator: it clips at its limits, says so, and is ideal by default."""

from collections.abc import Callable

import numpy as np
import pytest

from tests.driver import Driver

Open = Callable[..., Driver]
TS = 1e-4  # s
TAU = ("tau[1]", "tau[2]")
SATURATED = ("saturated[1]", "saturated[2]")


def limited(open_fmu: Open) -> Driver:
    """An actuator of 60 and 25 N.m."""
    actuator = open_fmu("Actuator")
    actuator.initialize({"tau_max[1]": 60.0, "tau_max[2]": 25.0})
    return actuator


def command(actuator: Driver, tau: tuple[float, float], k: int) -> None:
    """Command a torque in step k."""
    actuator.set({"tau_cmd[1]": tau[0], "tau_cmd[2]": tau[1]})
    actuator.step(k * TS, TS)


@pytest.mark.parametrize(
    ("tau_cmd", "tau", "saturated"),
    [
        ((10.0, -20.0), (10.0, -20.0), (0, 0)),
        ((61.0, -20.0), (60.0, -20.0), (1, 0)),
        ((-60.5, 26.0), (-60.0, 25.0), (1, 1)),
        ((60.0, -25.0), (60.0, -25.0), (0, 0)),  # at the limit is not beyond it
        ((np.nextafter(60.0, 61), -1e6), (60.0, -25.0), (1, 1)),
        ((0.0, 0.0), (0.0, 0.0), (0, 0)),
    ],
)
def test_torque_is_clipped_and_flagged(
    open_fmu: Open, tau_cmd: tuple[float, float], tau: tuple[float, float], saturated: tuple[int, int]
) -> None:
    actuator = limited(open_fmu)
    command(actuator, tau_cmd, 0)
    np.testing.assert_array_equal(actuator.get(*TAU), tau)
    np.testing.assert_array_equal(actuator.get(*SATURATED), saturated)


def test_it_recovers_at_the_next_tick(open_fmu: Open) -> None:
    actuator = limited(open_fmu)
    command(actuator, (100.0, -100.0), 0)
    command(actuator, (1.0, -2.0), 1)
    np.testing.assert_array_equal(actuator.get(*TAU), (1.0, -2.0))
    np.testing.assert_array_equal(actuator.get(*SATURATED), (0, 0))


def test_a_limit_changed_in_a_run_acts_at_the_next_tick(open_fmu: Open) -> None:
    actuator = limited(open_fmu)
    command(actuator, (50.0, 0.0), 0)
    actuator.set({"tau_max[1]": 40.0})
    command(actuator, (50.0, 0.0), 1)
    np.testing.assert_array_equal(actuator.get(*TAU, *SATURATED), (40.0, 0.0, 1, 0))


def test_by_default_it_passes_everything(open_fmu: Open) -> None:
    actuator = open_fmu("Actuator")
    actuator.initialize()
    command(actuator, (9.9e8, -1e5), 0)
    np.testing.assert_array_equal(actuator.get(*TAU, *SATURATED), (9.9e8, -1e5, 0, 0))
