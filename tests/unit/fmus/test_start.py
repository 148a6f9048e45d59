"""Tests that the FMUs' start values fit together: arm, ellipse and inputs agree at t0, every default is finite."""

from collections.abc import Callable

import numpy as np
import pytest

from fmus import start
from fmus.catalog import MODELS
from fmus.mechanics.planar_arm import PlanarArm
from tests.driver import Driver

Open = Callable[..., Driver]
# q and dq are given to ten decimals: off by 5e-11 each, times a reach of 1.5 m and 1 m, and in velocities also the
# errors of q times pi m/s: below 4e-10 in all.
PRINTED = 5e-10


def vector(values: dict[str, float], name: str) -> np.ndarray:
    """Elements 1 and 2 of a vector."""
    return np.array([values[f"{name}[1]"], values[f"{name}[2]"]])


def starts(driver: Driver) -> dict[str, float]:
    """Start values of inputs and parameters."""
    return {name: float(v.start) for name, v in driver.variables.items() if v.type == "Real" and v.start is not None}


def defaults(open_fmu: Open, name: str, t0: float = 0.0) -> Driver:
    """An FMU initialized with nothing set."""
    driver = open_fmu(name)
    driver.initialize(t0=t0)
    return driver


@pytest.mark.parametrize("name", MODELS)
def test_every_unit_initialized_with_its_defaults_shows_finite_outputs(open_fmu: Open, name: str) -> None:
    driver = defaults(open_fmu, name)
    assert all(np.isfinite(value) for value in driver.outputs().values())
    assert driver.outputs()
    driver.step(0.0, 1e-4)
    assert all(np.isfinite(value) for value in driver.outputs().values())
    assert not driver.messages


@pytest.mark.parametrize("n", start.ARMS)
def test_the_arms_start_on_the_ellipse_with_its_velocity(n: int) -> None:
    arm, begin = PlanarArm(n), start.ARMS[n]
    x = np.array(arm.forward_kinematics(begin.q, begin.link_lengths)).ravel()
    dx = np.array(arm.jacobian(begin.q, begin.link_lengths)) @ begin.dq
    np.testing.assert_allclose(x, (1.5, 0), rtol=0, atol=PRINTED)
    np.testing.assert_allclose(dx, (0, np.pi), rtol=0, atol=PRINTED)


def test_the_paper_s_elbow_is_bent_to_the_left() -> None:
    assert start.ARMS[2].q[1] == pytest.approx(np.arccos(1.5**2 / 2 - 1), abs=PRINTED)


@pytest.mark.parametrize("name", ["Plant", "Plant3R"])
def test_plant_and_trajectory_meet_at_the_start(open_fmu: Open, name: str) -> None:
    plant, trajectory = defaults(open_fmu, name).outputs(), defaults(open_fmu, "VirtualTrajectory").outputs()
    np.testing.assert_allclose(vector(plant, "x"), vector(trajectory, "x_v"), rtol=0, atol=PRINTED)
    np.testing.assert_allclose(vector(plant, "dx"), vector(trajectory, "dx_v"), rtol=0, atol=PRINTED)
    np.testing.assert_array_equal(vector(trajectory, "x_v"), start.X_V)
    np.testing.assert_array_equal(vector(trajectory, "dx_v"), start.DX_V)
    np.testing.assert_array_equal(vector(trajectory, "ddx_v"), start.DDX_V)
    assert (vector(plant, "F_ext") == 0).all()
    assert plant["gap"] < 0


@pytest.mark.parametrize("name", [n for n in MODELS if n.endswith("Impedance")])
def test_inputs_of_controllers_start_where_plant_and_trajectory_are(open_fmu: Open, name: str) -> None:
    inputs = starts(open_fmu(name))
    plant, trajectory = (
        defaults(open_fmu, "Plant").outputs(),
        defaults(open_fmu, "VirtualTrajectory").outputs(),
    )
    for signal, source in (
        ("q", plant),
        ("dq", plant),
        ("x_v", trajectory),
        ("dx_v", trajectory),
        ("ddx_v", trajectory),
    ):
        np.testing.assert_array_equal(vector(inputs, signal), vector(source, signal))
    np.testing.assert_allclose(vector(inputs, "ddq"), vector(plant, "ddq"), rtol=0, atol=PRINTED)
    np.testing.assert_array_equal(vector(inputs, "F_hat"), vector(plant, "F_ext"))


@pytest.mark.parametrize("name", [n for n in MODELS if n.endswith("Impedance")])
def test_the_arm_s_parameters_start_equal_everywhere(open_fmu: Open, name: str) -> None:
    controller, plant = starts(open_fmu(name)), starts(open_fmu("Plant"))
    np.testing.assert_array_equal(vector(controller, "l"), vector(plant, "l"))
    np.testing.assert_array_equal([controller[f"p_start[{i}]"] for i in (1, 2)], vector(plant, "m"))
    assert controller["gravity"] == plant["gravity"]
    assert controller["coulomb_velocity"] == plant["coulomb_velocity"]


def test_wall_and_segment_start_equal(open_fmu: Open) -> None:
    plant, trajectory = starts(open_fmu("Plant")), starts(open_fmu("VirtualTrajectory"))
    np.testing.assert_array_equal(vector(plant, "wall_normal"), vector(trajectory, "wall_normal"))
    assert plant["wall_offset"] == trajectory["wall_offset"]


def test_sampled_units_share_one_sample_time(open_fmu: Open) -> None:
    periods = {name: starts(open_fmu(name)).get("sample_time") for name in MODELS if not name.startswith("Plant")}
    assert set(periods.values()) == {1e-4}
