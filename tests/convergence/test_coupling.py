"""The error of Gauss-Seidel and of Jacobi is of order 1 in the communication step, in the loop of the paper.

Every sample_time equals the step H, so the loop tends to the continuous loop as H goes to zero.
Gauss-Seidel is the sampled-data loop with zero-order hold: the torque is H/2 old on average. Jacobi adds
a delay of one step per connection. Both errors are of order 1, and the error of Jacobi is larger.
"""

from functools import cache

import numpy as np

from orchestration import Options, simulate
from orchestration.paper.built_fmus import fmus
from orchestration.paper.scenarios import SCENARIOS

STEPS = (4e-4, 2e-4, 1e-4, 5e-5)  # s
STOP = 0.5  # s, before the contact: the motion is smooth
FINE = 2.5e-6  # s; the error of this run, of order 1 too, is 5 % of the error at the smallest step
# The error of the fine run makes a slope over three halvings look larger by
# log2((8 - 0.05) / (1 - 0.05) / 8) / 3 = 0.02. Terms of order 2 are H times rates of 100 1/s, which is 4 % of 1.
ORDER = (0.9, 1.1)


@cache
def joint_angles(algorithm: str, step: float) -> np.ndarray:
    """Return the joint angles at the end of a run, rad, shape (2,)."""
    scenario = SCENARIOS["fig4"]
    system = scenario.system(fmus(scenario.models.values())).with_sample_time(step)
    options = Options(record=["plant.q[1]", "plant.q[2]"], strict=True)
    return simulate(system, STOP, step, algorithm, options=options).rows[-1]


def errors(algorithm: str) -> list[float]:
    """Return the largest error of the angles at the end, rad, for each step."""
    limit = joint_angles("gauss-seidel", FINE)
    return [float(np.abs(joint_angles(algorithm, step) - limit).max()) for step in STEPS]


def order(values: list[float]) -> float:
    """Return the order of the error in the step: the fitted slope of the logarithms."""
    return float(np.polyfit(np.log(STEPS), np.log(values), 1)[0])


def test_gauss_seidel_converges_at_order_1() -> None:
    assert ORDER[0] <= order(errors("gauss-seidel")) <= ORDER[1]


def test_jacobi_converges_at_order_1() -> None:
    assert ORDER[0] <= order(errors("jacobi")) <= ORDER[1]


def test_the_delays_of_jacobi_cost_accuracy() -> None:
    # Jacobi compares the state with the virtual trajectory of another instant, whole steps away at pi m/s. The error
    # of Gauss-Seidel is that of a torque that is held for a step.
    for sequential, simultaneous in zip(errors("gauss-seidel"), errors("jacobi"), strict=True):
        assert simultaneous > 2 * sequential
