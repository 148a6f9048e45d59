"""The co-simulated loops of the PUMA 560 agree with the monolithic reference, in free motion and through a contact.

The reference has Pinocchio's dynamics, SciPy's angles, and its own trajectory, contact, noise, control laws and
adaptation (`tests.reference.spatial`). It gets the numbers of the system, and the arm from its own tables. Only the
integrators of the plant differ: Runge-Kutta 4 with steps of 1e-4 s here, and DOP853 at rtol 1e-12 in the reference.
"""

from collections.abc import Mapping
from dataclasses import fields

import numpy as np
import pytest

from orchestration import Component, Options, Result, System, simulate
from orchestration.paper.built_fmus import fmus
from orchestration.paper.scenarios import ALL_SCENARIOS
from tests.reference.spatial.laws import CRAIG, HOGAN, LAWS, SLOTINE_LI
from tests.reference.spatial.loop import JOINTS, PAYLOAD, Setup, simulate_reference

ARM = "Puma560"
TEN = 10  # parameters of the payload
STEP, STOP = 1e-4, 1.2  # s: the tool is on the table from about 0.84 s to 1.1 s
# Runge-Kutta errs by (w dt)^5/120 in a step. A payload with the wrist before it swings on the table with w ~ 300 rad/s:
# 2e-10, and 2e-8 over the hundred steps of an oscillation. Seen: 9e-9, of the smallest ranges.
TOLERANCE = 1e-7
CONSTANT = 1e-9  # m, rad, ...: a signal that moves by less is constant apart from rounding, and its range counts as 1

PLACES = {
    "viscous": ("plant.p", PAYLOAD - 3 * JOINTS),
    "coulomb": ("plant.p", PAYLOAD - 2 * JOINTS),
    "assumed_viscous": ("controller.p_start", PAYLOAD - 3 * JOINTS),
    "assumed_coulomb": ("controller.p_start", PAYLOAD - 2 * JOINTS),
    "p_hat": ("controller.p_start", PAYLOAD),
    "Gamma": ("controller.Gamma", PAYLOAD),
    "noise_bound": ("sensor.noise_bound", 0),
    "sensor_L": ("sensor.L", 0),
    "L": ("controller.L", 0),
}
"""Where numbers of the reference stand in the system, with the elements of an array before them."""
WIDTHS = {"viscous": JOINTS, "coulomb": JOINTS, "assumed_viscous": JOINTS, "assumed_coulomb": JOINTS}
WIDTHS |= {"p_hat": TEN, "Gamma": TEN}


def vector(path: str, numbers: tuple[float, ...], before: int = 0) -> dict[str, float]:
    """Values of the elements of an array, by ``component.variable``."""
    return {f"{path}[{before + i + 1}]": number for i, number in enumerate(numbers)}


# Everything that the runs leave out: friction in the joints, of which the controller assumes another one; a damped
# wall with friction, which an edge of the tool touches; a trajectory with a straight segment in the wall, along which
# the tool turns about all three axes; a sensor that is turned, and gains along turned axes.
ALL_AT_ONCE: Mapping[str, float] = {
    **vector("plant.p", (1.0, 2.0, 1.5, 0.2, 0.1, 0.3, 2.0, 1.0, 1.5, 0.3, 0.2, 0.1), PAYLOAD - 3 * JOINTS),
    **vector(
        "controller.p_start", (1.1, 1.8, 1.5, 0.2, 0.2, 0.25, 1.5, 1.2, 1.5, 0.25, 0.2, 0.2), PAYLOAD - 3 * JOINTS
    ),
    **{f"{part}.coulomb_velocity": 0.05 for part in ("plant", "controller")},
    **vector("plant.gravity", (0.7, -0.4, -9.7)),
    **vector("controller.gravity", (0.7, -0.4, -9.7)),
    **vector("plant.contact_point", (0.01, -0.02, 0.002)),
    "plant.D_f": 0.5,
    "plant.mu": 0.3,
    "trajectory.depth": 0.004,
    **vector("trajectory.tilt", (0.2, -0.3, 0.25)),
    **vector("plant.payload_inertia", (2.2e-3, 3e-4, 2e-3, -2e-4, 1e-4, 1.2e-3)),
    **vector("sensor.sensor_position", (0.0, 0.01, -0.1)),
    **vector("sensor.sensor_rpy", (0.3, -0.2, 0.5)),
    "sensor.noise_std": 1.0,
    "sensor.noise_bound": 4.0,
    "sensor.seed": 5,
    **vector("controller.task_rpy", (0.4, 0.2, -0.3)),
    **vector("controller.M", (2.0, 2.5, 3.0, 0.045, 0.06, 0.05)),
    **vector("controller.K", (4000.0, 5000.0, 3500.0, 90.0, 100.0, 80.0)),
}
MODELS = ("VirtualTrajectory", "ForceSensor", "{}", "Actuator", "Plant")
COMPONENTS = ("trajectory", "sensor", "controller", "actuator", "plant")


def loop_of(controller: str) -> System:
    """The loop of a controller with all its defaults changed."""
    names = [f"{model.format(controller)}{ARM}" for model in MODELS]
    files = fmus(names)
    parts = {component: files[name] for component, name in zip(COMPONENTS, names, strict=True)}
    loop = System.connected_by_name("puma", parts, step=STEP, stop_time=STOP)
    known = {path: v for path, v in ALL_AT_ONCE.items() if path.split(".")[1] in variables(loop, path)}
    assert set(known) == set(ALL_AT_ONCE)
    return loop.set(dict(known))


def variables(loop: System, path: str) -> Mapping[str, object]:
    """The variables of the component in a path."""
    return loop.component(path.split(".")[0]).description.variables


def of_scenario(name: str) -> System:
    """The system of a scenario at the sampling period of these comparisons."""
    scenario = ALL_SCENARIOS[name]
    return scenario.system(fmus(scenario.models.values())).with_sample_time(STEP)


def setup_of(loop: System) -> Setup:
    """The numbers of a system, for the reference."""
    controller = loop.component("controller").description.identifier.removesuffix(ARM)
    assert controller in LAWS
    numbers: dict[str, object] = {"controller": controller, "sample_time": STEP, "stop_time": STOP}
    for one in fields(Setup):
        if one.name not in numbers:
            value = _number(loop, one.name)
            if value is not None:
                numbers[one.name] = value
    return Setup(**numbers)  # type: ignore[arg-type]


def _number(loop: System, name: str) -> float | tuple[float, ...] | None:
    """A number of the reference, or an array; None if no component has it."""
    path, before = PLACES.get(name, (name, 0))
    array = path.split(".")[-1]
    for component in (loop.component(part) for part in ("plant", "trajectory", "controller", "actuator", "sensor")):
        if "." in path and component.name != path.split(".")[0]:
            continue
        known = _parameters(component)
        if array in known:
            return known[array]
        elements = [known[key] for i in range(100) if (key := f"{array}[{before + i + 1}]") in known]
        if elements:
            return tuple(elements[: WIDTHS.get(name, len(elements))])
    return None


def _parameters(component: Component) -> Mapping[str, float]:
    """All numbers of a component that are parameters: what was set, or else what the FMU declares."""
    return {
        name: float(component.start.get(name, variable.start) or 0.0)
        for name, variable in component.description.variables.items()
        if variable.causality == "parameter" and variable.type != "String"
    }


def misses(result: Result, expected: dict[str, np.ndarray]) -> dict[str, float]:
    """The largest difference of each signal over its range; the error e has the range of x."""
    found = {}
    for column in result.names:
        if column not in expected:
            continue
        extent = float(np.ptp(expected[column.replace("controller.e[", "plant.x[")]))
        found[column] = float(np.abs(result[column] - expected[column]).max()) / (extent if extent > CONSTANT else 1.0)
    return found


SYSTEMS = {
    "puma": lambda: of_scenario("puma"),
    "puma-ideal": lambda: of_scenario("puma-ideal"),
    "Slotine-Li with all at once": lambda: loop_of(SLOTINE_LI),
    "Craig with all at once": lambda: loop_of(CRAIG),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_every_signal_of_the_puma_agrees_with_the_reference(name: str) -> None:
    """All signals agree in all rows: first the arm is free, then it pushes and slides, then it leaves the table."""
    loop = SYSTEMS[name]()
    setup = setup_of(loop)
    expected = simulate_reference(setup)
    result = simulate(loop, stop_time=STOP, options=Options(strict=True))
    touching = expected["plant.gap"] > 0
    assert not touching[0]
    assert np.count_nonzero(touching) > 1000
    assert not touching[-1]
    differences = misses(result, expected)
    assert set(differences) == set(expected) - {"time"}
    worst = max(differences, key=lambda column: differences[column])
    assert differences[worst] <= TOLERANCE, f"{worst} misses by {differences[worst]:.2e} of its range"
    if setup.controller != HOGAN:
        assert np.ptp(expected[f"controller.p_hat[{PAYLOAD + 1}]"]) > 0.2  # kg: the estimates took part
    if name == "puma":
        assert any(expected[f"actuator.saturated[{i + 1}]"].any() for i in range(JOINTS))
    if "all" in name:
        assert all(np.ptp(expected[f"plant.F_ext[{i + 1}]"]) > 0.01 for i in range(6))  # N, N.m: moments took part
