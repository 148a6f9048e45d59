"""The co-simulated loops of the PUMA 560 agree with the monolithic reference, in free motion and through a contact.

The reference has Pinocchio's dynamics, SciPy's angles, and its own trajectory, contact, control laws and adaptation
(`tests.reference.spatial`). Only the integrators of the plant differ: Runge-Kutta 4 with steps of 1e-4 s here, and
DOP853 at rtol 1e-12 in the reference.
"""

from typing import Any

import numpy as np
import pytest

from orchestration import Options, Result, System, simulate
from orchestration.paper.built_fmus import fmus
from tests.reference.spatial.laws import CRAIG, HOGAN, SLOTINE_LI
from tests.reference.spatial.loop import JOINTS, PAYLOAD, Setup, simulate_reference

ARM = "Puma560"
STOP = 1.1  # s: the tool is on the table from 0.88 s to 1.06 s
# Runge-Kutta errs by (w dt)^5/120 in a step. A payload with the wrist before it swings on the table with w ~ 300 rad/s:
# 2e-10, and 2e-8 over the hundred steps of an oscillation. Seen: 4e-9, of the smallest ranges.
TOLERANCE = 1e-7
CONSTANT = 1e-9  # m, rad, ...: a signal that moves by less is constant apart from rounding, and its range counts as 1

ADAPTED = (4.0,) * 10
"""Gains of the ten parameters of the payload, the start values of algorithm 2."""
# Everything that the defaults leave out: friction in the joints, of which the controller assumes another one; a damped
# wall with friction; a trajectory with a straight segment in the wall, along which the tool turns about all three axes.
ALL_AT_ONCE: dict[str, Any] = {
    "viscous": (1.0, 2.0, 1.5, 0.2, 0.1, 0.3),
    "coulomb": (2.0, 1.0, 1.5, 0.3, 0.2, 0.1),
    "assumed_viscous": (1.1, 1.8, 1.5, 0.2, 0.2, 0.25),
    "assumed_coulomb": (1.5, 1.2, 1.5, 0.25, 0.2, 0.2),
    "coulomb_velocity": 0.05,
    "gravity": (0.7, -0.4, -9.7),
    "D_f": 0.5,
    "mu": 0.3,
    "depth": 0.004,
    "tilt": (0.2, -0.3, 0.25),
    "payload_inertia": (2.2e-3, 3e-4, 2e-3, -2e-4, 1e-4, 1.2e-3),
}


def system(setup: Setup, changed: dict[str, Any]) -> System:
    """The loop of FMUs with the numbers of a setup that were changed."""
    models = {
        "trajectory": "VirtualTrajectory",
        "sensor": "ForceSensor",
        "controller": setup.controller,
        "actuator": "Actuator",
        "plant": "Plant",
    }
    files = fmus(f"{model}{ARM}" for model in models.values())
    named = {name: files[f"{model}{ARM}"] for name, model in models.items()}
    loop = System.connected_by_name("puma", named, step=setup.sample_time, stop_time=setup.stop_time)
    return loop.set(_values(loop, changed))


def _values(loop: System, changed: dict[str, Any]) -> dict[str, float]:
    """What to set, by ``component.variable``; friction has places of its own among the parameters p."""
    places = {"viscous": ("plant", "p", 60), "coulomb": ("plant", "p", 66)}
    places |= {"assumed_viscous": ("controller", "p_start", 60), "assumed_coulomb": ("controller", "p_start", 66)}
    values: dict[str, float] = {}
    for name, given in changed.items():
        numbers = given if isinstance(given, tuple) else (given,)
        if name in places:
            component, array, before = places[name]
            values |= {f"{component}.{array}[{before + i + 1}]": number for i, number in enumerate(numbers)}
            continue
        for component in loop.components:
            for i, number in enumerate(numbers):
                variable = f"{name}[{i + 1}]" if isinstance(given, tuple) else name
                declared = component.description.variables.get(variable)
                if declared is not None and declared.causality == "parameter":  # mu is also an output of algorithm 1
                    values[f"{component.name}.{variable}"] = number
    return values


def start_of(controller: str) -> dict[str, Any]:
    """The start of the motion, and of what only some controllers have."""
    plant = fmus([f"Plant{ARM}"])[f"Plant{ARM}"]
    declared = System.connected_by_name("plant", {"plant": plant}, step=1e-4, stop_time=1.0).component("plant")
    starts = {
        name: tuple(float(declared.description.variables[f"{name}[{i + 1}]"].start or 0.0) for i in range(JOINTS))
        for name in ("q_start", "dq_start")
    }
    return {**starts, "Gamma": {HOGAN: (0.0,) * 10, SLOTINE_LI: ADAPTED, CRAIG: (5.0,) * 10}[controller]}


def misses(result: Result, expected: dict[str, np.ndarray]) -> dict[str, float]:
    """The largest difference of each signal over its range; the error e has the range of x."""
    found = {}
    for column in result.names:
        if column not in expected:
            continue
        extent = float(np.ptp(expected[column.replace("controller.e[", "plant.x[")]))
        found[column] = float(np.abs(result[column] - expected[column]).max()) / (extent if extent > CONSTANT else 1.0)
    return found


@pytest.mark.parametrize(
    ("controller", "changed"),
    [(HOGAN, {}), (SLOTINE_LI, ALL_AT_ONCE), (CRAIG, ALL_AT_ONCE)],
    ids=["Hogan", "Slotine-Li with all at once", "Craig with all at once"],
)
def test_every_signal_of_the_puma_agrees_with_the_reference(controller: str, changed: dict[str, Any]) -> None:
    """All signals agree in all rows: first the arm is free, then it pushes and slides, then it leaves the table."""
    setup = Setup(controller=controller, stop_time=STOP, **start_of(controller), **changed)
    expected = simulate_reference(setup)
    result = simulate(system(setup, changed), options=Options(strict=True))
    touching = expected["plant.gap"] > 0
    assert not touching[0]
    assert np.count_nonzero(touching) > 1000
    assert not touching[-1]
    differences = misses(result, expected)
    assert set(differences) == set(expected) - {"time"}
    worst = max(differences, key=lambda column: differences[column])
    assert differences[worst] <= TOLERANCE, f"{worst} misses by {differences[worst]:.2e} of its range"
    if controller != HOGAN:
        assert np.ptp(expected[f"controller.p_hat[{PAYLOAD + 1}]"]) > 0.2  # kg: the estimates took part
