"""Error of the coupling against the communication step, of both fixed-step masters.

With every sample_time equal to the step H, the loop tends to the continuous one as H goes to zero.
Gauss-Seidel is the sampled-data loop with zero-order hold: the torque is H/2 old on average. Jacobi adds
one step per connection. Both errors are of order 1, Jacobi's the larger.
"""

from functools import cache

import numpy as np

from orchestration import Options, simulate
from orchestration.paper.built_fmus import fmus
from orchestration.paper.scenarios import SCENARIOS

STEPS = (4e-4, 2e-4, 1e-4, 5e-5)  # s
STOP = 0.5  # s, before the contact: the motion is smooth
FINE = 2.5e-6  # s; its own error, of order 1 too, is 5 % of that at the smallest step
# The fine run's own error makes a slope over three halvings look larger by
# log2((8 - 0.05) / (1 - 0.05) / 8) / 3 = 0.02; terms of order 2 are H times rates of 100 1/s: 4 % of 1.
ORDER = (0.9, 1.1)


@cache
def joint_angles(algorithm: str, step: float) -> np.ndarray:
    """The joint angles at the end, rad."""
    scenario = SCENARIOS["fig4"]
    system = scenario.system(fmus(scenario.units.values())).with_sample_time(step)
    options = Options(record=["plant.q[1]", "plant.q[2]"], strict=True)
    return simulate(system, STOP, step, algorithm, options=options).rows[-1]


def errors(algorithm: str) -> list[float]:
    """Largest error of the angles at the end, for each step."""
    limit = joint_angles("gauss-seidel", FINE)
    return [float(np.abs(joint_angles(algorithm, step) - limit).max()) for step in STEPS]


def order(values: list[float]) -> float:
    """Fitted slope of the logarithms."""
    return float(np.polyfit(np.log(STEPS), np.log(values), 1)[0])


def test_gauss_seidel_converges_at_order_1() -> None:
    assert ORDER[0] <= order(errors("gauss-seidel")) <= ORDER[1]


def test_jacobi_converges_at_order_1() -> None:
    assert ORDER[0] <= order(errors("jacobi")) <= ORDER[1]


def test_the_delays_of_jacobi_cost_accuracy() -> None:
    # It compares the state with the virtual trajectory of another instant, pi m/s times whole steps apart;
    # Gauss-Seidel's error is that of a torque held for a step.
    for sequential, simultaneous in zip(errors("gauss-seidel"), errors("jacobi"), strict=True):
        assert simultaneous > 2 * sequential
