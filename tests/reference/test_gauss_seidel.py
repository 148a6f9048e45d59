"""The co-simulated runs of Figs. 2 and 4 agree with the independent monolithic reference.

In the order trajectory, sensor, controller, actuator, plant a Gauss-Seidel co-simulation is the
sampled-data loop without extra delay. So only the integrators of the plant differ: Runge-Kutta 4 with
steps of dt_max here, and DOP853 at rtol 1e-12 in the reference.
"""

from functools import cache

import numpy as np
import pytest

from orchestration import Options, System, simulate
from orchestration.paper.built_fmus import fmus
from orchestration.paper.calibrations import CHOSEN_CALIBRATION
from orchestration.paper.scenarios import SCENARIOS
from tests.reference.monolithic import Setup, simulate_reference

CRITICAL_DAMPING = 2.0 * np.sqrt(2.0 * 4000.0)  # N.s/m, B = 2 sqrt(M K)

# The largest difference over the range of a signal. The local error of Runge-Kutta is about (w dt)^5/120 per step, with
# w = sqrt(K_f/m) ~ 320 rad/s in contact: (0.032)^5/120 ~ 3e-10 at dt = 1e-4 s. An impact has some tens of such steps,
# so the error is below 1e-8. At 1e-5 s the error is 1e5 times smaller. Rounding remains, about 1e5 steps of 1e-16:
# 1e-11.
DEFAULT_DT_MAX, FINE_DT_MAX = 1e-4, 1e-5
TOLERANCE = {DEFAULT_DT_MAX: 1e-8, FINE_DT_MAX: 1e-11}


@cache
def reference(m2: float, sample_time: float) -> dict[str, np.ndarray]:
    """Return the run of the reference whose controller assumes the mass m2, kg."""
    setup = Setup(
        p_start=(2.0, m2, 0.0, 0.0, 0.0, 0.0),
        B=(CRITICAL_DAMPING, CRITICAL_DAMPING),
        sample_time=sample_time,
        wall_offset=CHOSEN_CALIBRATION.values["wall_offset"],
        depth=CHOSEN_CALIBRATION.values["depth"],
    )
    return simulate_reference(setup)


def system(name: str, sample_time: float, dt_max: float) -> System:
    """Return the system of a scenario at another sampling period, s, and sub-step of the plant, s."""
    scenario = SCENARIOS[name]
    base = scenario.system(fmus(scenario.models.values()))
    return base.with_sample_time(sample_time).set({"plant.dt_max": dt_max})


def scale(expected: dict[str, np.ndarray], column: str) -> float:
    """Return the range of a signal; the error e takes the range of x, and a constant signal the range 1."""
    extent = float(np.ptp(expected[column.replace("controller.e", "plant.x")]))
    return extent if extent > 0 else 1.0


@pytest.mark.parametrize("dt_max", [DEFAULT_DT_MAX, FINE_DT_MAX])
@pytest.mark.parametrize("sample_time", [1e-4, 2e-5])
@pytest.mark.parametrize(("name", "m2"), [("fig2", 1.0), ("fig4", 2.5)])
def test_every_signal_agrees_with_the_reference(name: str, m2: float, sample_time: float, dt_max: float) -> None:
    expected = reference(m2, sample_time)
    result = simulate(system(name, sample_time, dt_max), options=Options(strict=True))
    assert set(result.names) <= set(expected)
    misses = {
        column: float(np.abs(result[column] - expected[column]).max()) / scale(expected, column)
        for column in result.names
    }
    worst = max(misses, key=lambda column: misses[column])
    assert misses[worst] <= TOLERANCE[dt_max], f"{worst} misses by {misses[worst]:.2e} of its range"
