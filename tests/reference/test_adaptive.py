"""The adaptive runs of Figs. 5 to 7 agree with the independent monolithic reference, noise included.

The reference has its own control laws and adaptation, and draws the noise with numpy.random.Philox.
The force F_c of algorithm 1 chatters, because its gain (25) is a sliding term. Differences in the last
bit then grow to the width of the chatter within milliseconds, in the reference too. There the yardstick
is the difference between two runs of the reference whose initial states differ by 1e-14.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from orchestration import Options, Result, simulate
from orchestration.paper.built_fmus import fmus
from orchestration.paper.scenarios import SCENARIOS, VARIANTS, Scenario
from tests.reference.monolithic import Setup, simulate_reference
from tests.reference.test_gauss_seidel import scale

# The integrator of the plant is good to 1e-11 at steps of 2e-5 s (test_gauss_seidel). Adaptation and noise add
# rounding of the same size. 1e-7 leaves room for the differences that an impact amplifies.
TOLERANCE = 1e-7
PERTURBATION = 1e-14  # rad, some 50 ulp of q
# Two runs without correlation differ by up to twice the difference of one run from the mean of the two.
SPREAD = 2.0

RUNS = {**SCENARIOS, **VARIANTS}
CHATTERING = ("fig5", "fig6", "spong-ortega")
FELT = ("sensor.F_hat[1]", "sensor.F_hat[2]")


def setup(scenario: Scenario, **changes: Any) -> Setup:
    """Return the numbers of the reference for a scenario; `changes` replace fields of Setup."""
    values = {path: value.number for path, value in scenario.values.items()}

    def pair(path: str) -> tuple[float, float]:
        return values[f"{path}[1]"], values[f"{path}[2]"]

    numbers: dict[str, Any] = {
        "controller": scenario.models["controller"],
        "sample_time": scenario.step,
        "B": pair("controller.B"),
        "Psi": pair("controller.Psi"),
        "Gamma": (0.0, values["controller.Gamma[2]"], 0.0, 0.0, 0.0, 0.0),
        "p_start": tuple(values[f"controller.p_start[{i}]"] for i in range(1, 7)),
        "noise_std": values["sensor.noise_std"],
        "noise_bound": values["sensor.noise_bound"],
        "noise_period": values["sensor.noise_period"],
        "wall_offset": values["plant.wall_offset"],
        "depth": values["trajectory.depth"],
        "seed": int(values["sensor.seed"]),
        "controller_noise_bound": values.get("controller.noise_bound", 0.0),
        "gamma_margin": values.get("controller.gamma_margin", 1.5),
        "gamma_eps": values.get("controller.gamma_eps", 1e-4),
    }
    if "controller.K_d[1]" in values:
        numbers["K_d"] = pair("controller.K_d")
    if "actuator.tau_max[1]" in values:
        numbers["tau_max"] = pair("actuator.tau_max")
    return Setup(**(numbers | changes))


def run(scenario: Scenario, **changes: float) -> Result:
    """Return the co-simulated run of a scenario; changes are written as ``component__variable``."""
    system = scenario.system(fmus(scenario.models.values()))
    system = system.set({path.replace("__", "."): value for path, value in changes.items()})
    return simulate(system, options=Options(strict=True))


@cache
def reference(name: str) -> dict[str, np.ndarray]:
    """Return the run of the reference for a scenario, by column."""
    return simulate_reference(setup(RUNS[name]))


def misses(result: Result, expected: dict[str, np.ndarray], rows: slice) -> dict[str, float]:
    """Return the largest difference of each common signal over its range."""
    return {
        column: float(np.abs(result[column] - expected[column])[rows].max()) / scale(expected, column)
        for column in result.names
        if column in expected
    }


def feel_alike(a: Mapping[str, np.ndarray], b: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the rows, as a mask of shape (n,), in which both sensors measure a force, or neither sensor does."""
    one, other = (np.any([run[column] != 0 for column in FELT], axis=0) for run in (a, b))
    return one == other


def require(differences: dict[str, float], bounds: dict[str, float]) -> None:
    """Require that the difference of every signal is within its bound."""
    excess = {column: differences[column] / bounds[column] for column in differences}
    worst = max(excess, key=lambda column: excess[column])
    assert excess[worst] <= 1, f"{worst}: {differences[worst]:.2e} of its range, bound {bounds[worst]:.2e}"


def test_algorithm_2_with_noise_agrees_pointwise() -> None:
    result = run(RUNS["fig7"])
    differences = misses(result, reference("fig7"), slice(None))
    assert len(differences) >= 40
    require(differences, dict.fromkeys(differences, TOLERANCE))


@pytest.mark.parametrize("name", CHATTERING)
def test_algorithm_1_with_noise_but_without_F_c_agrees_pointwise(name: str) -> None:
    scenario = RUNS[name]
    result = run(scenario, controller__noise_bound=0.0)
    expected = simulate_reference(setup(scenario, controller_noise_bound=0.0))
    differences = misses(result, expected, slice(None))
    require(differences, dict.fromkeys(differences, TOLERANCE))


@pytest.mark.parametrize("name", CHATTERING)
def test_algorithm_1_agrees_pointwise_until_F_c_chatters(name: str) -> None:
    expected = reference(name)
    contact = int(np.flatnonzero(expected["plant.gap"] > 0)[0])
    differences = misses(run(RUNS[name]), expected, slice(0, contact))
    require(differences, dict.fromkeys(differences, TOLERANCE))


@pytest.mark.parametrize("name", CHATTERING)
def test_algorithm_1_agrees_as_well_as_the_reference_with_itself(name: str) -> None:
    """The run differs from the reference by no more than the reference from itself after a tiny change of its start.

    F_hat is compared only at ticks at which both runs feel the wall, or neither does, because F_hat jumps by its noise
    at the others. The last bits, which the reference computes with a C library, decide at which tick, 2e-5 s earlier or
    later, contact ends.
    """
    expected, given, result = reference(name), setup(RUNS[name]), run(RUNS[name])
    bounds: dict[str, float] = {}
    most = 0
    for sign in (-1, 1):
        q_start = (given.q_start[0] + sign * PERTURBATION, given.q_start[1])
        moved = simulate_reference(replace(given, q_start=q_start))
        shared = feel_alike(moved, expected)
        most = max(most, np.count_nonzero(~shared))
        for column, values in moved.items():
            if column == "time":
                continue
            both = shared if column.startswith("sensor.F_hat") else slice(None)
            own = float(np.abs(values - expected[column])[both].max()) / scale(expected, column)
            bounds[column] = max(bounds.get(column, 0.0), SPREAD * own + TOLERANCE)
    felt = {column: result[column] for column in FELT}
    shared = feel_alike(felt, expected)
    assert np.count_nonzero(~shared) <= SPREAD * most + 1
    differences = misses(result, expected, slice(None))
    for column in FELT:
        differences[column] = float(np.abs(felt[column] - expected[column])[shared].max()) / scale(expected, column)
    require(differences, bounds)
