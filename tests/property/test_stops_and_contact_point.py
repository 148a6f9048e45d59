"""Stops of joints push and take power; a contact point moves as its position does, with the power of its wrench."""

from collections.abc import Sequence

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from adaptimp_fmu import ContinuousModel
from fmus.environment.contact import Wall
from fmus.environment.contact_point import declare_contact_point
from fmus.environment.joint_stops import JointStops, declare_joint_stops
from fmus.mechanics.chain import JointLimits
from fmus.mechanics.joints import Joints
from fmus.mechanics.spatial_arm import SpatialArm
from fmus.mechanics.spatial_model import SpatialArmModel
from tests.property.robots import GRAVITY, chain
from tests.property.samples import EPS, evaluate

PROFILE = settings(derandomize=True, database=None, deadline=None, max_examples=200)
K = 1e4  # N.m/rad
LOWER, UPPER = -1.5, 2.0  # rad
angles = st.floats(-2.0, 2.5, allow_subnormal=False)
rates = st.floats(-5, 5, allow_subnormal=False)
dampings = st.sampled_from([0.0, 0.3, 1.0, 20.0])  # s/rad
ROUNDING = 200 * EPS * K * 0.5 * 200  # N.m: depths up to 0.5 rad, factors up to 200


def torque(q: float, dq: float, damping: float, ends: tuple[float, float] = (LOWER, UPPER)) -> float:
    """Torque of the stops on one joint, N.m."""
    stops = JointStops(*(ca.SX(value) for value in (*ends, K, damping)))
    return float(stops.torque(ca.SX(q), ca.SX(dq), ca.SX(float(stops.depth(ca.SX(q)) > 0))))


@PROFILE
@given(angles, rates, dampings)
def test_a_stop_pushes_back_and_never_pulls(q: float, dq: float, damping: float) -> None:
    found = torque(q, dq, damping)
    if LOWER <= q <= UPPER:
        assert found == 0
    else:
        assert found < 0 if q > UPPER else found > 0
        depth, u = (q - UPPER, damping * dq) if q > UPPER else (LOWER - q, -damping * dq)
        assert abs(abs(found) - K * depth * np.exp(np.arcsinh(u))) <= ROUNDING


@PROFILE
@given(angles, rates, dampings)
def test_a_stop_gives_back_no_more_than_its_spring_stored(q: float, dq: float, damping: float) -> None:
    """Power into the stop is at least the growth of K depth^2 / 2, with equality without damping."""
    sign, depth = (1, q - UPPER) if q > UPPER else (-1, LOWER - q)
    surplus = -torque(q, dq, damping) * dq - K * max(depth, 0.0) * sign * dq
    assert surplus >= -5 * ROUNDING
    if damping == 0:
        assert surplus <= 5 * ROUNDING


@PROFILE
@given(angles, rates, dampings)
def test_both_ends_are_mirror_images(q: float, dq: float, damping: float) -> None:
    assert torque(q, dq, damping) == -torque(-q, -dq, damping, (-UPPER, -LOWER))


def test_slides_have_units_and_texts_of_their_own() -> None:
    joints = Joints(
        ("joint turn", "joint lift"), (True, False), (JointLimits(-1, 2), JointLimits(0, 0.35, effort=2000))
    )
    model = ContinuousModel("Arm", "An arm with a slide")
    q_start = model.parameter("q_start", [0.0, 0.0], description="Start")
    declare_joint_stops(model, joints, np.array([0.5, 40.0]), q_start)
    told = {v.name: (v.start, v.unit, v.description) for v in model.variables}
    assert told["q_max[1]"] == (2.0, "rad", "Upper end of the range of joint turn; 1e9 = none")
    assert told["q_max[2]"] == (0.35, "m", "Upper end of the range of joint lift; 1e9 = none")
    # 300^2 times the inertia, which holds 2000 N by far.
    assert told["stop_stiffness[1]"] == (4.5e4, "N.m/rad", "Stiffness of the stops of joint turn")
    assert told["stop_stiffness[2]"] == (
        3.6e6,
        "N/m",
        "Stiffness of the stops of joint lift",
    )
    assert told["stop_damping[2]"][1] == "s/m"


def declared(name: str) -> tuple[Sequence[ca.SX], ca.Function]:
    """Symbols q, dq, contact_point and a force; position, velocity and wrench of a point of an arm's tip."""
    arm = SpatialArm(chain(name))
    reference = ca.SX(ca.DM.eye(3))
    q, dq, force = (ca.SX.sym(*one) for one in (("q", arm.n), ("dq", arm.n), ("force", 3)))
    model = ContinuousModel("Arm", "An arm")
    known = SpatialArmModel(arm, ca.SX(ca.DM(GRAVITY)), ca.SX(0.01), reference)
    point = declare_contact_point(model, known, q, dq)
    place = model.parameter_symbols[-1]
    moving = ca.jtimes(point.position, q, dq)
    power = ca.dot(arm.jacobian(q) @ dq, point.wrench(force))
    results = [ca.vertcat(point.velocity, moving, power, ca.dot(force, point.velocity), point.position)]
    return (q, dq, place, force), ca.Function("point", [q, dq, place, force], results)


@pytest.mark.parametrize("name", ["PUMA", "TIAGo"])
def test_a_point_of_contact_moves_as_its_position_does(name: str) -> None:
    (q, *_), function = declared(name)
    rng = np.random.default_rng(7)
    columns = [rng.uniform(-b, b, (k, 200)) for b, k in ((2, q.numel()), (2, q.numel()), (0.3, 3), (100, 3))]
    found = evaluate(function, *columns)[..., 0]
    velocity, moving, powers = found[:, :3], found[:, 3:6], found[:, 6:8]
    np.testing.assert_allclose(velocity, moving, rtol=0, atol=500 * EPS * np.abs(moving).max())
    np.testing.assert_allclose(powers[:, 0], powers[:, 1], rtol=0, atol=500 * EPS * np.abs(powers).max())
    R, position = SpatialArm(chain(name)).tip_frame(columns[0][:, 0])
    expected = np.array(position).ravel() + np.array(R) @ columns[2][:, 0]
    np.testing.assert_allclose(found[0, 8:], expected, rtol=0, atol=10 * EPS)


def test_friction_in_space_has_the_slope_of_its_law_at_rest() -> None:
    """The derivative by the velocity is finite where the tip rests: mu F_n / friction_velocity along the surface."""
    v = ca.SX.sym("v", 3)
    wall = Wall(ca.SX(ca.DM([0, 0, -1])), *(ca.SX(value) for value in (0.7, 1e5, 0.0, 0.4, 0.02)))
    force = wall.force(ca.SX(ca.DM([0.3, 0.1, -0.71])), v, ca.SX(1), ca.SX(1))
    slope = np.array(ca.Function("slope", [v], [ca.densify(ca.jacobian(force, v))])(np.zeros(3)))
    pressed = 1e5 * 0.01  # N
    np.testing.assert_allclose(slope, np.diag([20.0, 20.0, 0.0]) * pressed, rtol=1e-12)
