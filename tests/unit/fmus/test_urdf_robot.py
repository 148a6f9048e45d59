"""An arm from a URDF file as a robot for FMUs: the posture, the task on a table, rotors, and what is refused."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fmus.catalog import model
from fmus.control.adaptation import SIZES
from fmus.mechanics.rigid_body import Body, Placement, RobotError
from fmus.robots import posture, table_path
from fmus.robots.puma560 import PUMA, puma560
from fmus.robots.spatial_robot import SpatialRobot
from fmus.robots.substep import STABLE, STEPS, friction_rate
from fmus.robots.table_path import MARGIN, Fitting, NoPathError, TableArm, motion
from fmus.robots.table_path import SIZES as ELLIPSES
from fmus.robots.urdf_robot import robot_of_urdf, suffix_of
from tests.property.robots import ROBOTS
from tests.scenarios.pages import ROOT
from tests.scenarios.tutorial import blocks

URDF = next(block.text for block in blocks(ROOT / "docs" / "your-robot.md") if block.file == "arm6.urdf")
"""The arm of docs/your-robot.md."""
PANDA = ROBOTS / "panda_description" / "urdf" / "panda.urdf"
FINGERS = {"panda_finger_joint1": 0.0, "panda_finger_joint2": 0.0}


@pytest.fixture(scope="module")
def arm6(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its file."""
    path = tmp_path_factory.mktemp("arm6") / "arm6.urdf"
    path.write_text(URDF, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def robot(arm6: Path) -> SpatialRobot:
    """The arm with a payload, in a posture that is chosen."""
    return robot_of_urdf(arm6, "tool", payload=0.8)


@pytest.fixture(scope="module")
def panda() -> SpatialRobot:
    """An arm of seven joints, whose fingers are held."""
    return robot_of_urdf(PANDA, "panda_hand_tcp", locked=FINGERS, payload=0.5)


def edited(arm6: Path, folder: Path, old: str, new: str) -> Path:
    """The file with a text in the place of another one that it has once."""
    text = arm6.read_text(encoding="utf-8")
    assert text.count(old) == 1
    path = folder / "edited.urdf"
    path.write_text(text.replace(old, new), encoding="utf-8")
    return path


def test_the_same_file_gives_the_same_posture(arm6: Path, robot: SpatialRobot) -> None:
    again = robot_of_urdf(arm6, "tool", payload=0.8)
    assert (again.start, again.path) == (robot.start, robot.path)


@pytest.mark.parametrize("name", ["robot", "panda"])
def test_the_tool_points_down_ahead_of_the_base_and_begins_on_top_of_the_ellipse(
    name: str, request: pytest.FixtureRequest
) -> None:
    one: SpatialRobot = request.getfixturevalue(name)
    R, position = (np.array(value) for value in one.arm.tip_frame(one.start.q))
    np.testing.assert_allclose(R[:, 2], [0, 0, -1], atol=2e-4)  # the reference orientation has four decimals
    top = np.add(one.path.center, (0, 0, one.path.semi_axis[0]))
    np.testing.assert_allclose(position.ravel(), top, rtol=0, atol=1e-9)
    assert position[0, 0] > 0.2
    assert abs(position[1, 0]) < 1e-3


@pytest.mark.parametrize("name", ["robot", "panda"])
def test_limits_hold_all_along_the_ellipse(name: str, request: pytest.FixtureRequest) -> None:
    """Followed here in steps of its own, by the rates of least norm: ranges, rates, and torques of the free motion."""
    one: SpatialRobot = request.getfixturevalue(name)
    arm, count = one.arm, 4000
    q, dt = np.array(one.start.q), 2.0 / count
    table = TableArm(one.chain, one.payload)
    for k in range(count):
        x = motion(one.path, 2 * np.pi * k / count)
        J = np.array(arm.jacobian(q))
        dq = np.linalg.pinv(J) @ [*x[1], 0, 0, 0]
        for value, rate, joint in zip(q, dq, one.chain.joints, strict=True):
            width = joint.limits.upper - joint.limits.lower
            room = MARGIN * width - 0.01 if np.isfinite(width) else 0.0  # points of the rule are 6 deg apart
            assert joint.limits.lower + room <= value <= joint.limits.upper - room
            assert abs(rate) <= joint.limits.velocity
        if k % 100 == 0:
            ddq = np.linalg.pinv(J) @ ([*x[2], 0, 0, 0] - np.array(arm.jacobian_rate(q, dq)) @ dq)
            tau = np.array(arm.inverse_dynamics(q, dq, dq, ddq, table.p, [0, 0, -9.81], 0.01)).ravel()
            assert np.all(np.abs(tau) <= one.joints.efforts)
        q = q + dt * dq
    assert np.abs(motion(one.path, 0)[0] - np.array(arm.tip_frame(q)[1]).ravel()).max() < 0.01  # it came round


def test_a_tip_whose_axis_1_points_up_keeps_its_orientation() -> None:
    """Roll and yaw turn about one axis there: the angles of the reference are still those of the tip."""
    near = np.array([0.3, -1.335, 3.355, 0.0, np.pi / 2 - (3.355 - 1.335) + np.pi / 2, 0.2])
    chain = puma560(Placement.from_rpy((0.0, 0.0, 0.15), (0.0, np.pi / 2, 0.0)))
    table = TableArm(chain, Body("payload", 0.5))
    R = np.array(table.at(near)[0])
    assert abs(R[2, 0]) == pytest.approx(1.0, abs=1e-15)
    path = table.path(near, 0.3)
    np.testing.assert_allclose(Placement.from_rpy(np.zeros(3), path.reference).R, R, rtol=0, atol=1e-4)  # 4 decimals
    np.testing.assert_allclose(SpatialRobot(chain, tuple(near), path).start.q, near, rtol=0, atol=1e-3)


@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, -0.6, 0.8), (0.36, 0.48, 0.8)])
def test_an_orientation_half_a_turn_away_is_not_taken_for_the_same(axis: tuple[float, ...]) -> None:
    """At a half turn the antisymmetric part of the rotation, whose length is the sine, vanishes."""
    half = 2 * np.outer(axis, axis) - np.eye(3)
    assert abs(np.dot(table_path.rotation_vector(half), axis)) == pytest.approx(1.0, abs=1e-14)


def test_the_path_of_the_puma_fits_by_the_same_rule() -> None:
    table = TableArm(PUMA.chain, PUMA.payload)
    assert table.checked(np.array(PUMA.start.q), PUMA.path) > 0.1
    heavy = TableArm(PUMA.chain, Body("payload", 12.0))
    with pytest.raises(NoPathError, match=r"joint 2 needs \d+ of its 186 N\.m at 1\d\d deg of the ellipse"):
        heavy.checked(np.array(PUMA.start.q), PUMA.path)


def test_the_impact_that_the_rule_foresees_is_that_of_the_target_impedance() -> None:
    """By its own numbers: those of the controllers and of the wall, and the force of a spring that is hit."""
    starts = {
        one.name: one.start for name in ("HoganImpedancePuma560", "PlantPuma560") for one in model(name).variables
    }
    assert (table_path.M, table_path.B, table_path.K) == (starts["M[1]"], starts["B[1]"], starts["K[1]"])
    assert starts["K_f"] == table_path.K_F
    force, acceleration = table_path.impact()
    without_damper = np.sqrt(table_path.K_F * table_path.M)
    assert 0.8 * without_damper < force.max() < 2 * without_damper
    assert acceleration[0] == 0
    assert acceleration.min() < 0


def test_a_smaller_ellipse_is_taken_where_the_larger_one_does_not_fit(arm6: Path, robot: SpatialRobot) -> None:
    text = arm6.read_text(encoding="utf-8")
    slow = arm6.with_name("slow.urdf")
    slow.write_text(re.sub(r'velocity="[34]"', 'velocity="0.5"', text), encoding="utf-8")
    smaller = robot_of_urdf(slow, "tool", start=robot.start.q)
    across = [one.path.semi_axis[1] / one.chain.reach for one in (robot, smaller)]
    assert across[0] == pytest.approx(0.16, abs=1e-3)
    assert min(abs(across[1] / 0.16 - size) for size in ELLIPSES[1:]) < 1e-3


@pytest.mark.parametrize(
    ("start", "sentence"),
    [
        (
            (0, 0.2, 1.6, 0, 1.3),
            r"Robot arm6: 5 joint coordinates are given for the start, but the arm has 6 joints; .*",
        ),
        ((0, 2.5, 1.6, 0, 1.3, 0), r"joint shoulder would start at 2\.5, but its range is from -2 to 2 rad; start it"),
        ((0, 0.2, float("nan"), 0, 1.3, 0), r"give a finite number for each, in this order: waist, shoulder, elbow"),
        (
            (0, 0, 0, 0, 0, 0),
            r"no ellipse fits: even with 0\.2 of its size, the arm is nearly singular at 0 deg of the",
        ),
        (
            (0, 1.95, 1, 0, 1, 0),
            r"no ellipse fits: even with 0\.2 of its size, joint shoulder comes to 1\.95 rad, but its",
        ),
    ],
)
def test_a_start_that_does_not_fit_is_refused(arm6: Path, start: tuple[float, ...], sentence: str) -> None:
    with pytest.raises(RobotError, match=sentence):
        robot_of_urdf(arm6, "tool", start=start)


def test_a_weak_arm_is_told_which_joint_is_too_weak(arm6: Path, robot: SpatialRobot, tmp_path: Path) -> None:
    weak = edited(arm6, tmp_path, 'velocity="3" effort="80"', 'velocity="3" effort="2"')
    with pytest.raises(NoPathError, match=r"joint elbow needs [\d.]+ of its 2 N\.m at 0 deg of the ellipse"):
        robot_of_urdf(weak, "tool", start=robot.start.q)


def test_an_arm_that_cannot_move_fast_enough_has_no_posture(arm6: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(posture, "TRIED", 20)  # 1000 take half a minute, and say the same
    text = arm6.read_text(encoding="utf-8")
    slow = arm6.with_name("too_slow.urdf")
    wide = re.sub(r'lower="-[\d.]+" upper="[\d.]+"', 'lower="-6.2" upper="6.2"', text)  # rates alone are in the way
    slow.write_text(re.sub(r'velocity="[34]"', 'velocity="0.001"', wide), encoding="utf-8")
    with pytest.raises(
        NoPathError, match=r"in none of 20 postures .* fits; the most promising one: .* of its 0\.001 rad/s"
    ):
        robot_of_urdf(slow, "tool")


def test_arms_with_too_few_joints_or_without_drive_are_refused(arm6: Path, tmp_path: Path) -> None:
    with pytest.raises(RobotError, match=r"5 joints move between base and wrist \(waist, .*need 6; choose another tip"):
        robot_of_urdf(arm6, "wrist", locked={"flange_roll": 0.0})
    still = edited(arm6, tmp_path, 'effort="20"', 'effort="0"')
    with pytest.raises(RobotError, match=r'joint flange_roll has <limit effort="0">, so that it cannot move'):
        robot_of_urdf(still, "tool")


def test_all_joints_that_branch_off_are_named_at_once() -> None:
    """A hand has twenty of them; nobody wants to read twenty messages."""
    with pytest.raises(RobotError, match=r"locked=\{'panda_finger_joint1': 0\.0\}, .* too, .*: panda_finger_joint2\.$"):
        robot_of_urdf(PANDA, "panda_hand_tcp")
    deep = ROBOTS / "talos_data" / "robots" / "talos_full_v2.urdf"
    with pytest.raises(RobotError, match="gripper_left_inner_double_joint, gripper_left_fingertip_1_joint, "):
        robot_of_urdf(deep, "arm_left_7_link", base="torso_2_link")
    with pytest.raises(RobotError, match=r"panda_finger_joint2 .* part of the link\.$"):
        robot_of_urdf(PANDA, "panda_hand_tcp", locked={"panda_finger_joint1": 0.0})


def test_stiff_friction_asks_for_a_rotor_and_is_integrated_with_it(arm6: Path, tmp_path: Path) -> None:
    stiff = edited(arm6, tmp_path, '<dynamics damping="0.1"/>', '<dynamics damping="1" friction="2"/>')
    with pytest.raises(
        RobotError, match=r"joint flange_roll has damping 1 N\.m\.s/rad and friction 2 N\.m against the small inert"
    ):
        robot_of_urdf(stiff, "tool", start=(0, 0.25, 1.56, 0, 1.33, 0))
    given = robot_of_urdf(stiff, "tool", start=(0, 0.25, 1.56, 0, 1.33, 0), rotor={"flange_roll": 0.02})
    fastest = friction_rate(given.arm, np.array(given.start.q), given.chain.p)
    assert fastest.rate * given.dt_max <= STABLE
    assert given.dt_max in STEPS[:-1]
    assert fastest.rate * 2.5 * given.dt_max > STABLE  # the next one would be too long
    assert [joint.rotor_inertia for joint in given.chain.joints] == [0.0] * 5 + [0.02]
    every = robot_of_urdf(stiff, "tool", start=(0, 0.25, 1.56, 0, 1.33, 0), rotor=0.05)
    assert {joint.rotor_inertia for joint in every.chain.joints} == {0.05}
    with pytest.raises(RobotError, match="there is no joint flange that moves; the arm has waist, shoulder, elbow"):
        robot_of_urdf(stiff, "tool", rotor={"flange": 0.02})


def test_names_of_models_are_identifiers() -> None:
    assert [suffix_of(name) for name in ("ur5_robot", "my-arm.v2", "7dof")] == ["Ur5Robot", "MyArmV2", "7dof"]
    assert [suffix_of(name) for name in ("Ärmchen Grün 6", "bras-élevé")] == ["ArmchenGrun6", "BrasEleve"]
    with pytest.raises(RobotError, match="no letter from A to Z"):
        suffix_of("机器人")
    with pytest.raises(RobotError, match=r"Robot a{20}\.\.\.: the name has 300 letters and digits, .* take 100"):
        suffix_of("a" * 300)


def test_gains_of_a_payload_go_with_the_square_of_the_sizes() -> None:
    starts = {one.name: one.start for one in model("SlotineLiAdaptiveImpedancePuma560").variables}
    of_mass, of_moment, of_inertia = (float(starts[f"Gamma[{i}]"] or 0) for i in (79, 80, 83))
    assert of_mass > 0
    assert of_moment == pytest.approx(of_mass * SIZES["kg.m"] ** 2)
    assert of_inertia == pytest.approx(of_mass * SIZES["kg.m2"] ** 2)
    assert SIZES["kg.m2"] == pytest.approx(SIZES["kg.m"] ** 2)


def test_points_of_the_search_fill_the_cube_evenly() -> None:
    """In each of 64 boxes of eight dimensions' first two, a share of 1/64 within a third of it."""
    points = posture.evenly_spread(6400, 8)
    assert points.min() >= 0
    assert points.max() < 1
    counts, _, _ = np.histogram2d(points[:, 0], points[:, 1], bins=8, range=[[0, 1], [0, 1]])
    np.testing.assert_allclose(counts, 100, atol=33)


def test_the_smallest_turn_takes_one_axis_to_the_other() -> None:
    random = np.random.default_rng(3)
    for a in [*random.normal(size=(20, 3)), np.array([0, 0, 1.0])]:
        unit = a / np.linalg.norm(a)
        R = posture.turn(unit, posture.DOWN)
        np.testing.assert_allclose(R @ unit, posture.DOWN, atol=1e-12)
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
        assert np.linalg.det(R) == pytest.approx(1)


def test_a_posture_is_kept_within_a_smaller_range(robot: SpatialRobot) -> None:
    """Half the range of a joint about another middle moves the posture there."""
    waist, *others = robot.chain.joints
    limits = replace(waist.limits, lower=1.0, upper=3.0)
    chain = replace(robot.chain, joints=(replace(waist, limits=limits), *others))
    found: Fitting = posture.chosen_posture(TableArm(chain, robot.payload))
    assert 1.1 <= found.q[0] <= 2.9
