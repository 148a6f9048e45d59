"""Evidence from mechanics: closed forms, skew symmetry, definiteness, linearity in the parameters."""

import casadi as ca
import numpy as np
import pytest
from numpy.testing import assert_allclose

from adaptimp_fmu import SampledModel
from fmus.mechanics.arm import ArmModel
from fmus.mechanics.planar_arm import PlanarArm
from fmus.robots.planar_robot import PlanarRobot
from tests.property.chains import Chains
from tests.property.samples import EPS, evaluate, random_arms

SIZE = 500
# Sums of at most some 100 products (n <= 4), compared relative to the largest value over all samples.
ROUNDING = 200 * EPS


def close(actual: np.ndarray, expected: np.ndarray) -> None:
    """Equal to rounding, on the scale of the largest expected value."""
    assert_allclose(actual, expected, rtol=0, atol=ROUNDING * np.abs(expected).max())


def matrices(*rows: tuple[np.ndarray, ...]) -> np.ndarray:
    """Matrices of shape (SIZE, rows, columns) from their elements, each of shape (SIZE,)."""
    return np.array(rows).transpose(2, 0, 1)


def rate(matrix: ca.SX, q: ca.SX, dq: ca.SX) -> ca.SX:
    """Exact time derivative of a matrix along dq."""
    return ca.reshape(ca.jtimes(ca.vec(matrix), q, dq), *matrix.shape)


@pytest.mark.parametrize("robot", [PlanarRobot(), PlanarRobot(3), PlanarRobot(3, pose=True)])
def test_equations_have_the_shapes_of_the_protocol(robot: PlanarRobot) -> None:
    model = SampledModel("Shapes", "A model for its parameters")
    arm: ArmModel = robot.declare_known(model)
    n, m, r = arm.n, arm.task.size, len(arm.parameters)
    q, dq, v, a, p, wrench = (ca.SX.sym("value", size) for size in (n, n, n, n, r, m))
    found = {
        "forward_kinematics": (arm.forward_kinematics(q), (m, 1)),
        "jacobian": (arm.jacobian(q), (m, n)),
        "jacobian_rate": (arm.jacobian_rate(q, dq), (m, n)),
        "wrench_force": (arm.wrench_force(q, wrench), (m, 1)),
        "wrench_torque": (arm.wrench_torque(q, wrench), (n, 1)),
        "wrench_gain": (arm.wrench_gain(q), (1, 1)),
        "inertia": (arm.inertia(q, p), (n, n)),
        "bias": (arm.bias(q, dq, p), (n, 1)),
        "inverse_dynamics": (arm.inverse_dynamics(q, dq, v, a, p), (n, 1)),
        "regressor": (arm.regressor(q, dq, v, a), (n, r)),
        "demands": (arm.demands(q)[0].value, (1, 1)),
    }
    methods = {name for name, member in vars(ArmModel).items() if callable(member) and not name.startswith("_")}
    assert found.keys() == methods
    assert {name: value.shape for name, (value, _) in found.items()} == {
        name: size for name, (_, size) in found.items()
    }
    assert len(robot.p_start) == len(robot.uncertain) == r
    assert [len(values) for values in (robot.start.q, robot.start.x_v)] == [n, m]


def test_two_joints_have_the_paper_s_closed_forms() -> None:
    arm, s = PlanarArm(2), random_arms(2, SIZE, seed=1)
    (q1, q2), (dq1, dq2), (m1, m2), (l1, l2), g = s.q, s.dq, s.m, s.l, s.gravity[0]
    c1, s1, c2, s2, c12, s12 = (
        np.cos(q1),
        np.sin(q1),
        np.cos(q2),
        np.sin(q2),
        np.cos(q1 + q2),
        np.sin(q1 + q2),
    )
    off_diagonal = m2 * l2**2 + m2 * l1 * l2 * c2
    H = matrices(((m1 + m2) * l1**2 + m2 * l2**2 + 2 * m2 * l1 * l2 * c2, off_diagonal), (off_diagonal, m2 * l2**2))
    C = (m2 * l1 * l2 * s2)[:, None, None] * matrices((-dq2, -(dq1 + dq2)), (dq1, 0 * dq1))
    gravity = np.array([(m1 + m2) * g * l1 * c1 + m2 * g * l2 * c12, m2 * g * l2 * c12])
    J = matrices((-l1 * s1 - l2 * s12, -l2 * s12), (l1 * c1 + l2 * c12, l2 * c12))
    w = dq1 + dq2
    dJ = matrices((-l1 * c1 * dq1 - l2 * c12 * w, -l2 * c12 * w), (-l1 * s1 * dq1 - l2 * s12 * w, -l2 * s12 * w))
    close(
        evaluate(arm.forward_kinematics, s.q, s.l)[..., 0].T,
        np.array([l1 * c1 + l2 * c12, l1 * s1 + l2 * s12]),
    )
    close(evaluate(arm.jacobian, s.q, s.l), J)
    close(evaluate(arm.jacobian_rate, s.q, s.dq, s.l), dJ)
    close(evaluate(arm.inertia, s.q, s.m, s.l), H)
    close(evaluate(arm.coriolis, s.q, s.dq, s.m, s.l), C)
    close(evaluate(arm.gravity_torque, s.q, s.m, s.l, s.gravity)[..., 0].T, gravity)


def test_friction_is_viscous_plus_smoothed_coulomb() -> None:
    arm, s = PlanarArm(3), random_arms(3, SIZE, seed=2)
    viscous, coulomb = s.p[3:6], s.p[6:]
    f = evaluate(arm.friction_torque, s.dq, viscous, coulomb, s.coulomb_velocity)[..., 0].T
    close(f, viscous * s.dq + coulomb * np.tanh(s.dq / s.coulomb_velocity))
    assert (f * s.dq >= 0).all()  # it takes energy, exactly: a product of equal signs


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_inertia_is_symmetric_positive_definite(n: int) -> None:
    arm, s = PlanarArm(n), random_arms(n, SIZE, seed=3)
    H = evaluate(arm.inertia, s.q, s.m, s.l)
    close(H, H.transpose(0, 2, 1))
    # A positive definite matrix may be ill-conditioned; its smallest computed eigenvalue is known to within rounding
    # times the largest, and must exceed that.
    eigenvalues = np.linalg.eigvalsh(H)
    assert (eigenvalues[:, 0] > ROUNDING * eigenvalues[:, -1]).all()


@pytest.mark.parametrize("n", [2, 3, 4])
def test_inertia_rate_minus_twice_coriolis_is_skew(n: int) -> None:
    arm, s = PlanarArm(n), random_arms(n, SIZE, seed=4)
    q, dq, m, l = (ca.SX.sym(name, n) for name in ("q", "dq", "m", "l"))
    dH = ca.Function("dH", [q, dq, m, l], [rate(arm.inertia(q, m, l), q, dq)])
    N = evaluate(dH, s.q, s.dq, s.m, s.l) - 2 * evaluate(arm.coriolis, s.q, s.dq, s.m, s.l)
    assert np.abs(N).max() > 1  # there is something to be skew
    close(N, -N.transpose(0, 2, 1))


@pytest.mark.parametrize("arm", [PlanarArm(2), PlanarArm(3, pose=True)])
def test_tip_space_inertia_rate_minus_twice_coriolis_is_skew(arm: PlanarArm) -> None:
    """C18: H_x = J^-T H J^-1, C_x = J^-T (C - H J^-1 dJ) J^-1."""
    s = random_arms(arm.n, SIZE, seed=5, regular=True)
    q, dq, m, l = (ca.SX.sym(name, arm.n) for name in ("q", "dq", "m", "l"))
    inverse, H = ca.inv(arm.jacobian(q, l)), arm.inertia(q, m, l)
    H_x = ca.mtimes([inverse.T, H, inverse])
    dJ = arm.jacobian_rate(q, dq, l)
    C_x = ca.mtimes([inverse.T, arm.coriolis(q, dq, m, l) - ca.mtimes([H, inverse, dJ]), inverse])
    N = evaluate(ca.Function("N", [q, dq, m, l], [rate(H_x, q, dq) - 2 * C_x]), s.q, s.dq, s.m, s.l)
    # J^-1 enters three times: rounding grows with cond(J)^3 of the sample, relative to the size of its own terms.
    C_joint = evaluate(arm.coriolis, s.q, s.dq, s.m, s.l)
    J = evaluate(arm.jacobian, s.q, s.l)
    size = np.linalg.norm(np.linalg.inv(J), axis=(1, 2)) ** 2 * np.linalg.norm(C_joint, axis=(1, 2))
    size += np.linalg.norm(N, axis=(1, 2))
    miss = np.abs(N + N.transpose(0, 2, 1)).max(axis=(1, 2))
    assert np.median(np.linalg.norm(N, axis=(1, 2))) > 1
    assert (miss <= ROUNDING * np.linalg.cond(J) ** 3 * size).all()


@pytest.mark.parametrize("n", [3, 4])
def test_an_arm_with_an_angle_as_task_moves_as_its_links_do(n: int) -> None:
    arm, s = PlanarArm(n, pose=True), random_arms(n, SIZE, seed=8)
    chains = Chains(s.q.T, s.dq.T, s.l.T, s.gravity[0], s.coulomb_velocity[0])
    close(evaluate(arm.forward_kinematics, s.q, s.l)[..., 0], chains.x)
    close(evaluate(arm.jacobian, s.q, s.l), chains.J)
    close(evaluate(arm.jacobian_rate, s.q, s.dq, s.l), chains.dJ)
    close(evaluate(arm.inertia, s.q, s.m, s.l), chains.H(s.p.T))
    close(evaluate(arm.coriolis, s.q, s.dq, s.m, s.l), chains.C(s.p.T))
    a = np.zeros((n, SIZE))
    given = (s.p, s.l, s.gravity, s.coulomb_velocity)
    rest = evaluate(arm.inverse_dynamics, s.q, s.dq, a, a, *given)[..., 0]
    close(rest, chains.rest(s.p.T))


@pytest.mark.parametrize("n", [2, 3, 4])
def test_regressor_times_parameters_is_inverse_dynamics(n: int) -> None:
    arm, s = PlanarArm(n), random_arms(n, SIZE, seed=6)
    given = (s.l, s.gravity, s.coulomb_velocity)
    Y = evaluate(arm.regressor, s.q, s.dq, s.v, s.a, *given)
    H, C = evaluate(arm.inertia, s.q, s.m, s.l), evaluate(arm.coriolis, s.q, s.dq, s.m, s.l)
    g = evaluate(arm.gravity_torque, s.q, s.m, s.l, s.gravity)[..., 0]
    f = s.p[n : 2 * n] * s.dq + s.p[2 * n :] * np.tanh(s.dq / s.coulomb_velocity)
    tau = np.einsum("kij,jk->ki", H, s.a) + np.einsum("kij,jk->ki", C, s.v) + g + f.T
    close(evaluate(arm.inverse_dynamics, s.q, s.dq, s.v, s.a, s.p, *given)[..., 0], tau)
    close(np.einsum("kij,jk->ki", Y, s.p), tau)


def test_energy_of_a_swing_changes_by_the_power_of_the_torque() -> None:
    """d(kinetic + potential)/dt = dq' (tau - f), with ddq from eq. (1): couples H, C and g."""
    arm, s = PlanarArm(3), random_arms(3, SIZE, seed=7)
    q, dq, a, p, l = (ca.SX.sym(name, k) for name, k in (("q", 3), ("dq", 3), ("a", 3), ("p", 9), ("l", 3)))
    gravity, coulomb_velocity = ca.SX.sym("gravity"), ca.SX.sym("coulomb_velocity")
    m, viscous, coulomb = arm.split(p)
    angles = ca.cumsum(q)
    ends = [ca.vertcat(ca.dot(l[:i], ca.cos(angles[:i])), ca.dot(l[:i], ca.sin(angles[:i]))) for i in (1, 2, 3)]
    energy = sum(m[i] * (0.5 * ca.sumsqr(ca.jtimes(ends[i], q, dq)) + gravity * ends[i][1]) for i in range(3))
    growth = ca.jtimes(energy, q, dq) + ca.jtimes(energy, dq, a)
    f = arm.friction_torque(dq, viscous, coulomb, coulomb_velocity)
    power = ca.dot(dq, arm.inverse_dynamics(q, dq, dq, a, p, l, gravity, coulomb_velocity) - f)
    both = ca.Function("both", [q, dq, a, p, l, gravity, coulomb_velocity], [ca.horzcat(growth, power)])
    values = evaluate(both, s.q, s.dq, s.a, s.p, s.l, s.gravity, s.coulomb_velocity)[:, 0]
    close(values[:, 1], values[:, 0])
