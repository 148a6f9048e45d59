"""The Newton-Euler recursion and both algorithms' laws in joint space agree with the Lagrangian equations."""

import casadi as ca
import numpy as np
import pytest

from fmus.mechanics.planar_arm import PlanarArm
from orchestration.paper import joint_space_laws as laws
from orchestration.paper import newton_euler
from orchestration.paper.claims.operations import counted

ROUNDING = 1e-12  # of sums of some hundred products near 1e3, by two orders of summation


def numbers(n: int) -> tuple[list, list]:
    """Random arguments of the inverse dynamics and of the regressor."""
    random = np.random.default_rng(n)
    q, dq, v, a = random.uniform(-5, 5, (4, n))
    p, l = random.uniform(0.2, 5, 3 * n), random.uniform(0.3, 2, n)
    return [q, dq, v, a, p, l, 9.81, 1e-2], [q, dq, v, a, l, 9.81, 1e-2]


def difference(one: ca.DM, two: ca.DM) -> float:
    return float(ca.norm_fro(one - two) / ca.norm_fro(one))


@pytest.mark.parametrize("n", [1, 2, 3, 6])
def test_the_recursion_gives_the_lagrangian_equations(n: int) -> None:
    arm = PlanarArm(n)
    arguments, without_p = numbers(n)
    assert difference(arm.inverse_dynamics(*arguments), newton_euler.inverse_dynamics(n)(*arguments)) < ROUNDING
    assert difference(arm.regressor(*without_p), newton_euler.regressor(n)(*without_p)) < ROUNDING
    mass, l = arguments[4][:n], arguments[5]
    assert difference(arm.inertia(arguments[0], mass, l), newton_euler.inertia(n)(arguments[0], mass, l)) < ROUNDING


def test_a_pendulum_by_hand() -> None:
    """M l (l a + g cos q) and friction of 0.5 dq + tanh(dq / 0.1), with the mass 2 kg at 3 m."""
    tau = newton_euler.inverse_dynamics(1)(0.0, 0.2, 0.2, 4.0, [2.0, 0.5, 1.0], 3.0, 9.81, 0.1)
    assert float(tau) == pytest.approx(2 * 3 * (3 * 4.0 + 9.81) + 0.1 + np.tanh(2.0), rel=1e-14)


@pytest.mark.parametrize("n", [2, 6])
def test_both_kinds_of_equations_give_the_same_tick(n: int) -> None:
    random = np.random.default_rng(n)
    values = [random.uniform(0.5, 2.0, symbol.shape) for symbol in laws.Tick(n).symbols]
    closed, recursive = laws.lagrangian(n), laws.recursive(n)
    for law in (laws.algorithm_1, laws.algorithm_2):
        for one, two in zip(law(n, closed)(*values), law(n, recursive)(*values), strict=True):
            assert difference(one, two) < ROUNDING
    ticks = [laws.algorithm_2(n, closed, form)(*values) for form in laws.FORMS]
    assert difference(ticks[0][0], ticks[1][0]) < ROUNDING, "(36) is (32)"
    assert difference(ticks[0][0], ticks[2][0]) > 1e-3, "the term C_x s is not zero here"
    assert difference(ticks[0][1], ticks[2][1]) == 0.0, "the estimate keeps W_s"


def test_what_is_dropped_is_the_coriolis_force_of_s() -> None:
    """Tau without C_x s minus tau of (32) is J' C_x s, with C_x = J^-T (C - H J^-1 dJ) J^-1."""
    n, tick = 2, laws.Tick(2)
    random = np.random.default_rng(1)
    values = [random.uniform(0.5, 2.0, symbol.shape) for symbol in tick.symbols]
    arm = PlanarArm(n)
    slide = laws.solver(tick.J)(tick.de + tick.Psi * tick.e)
    coriolis = ca.mtimes(arm.coriolis(tick.q, tick.dq, tick.m, tick.l), slide)
    inertial = ca.mtimes(arm.inertia(tick.q, tick.m, tick.l), laws.solver(tick.J)(ca.mtimes(tick.dJ, slide)))
    expected = ca.Function("J_C_x_s", tick.symbols, [coriolis - inertial])(*values)
    whole, without = (laws.algorithm_2(n, laws.lagrangian(n), form)(*values)[0] for form in ("(32)", "no C_x s"))
    assert difference(expected, without - whole) < ROUNDING


def test_the_solver_solves() -> None:
    A, b = ca.SX.sym("A", 4, 4), ca.SX.sym("b", 4)
    solve = ca.Function("solve", [A, b], [laws.solver(A)(b)])
    matrix = np.random.default_rng(3).uniform(-1, 1, (4, 4)) + 4 * np.eye(4)
    assert np.array(solve(matrix, matrix @ [1.0, 2.0, 3.0, 4.0])).ravel() == pytest.approx([1, 2, 3, 4], rel=1e-12)


def test_an_unknown_form_names_the_known_ones() -> None:
    with pytest.raises(ValueError, match=r"no form '\(33\)'; it has '\(32\)', '\(36\)', 'no C_x s'"):
        laws.algorithm_2(2, laws.lagrangian(2), "(33)")


def test_twice_the_joints_take_about_twice_the_operations_by_recursion() -> None:
    """The closed form of the same torque takes about twice cubed."""

    def count(torque: ca.Function) -> int:
        symbols = torque.sx_in()
        return counted(ca.Function("tau", symbols, ca.cse(torque.call(symbols)))).total

    growth = {make: count(make(8).torque) / count(make(4).torque) for make in (laws.recursive, laws.lagrangian)}
    assert growth[laws.recursive] < 2.2
    assert growth[laws.lagrangian] > 6.0


def test_the_difference_that_the_claims_show_is_rounding() -> None:
    assert 0.0 < laws.recursion_difference(6) < ROUNDING
