"""Spatial arms as control laws ask for them: coordinates (p, phi), analytic Jacobian, parameters and demands."""

from dataclasses import replace
from functools import cache

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from adaptimp_fmu.units import base_exponents
from fmus.control.impedance import ArmEstimate, Measured, torque_mobility, torque_operational, torque_resolved
from fmus.control.tirt import Impedance
from fmus.mechanics.arm import ArmModel
from fmus.mechanics.rigid_body import Body, RobotError, merged
from fmus.mechanics.spatial_arm import SpatialArm
from fmus.mechanics.spatial_model import SpatialArmModel
from tests.property.robots import GRAVITY, NAMES, chain
from tests.property.samples import EPS, evaluate

STATES = 200
REFERENCE = Rotation.from_euler("xyz", [2.0, 0.3, -1.0]).as_matrix()
SIX = [name for name in NAMES if name not in ("planar 3R", "slide")]
"""Arms with at least six joints."""


@cache
def arm(name: str) -> ArmModel:
    return SpatialArmModel(SpatialArm(chain(name)), ca.SX(ca.DM(GRAVITY)), ca.SX(0.2), ca.SX(ca.DM(REFERENCE)))


PAYLOAD = Body("payload", 1.3, (0.05, -0.02, 0.1), (0.004, 0.0005, 0.006, -0.0003, 0.0002, 0.003))
"""A body in the frame of the tip."""


@cache
def numbers(name: str) -> np.ndarray:
    """Parameters of an arm with the payload, shape (13 n + 10,)."""
    return np.concatenate([chain(name).p, PAYLOAD.parameters])


@cache
def states(n: int) -> tuple[np.ndarray, ...]:
    """q, dq, v, a, each of shape (n, STATES)."""
    rng = np.random.default_rng(17)
    return tuple(rng.uniform(-limit, limit, (n, STATES)) for limit in (np.pi, 2.0, 2.0, 5.0))


def symbols(n: int) -> list[ca.SX]:
    return [ca.SX.sym(name, n) for name in ("q", "dq", "v", "a")]


def values(arguments: list[ca.SX], expression: ca.SX, *columns: np.ndarray) -> np.ndarray:
    return evaluate(ca.Function("f", arguments, [ca.densify(expression)]), *columns)


@pytest.mark.parametrize("name", SIX)
def test_jacobian_and_its_rate_are_derivatives(name: str) -> None:
    """J_a of the coordinates, and dJ_a by finite steps, each with the error that the singular pitch leaves."""
    model = arm(name)
    q, dq, *_ = symbols(model.n)
    at, rate, *_ = states(model.n)
    cosine = np.cos(values([q], model.forward_kinematics(q)[4], at))
    J = values([q], model.jacobian(q), at)
    derived = values([q], ca.jacobian(model.forward_kinematics(q), q), at)
    size = np.abs(J).max(axis=(1, 2), keepdims=True)
    assert np.all(np.abs(J - derived) <= 200 * EPS * np.maximum(1, size) / cosine**2)
    h = 1e-5
    steps = [values([q], model.jacobian(q), at + s * h * rate) for s in (-1, 1)]
    finite = (steps[1] - steps[0]) / (2 * h)
    found = values([q, dq], model.jacobian_rate(q, dq), at, rate)
    # Central differences miss h^2 / 6 times the third derivative, whose terms grow by 1 / cos(pitch)^4, with
    # |w| < 20 rad/s; and they lose EPS / h.
    bound = (h**2 / 6 * 20**3 / cosine**4 + 100 * EPS / h / cosine**2) * np.maximum(1, size)
    assert np.all(np.abs(found - finite) <= bound)


@pytest.mark.parametrize("name", SIX)
def test_torque_is_linear_in_the_named_parameters(name: str) -> None:
    model = arm(name)
    q, dq, v, a = arguments = symbols(model.n)
    p = ca.SX.sym("p", len(model.parameters))
    number = np.tile(numbers(name)[:, None], STATES)
    Y = values(arguments, model.regressor(*arguments), *states(model.n))
    torque = values([*arguments, p], model.inverse_dynamics(q, dq, v, a, p), *states(model.n), number)
    assert Y.shape[2] == len(model.parameters) == len(number)
    np.testing.assert_allclose(Y @ number.T[:, :, None], torque, rtol=0, atol=200 * EPS * np.abs(torque).max())
    bias = values([q, dq, p], model.bias(q, dq, p), *states(model.n)[:2], number)
    rest = model.inverse_dynamics(q, dq, dq, ca.SX(model.n, 1), p)
    same = values([q, dq, p], rest, *states(model.n)[:2], number)
    np.testing.assert_allclose(bias, same, rtol=0, atol=200 * EPS * np.abs(bias).max())


@pytest.mark.parametrize("name", SIX)
def test_parameters_have_units_and_texts_of_their_own(name: str) -> None:
    parameters = arm(name).parameters
    for parameter in parameters:
        base_exponents(parameter.unit)
    assert all(parameter.signed for parameter, value in zip(parameters, numbers(name), strict=True) if value < 0)
    assert sum(parameter.signed for parameter in parameters) == 6 * arm(name).n + 6
    assert len({parameter.text for parameter in parameters}) == len(parameters) == 13 * arm(name).n + 10


@pytest.mark.parametrize("name", SIX)
def test_a_payload_is_a_part_of_the_last_body(name: str) -> None:
    """The torque is that of a chain whose last body was merged with the payload, number by number."""
    model, bare = arm(name), chain(name)
    last = bare.joints[-1]
    body = merged(last.body.name, [last.body, PAYLOAD.placed(bare.tip)])
    whole = replace(bare, joints=(*bare.joints[:-1], replace(last, body=body)))
    q, dq, v, a = arguments = symbols(model.n)
    p = ca.SX.sym("p", len(model.parameters))
    number = np.tile(numbers(name)[:, None], STATES)
    found = values([*arguments, p], model.inverse_dynamics(q, dq, v, a, p), *states(model.n), number)
    expected = SpatialArm(whole).inverse_dynamics(*arguments, whole.p, GRAVITY, 0.2)
    torque = values(arguments, expected, *states(model.n))
    np.testing.assert_allclose(found, torque, rtol=0, atol=500 * EPS * np.abs(torque).max())


@pytest.mark.parametrize("name", SIX)
def test_a_wrench_does_the_work_of_its_force(name: str) -> None:
    """J_a' F are the torques of the wrench, and |F| <= gain |wrench| is reached by a moment."""
    model = arm(name)
    q, dq, *_ = symbols(model.n)
    wrench = ca.SX.sym("wrench", 6)
    F, torque, gain = model.wrench_force(q, wrench), model.wrench_torque(q, wrench), model.wrench_gain(q)
    at, rate, *_ = states(model.n)
    given = np.random.default_rng(19).normal(0, 10, (6, STATES))
    power = ca.vertcat(ca.dot(ca.mtimes(model.jacobian(q), dq), F), ca.dot(dq, torque))
    works = values([q, dq, wrench], power, at, rate, given)[..., 0]
    cosine = np.cos(values([q], model.forward_kinematics(q)[4], at))[:, 0, 0]
    size = np.abs(works).max()
    assert np.all(np.abs(works[:, 0] - works[:, 1]) <= 500 * EPS * size / cosine**2)
    matrices = values([q, wrench], ca.jacobian(F, wrench), at, given)
    gains = values([q], gain, at)[:, 0, 0]
    np.testing.assert_allclose(np.linalg.norm(matrices, 2, axis=(1, 2)), gains, rtol=1e-13)


def test_sliding_joints_have_the_units_of_a_slide() -> None:
    parameters = arm("TIAGo").parameters
    assert [parameters[k].unit for k in (80, 81, 88, 89, 96, 97)] == [
        "N.s/m", "N.m.s/rad", "N", "N.m", "kg", "kg.m2",
    ]  # fmt: skip
    assert parameters[96].text == "rotor inertia of joint torso_lift_joint"


def test_demands_name_each_singularity_before_it_is_divided_by() -> None:
    """The PUMA at a right angle of joint 5, then with its wrist straight, then with a pitch of 90 degrees."""
    model = arm("PUMA")
    q = ca.SX.sym("q", 6)
    demands = model.demands(q)
    measure = ca.Function("f", [q], [ca.vertcat(*(demand.value for demand in demands))])
    regular = np.array([0.0, -0.6, 2.4, 0.3, 1.2, 0.0])
    assert np.all(np.array(measure(regular)) > 0)
    straight = regular * [1, 1, 1, 1, 0, 1]
    assert float(measure(straight)[1]) < 0
    assert [demand.sentence for demand in demands] == [
        "The tip pitches too far from its reference orientation: cos(pitch) must exceed 0.01",
        "The arm is singular: det(J J'), with positions in reaches of the arm, must exceed 1e-12",
    ]
    equations = SpatialArm(chain("PUMA"))
    R = np.array(equations.tip_frame(regular)[0])
    for pitch, regular_there in ((90.0, False), (89.4, True), (89.5, False)):
        reference = Rotation.from_euler("y", pitch, degrees=True).as_matrix().T @ R
        turned = SpatialArmModel(equations, ca.SX(3, 1), ca.SX(1), ca.SX(ca.DM(reference)))
        value = ca.Function("f", [q], [turned.demands(q)[0].value])(regular)
        assert bool(value > 0) is regular_there


def test_an_arm_with_too_few_joints_is_refused() -> None:
    with pytest.raises(RobotError) as caught:
        arm("planar 3R")
    assert str(caught.value) == (
        "Robot planar 3R: position and orientation of the tip are 6 task coordinates, but the arm has 3 joints; use "
        "an arm of at least 6 joints, or hold fewer joints."
    )


FORMS = (torque_operational, torque_mobility, torque_resolved)


@pytest.mark.parametrize("name", ["PUMA", "UR5", "Z1"])
def test_three_forms_of_the_impedance_law_agree_for_six_coordinates(name: str) -> None:
    """Eqs. (4) to (7) with one impedance for positions and one for angles."""
    model = arm(name)
    q, dq, *_ = symbols(6)
    F, p, x_v, dx_v, ddx_v = (ca.SX.sym(name, k) for name, k in (("F", 6), ("p", 88), ("x", 6), ("d", 6), ("dd", 6)))
    diagonals = [[m] * 3 + [i] * 3 for m, i in ((10.0, 0.3), (200.0, 4.0), (1000.0, 20.0))]
    impedance = Impedance(*(ca.SX(ca.DM(diagonal)) for diagonal in diagonals))
    measured, estimate = Measured(q, dq, F), ArmEstimate(model, p)
    torques = [form(measured, estimate, (x_v, dx_v, ddx_v), impedance) for form in FORMS]
    rng = np.random.default_rng(18)
    columns = [*states(6)[:2], rng.normal(0, 20, (6, STATES)), np.tile(numbers(name)[:, None], STATES)]
    columns += [rng.normal(0, 0.3, (6, STATES)) for _ in range(3)]
    J = values([q], model.jacobian(q), columns[0])
    H = values([q, p], model.inertia(q, p), columns[0], columns[3])
    # The inverse of J enters twice, that of H once, and errors hardly add up. Seen: 0.008 of this bound, 4e-13 at most.
    conditions = np.linalg.cond(J) ** 2 * np.linalg.cond(H)
    regular = conditions < 1e6
    assert regular.sum() > STATES / 3
    found = [values([q, dq, F, p, x_v, dx_v, ddx_v], torque, *columns)[regular, :, 0] for torque in torques]
    scale = np.abs(found[0]).max(axis=1)
    for other in found[1:]:
        errors = np.abs(other - found[0]).max(axis=1) / scale
        assert np.all(errors <= EPS * conditions[regular])
        assert errors.max() < 1e-10
