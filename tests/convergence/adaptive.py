"""Runs of Figs. 5 and 7 without noise and limits, at several sampling periods, and their Lyapunov functions.

Equation numbers are those of Lu and Meng (1991).

V_c = X' P X + phi' Gamma^-1 phi                      (17), P of (A2); sums over the axes
V_s = (s' H_x s + phi' Gamma^-1 phi) / 2,             phi = p_hat - p, only m2 unknown
"""

from functools import cache

import numpy as np

from orchestration import Options, Result, simulate
from orchestration.paper.built_fmus import fmus
from orchestration.paper.scenarios import SCENARIOS

PERIODS = (1e-4, 5e-5, 2e-5)  # s
M1, M2, LENGTH = 2.0, 1.0, 1.0  # kg, kg, m: V
FREE_UNTIL = 0.9  # s; the wall is met at 0.916 s
_QUIET = {"sensor.noise_std": 0.0, "sensor.noise_bound": 0.0}
_CHANGES = {
    "fig5": {**_QUIET, "controller.noise_bound": 0.0},
    "fig7": {**_QUIET, "actuator.tau_max[1]": 1e9, "actuator.tau_max[2]": 1e9},
}


@cache
def run(name: str, sample_time: float) -> Result:
    """Return a run of 2 s at a sampling period, s."""
    scenario = SCENARIOS[name]
    system = scenario.system(fmus(scenario.models.values())).set(_CHANGES[name]).with_sample_time(sample_time)
    return simulate(system, options=Options(strict=True))


def value(name: str, path: str) -> float:
    """Return a number of a scenario by ``component.variable``, in the physical unit of the variable."""
    return SCENARIOS[name].values[path].number


def at_ticks(result: Result, name: str, size: int = 2) -> np.ndarray:
    """Return ``name[1]`` to ``name[size]`` at the ticks, shape (n, size)."""
    return np.column_stack([result.at_ticks(f"{name}[{i + 1}]") for i in range(size)])


def lyapunov(name: str, result: Result) -> np.ndarray:
    """Return the Lyapunov function V_c of Fig. 5 or V_s of Fig. 7 at the ticks, shape (n,)."""
    phi = result.at_ticks("controller.p_hat[2]") - M2
    adapted = phi**2 / value(name, "controller.Gamma[2]")
    if name == "fig7":
        return 0.5 * (_kinetic(result) + adapted)
    psi = value(name, "controller.Psi[1]")
    M, B, K = (value(name, f"controller.{letter}[1]") for letter in "MBK")
    e, e_star = at_ticks(result, "controller.e"), at_ticks(result, "controller.e_star")
    de = e_star - psi * e
    return ((K + psi * B) / M * e**2 + 2 * psi * e * de + de**2).sum(axis=1) + adapted


def _kinetic(result: Result) -> np.ndarray:
    """Return s' H_x s, shape (n,): twice the kinetic energy of both point masses when the tip moves at s.

    The elbow then moves at l1 dq1, where dq1 = (s1 cos q12 + s2 sin q12) / (l1 sin q2).
    """
    s, q = at_ticks(result, "controller.s"), at_ticks(result, "plant.q")
    q12 = q.sum(axis=1)
    elbow = (s[:, 0] * np.cos(q12) + s[:, 1] * np.sin(q12)) / np.sin(q[:, 1])
    return M2 * (s**2).sum(axis=1) + M1 * elbow**2


def order(values: list[float]) -> float:
    """Return the exponent of the sampling period that fits values at all `PERIODS`."""
    return float(np.polyfit(np.log(PERIODS), np.log(values), 1)[0])
