"""Names, units and limits of joints in FMUs, for arms whose joints turn and slide."""

from dataclasses import replace

import numpy as np
import pytest

from adaptimp_fmu import Model
from fmus.catalog import model, unit_of_arm
from fmus.mechanics.chain import Chain, Joint, JointKind, JointLimits
from fmus.mechanics.joints import NONE, Joints
from fmus.mechanics.rigid_body import Body
from fmus.robots.puma560 import PUMA, puma560
from fmus.robots.spatial_robot import SpatialRobot

LIFT = Joint("lift", Body("carriage", 3.0), kind=JointKind.PRISMATIC, limits=JointLimits(-0.1, 0.5, effort=800.0))
TURN = Joint("Joint_2", Body("link", 1.0, (0.1, 0.0, 0.0), (0.1, 0.0, 0.1, 0.0, 0.0, 0.1)))


def variables(declared: Model) -> dict[str, tuple[str, str, str]]:
    """Unit, display unit and description of each variable."""
    return {one.name: (one.unit, one.display_unit, one.description) for one in declared.variables}


def test_joints_of_a_chain_have_its_names_kinds_and_limits() -> None:
    joints = Joints.of(Chain("lift and arm", (LIFT, TURN)))
    assert joints.labels == ("joint lift", "joint 2")
    assert joints.each("rad", "m") == ["m", "rad"]
    assert joints.texts("Angle", "Position") == ["Position of joint lift", "Angle of joint 2"]
    assert joints.texts("Rate") == ["Rate of joint lift", "Rate of joint 2"]
    assert joints.efforts == [800.0, NONE]
    assert joints.ranges == ([-0.1, -NONE], [0.5, NONE])


@pytest.mark.parametrize("name", ["PlantPuma560", "HoganImpedancePuma560", "ActuatorPuma560"])
def test_units_of_a_turning_arm_are_those_of_angles_and_torques(name: str) -> None:
    found = variables(model(name))
    expected = {"q[2]": ("rad", "deg"), "dq[2]": ("rad/s", "deg/s"), "ddq[2]": ("rad/s2", "deg/s2")}
    expected |= {"tau[2]": ("N.m", ""), "tau_cmd[2]": ("N.m", ""), "q_start[2]": ("rad", "deg")}
    shared = expected.keys() & found.keys()
    assert shared
    for variable in shared:
        unit, shown, text = found[variable]
        assert (unit, shown) == expected[variable]
        assert text.partition(";")[0].endswith("of joint 2")


def test_an_actuator_of_a_slide_gives_a_force() -> None:
    found = variables(unit_of_arm("Actuator", _with_slide(), "Lifted"))
    assert found["tau_cmd[1]"] == ("N", "", "Commanded force of joint lift")
    assert found["tau_max[1]"] == ("N", "", "Largest absolute force of joint lift; 1e9 = no limit")
    assert found["tau_rate_max[1]"][0] == "N/s"
    assert found["tau[2]"] == ("N.m", "", "Torque of joint 1")


def test_plant_and_controller_of_a_slide_agree_on_its_units() -> None:
    robot = _with_slide()
    plant, controller = (variables(unit_of_arm(unit, robot, "Lifted")) for unit in ("Plant", "HoganImpedance"))
    assert plant["q[1]"] == ("m", "mm", "Position of joint lift")
    assert plant["q_start[1]"] == ("m", "mm", "Position at the start of joint lift")
    assert (plant["dq[1]"][0], plant["ddq[1]"][0], plant["tau[1]"][0]) == ("m/s", "m/s2", "N")
    for name in ("q", "dq", "ddq"):
        for i in range(1, 8):
            assert plant[f"{name}[{i}]"][:2] == controller[f"{name}[{i}]"][:2]
    assert controller["tau_cmd[1]"][0] == "N"


def test_texts_of_an_arm_with_a_slide_have_its_units() -> None:
    robot = _with_slide()
    plant, controller = (unit_of_arm(unit, robot, "Lifted") for unit in ("Plant", "HoganImpedance"))
    found = variables(controller)
    assert found["limit_torque[1]"] == ("N", "", "Largest force of the repulsion of joint lift; 1e9 = no limit")
    assert found["limit_torque[2]"] == ("N.m", "", "Largest torque of the repulsion of joint 1; 1e9 = no limit")
    for one in (variables(plant), found):
        assert one["coulomb_velocity"][2].endswith("(tanh); in m/s for joints that slide")
    held, pressed, _ = (example.code for example in plant.guide.examples)
    assert held.count("# N, N.m, N.m, N.m, N.m, N.m, N.m\n") == 1
    assert "# N/m, N.m/rad, N.m/rad," in pressed
    assert variables(model("PlantPuma560"))["coulomb_velocity"][2].endswith("(tanh)")


def test_trajectory_and_controllers_say_the_same_of_the_virtual_motion() -> None:
    """The rates of roll, pitch and yaw are no angular velocity."""
    given, taken = variables(model("VirtualTrajectoryPuma560")), variables(model("CraigAdaptiveImpedancePuma560"))
    for name in (f"{vector}[{i}]" for vector in ("x_v", "dx_v", "ddx_v") for i in range(1, 7)):
        assert given[name] == taken[name]
    assert taken["dx_v[4]"][2] == "Virtual rate of the tip in roll"


def test_actuators_of_the_puma_start_at_its_largest_torques() -> None:
    """Armstrong, Khatib and Burdick (1986), table of motors."""
    starts = {one.name: one.start for one in model("ActuatorPuma560").variables}
    assert [starts[f"tau_max[{i}]"] for i in range(1, 7)] == [97.6, 186.4, 89.4, 24.2, 20.1, 21.3]


def test_ranges_of_the_puma_are_symmetric_about_an_arm_that_points_up() -> None:
    """135 deg to both sides of the upper arm pointing up, and of the straight arm: signs of q2 and q3 by geometry."""
    lower, upper = np.degrees(Joints.of(puma560()).ranges)
    middle = np.radians((lower + upper) / 2)
    np.testing.assert_allclose((upper - lower)[1:3], 270)
    height = np.array(PUMA.arm.tip_frame([0, middle[1], middle[2], 0, 0, 0])[1]).ravel()[2]
    assert height == pytest.approx(0.4318 + 0.4331 + 0.15, abs=1e-12)  # upper arm, forearm, tool


def _with_slide() -> SpatialRobot:
    """The PUMA on a lift; its first link needs all ten numbers there."""
    waist, *others = PUMA.chain.joints
    body = Body("link1", 5.0, inertia=(0.35, 0.0, 0.35, 0.0, 0.0, 0.35))
    joints = (LIFT, replace(waist, body=body), *others)
    return replace(PUMA, chain=replace(PUMA.chain, joints=joints), near=(0.0, *PUMA.near))
