"""The computations of a tick of both algorithms in joint space, for arms with any number of joints n.

The functions here serve to count operations (section IV-B), for the planar arm's tip has two coordinates only. A tip
with n coordinates is assumed: its Jacobian J, of shape (n, n), and dJ/dt are given as numbers. Forward kinematics, the
reference trajectory (11) and the target acceleration are the same for both algorithms and left out.
"""

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from fmus.mechanics.algebra import solve_spd
from fmus.mechanics.planar_arm import PlanarArm
from orchestration.paper import newton_euler

FORMS = ("(32)", "(36)", "no C_x s")
"""Forms of algorithm 2's torque: as printed, as W_s p_hat, and without the term C_x s, with C_x dx in the place of
C_x dx_r. With (31) the first is H_x ddx_r + C_x dx + g_x + f_x - C_x s + F_hat - K_d s; the paper prints C_x dx_r and
+ C_x s there, though its recursion needs the true rate."""
N_STATES, SEED = 100, 1991


@dataclass(frozen=True)
class Dynamics:
    """The equations of an arm with n joints; functions take the arguments of `fmus.mechanics.planar_arm.PlanarArm`."""

    inertia: ca.Function
    torque: ca.Function
    regressor: ca.Function


def lagrangian(n: int) -> Dynamics:
    """The equations of the planar arm in closed form."""
    arm = PlanarArm(n)
    return Dynamics(arm.inertia, arm.inverse_dynamics, arm.regressor)


def recursive(n: int) -> Dynamics:
    """The equations of the planar arm by the Newton-Euler recursion."""
    return Dynamics(newton_euler.inertia(n), newton_euler.inverse_dynamics(n), newton_euler.regressor(n))


class Tick:
    """What both algorithms know at a tick, as symbols.

    Parameters
    ----------
    n
        Number of joints and of tip coordinates.
    """

    def __init__(self, n: int) -> None:
        """Make the symbols."""
        self.symbols: list[ca.SX] = []
        self.q, self.dq, self.ddq, self.e, self.de = (self._symbol(name, n) for name in ("q", "dq", "ddq", "e", "de"))
        self.demand, self.F_hat = self._symbol("demand", n), self._symbol("F_hat", n)
        self.Psi, self.K_d, self.k, self.b = (self._symbol(name, n) for name in ("Psi", "K_d", "k", "b"))
        self.delta, self.margin, self.eps = (self._symbol(name, 1) for name in ("delta", "margin", "eps"))
        self.p, self.gain = self._symbol("p", 3 * n), self._symbol("gain", 3 * n)
        self.l, self.gravity = self._symbol("l", n), self._symbol("gravity", 1)
        self.coulomb_velocity = self._symbol("coulomb_velocity", 1)
        self.J, self.dJ = self._symbol("J", n, n), self._symbol("dJ", n, n)
        self.constants = (self.l, self.gravity, self.coulomb_velocity)
        self.m = self.p[:n]

    def _symbol(self, name: str, *shape: int) -> ca.SX:
        symbol = ca.SX.sym(name, *shape)
        self.symbols.append(symbol)
        return symbol

    def function(self, tau: ca.SX, gradient: ca.SX) -> ca.Function:
        """The torque and the next estimate, with common subexpressions shared."""
        results = ca.cse([tau, self.p - self.gain * gradient])
        return ca.Function("tick", self.symbols, results)


def algorithm_1(n: int, dynamics: Dynamics) -> ca.Function:
    """A tick of algorithm 1: the torque (8) with F_c (22), (25), and the estimate (19)."""
    t = Tick(n)
    e_star = t.de + t.Psi * t.e
    direction = solve_spd(dynamics.inertia(t.q, t.m, t.l), ca.mtimes(t.J.T, e_star))
    mu, beta = ca.norm_2(ca.mtimes(t.J, direction)), ca.norm_2(e_star)
    alpha = ca.sum1(2 * t.Psi * t.k * t.e**2 + 2 * (t.b - t.Psi) * t.de**2)
    gamma = t.margin * ca.fmax(0, (2 * mu * t.delta - alpha) / (beta**2 + t.eps**2))
    acceleration = t.demand - 0.5 * gamma * e_star
    ddq_star = solver(t.J)(acceleration - ca.mtimes(t.dJ, t.dq))
    tau = dynamics.torque(t.q, t.dq, t.dq, ddq_star, t.p, *t.constants) + ca.mtimes(t.J.T, t.F_hat)
    Y = dynamics.regressor(t.q, t.dq, t.dq, t.ddq, *t.constants)
    return t.function(tau, ca.mtimes(Y.T, direction))


def algorithm_2(n: int, dynamics: Dynamics, form: str = "(32)") -> ca.Function:
    """A tick of algorithm 2: the torque and the estimate (33).

    Parameters
    ----------
    form
        One of `FORMS`.

    Raises
    ------
    ValueError
        If there is no such form.
    """
    if form not in FORMS:
        msg = f"Algorithm 2 has no form {form!r}; it has {', '.join(map(repr, FORMS))}."
        raise ValueError(msg)
    t = Tick(n)
    solve = solver(t.J)
    s = t.de + t.Psi * t.e
    slide = solve(s)
    dq_r, ddx_r = t.dq - slide, t.demand - t.Psi * t.de
    ddq_r = solve(ddx_r - ca.mtimes(t.dJ, dq_r))
    Y = dynamics.regressor(t.q, t.dq, dq_r, ddq_r, *t.constants)
    if form == "(36)":
        dynamic = ca.mtimes(Y, t.p)
    elif form == "(32)":
        dynamic = dynamics.torque(t.q, t.dq, dq_r, ddq_r, t.p, *t.constants)
    else:
        ddq = solve(ddx_r - ca.mtimes(t.dJ, t.dq))
        dynamic = dynamics.torque(t.q, t.dq, t.dq, ddq, t.p, *t.constants)
    tau = dynamic + ca.mtimes(t.J.T, t.F_hat - t.K_d * s)
    return t.function(tau, ca.mtimes(Y.T, slide))


def solver(A: ca.SX) -> Callable[[ca.SX], ca.SX]:
    """A function that solves A x = b; A, of shape (n, n), is factorised once, without a search for pivots."""
    n = A.shape[0]
    upper, lower, inverse = [[A[i, j] for j in range(n)] for i in range(n)], {}, []
    for k in range(n):
        inverse.append(1 / upper[k][k])
        for i in range(k + 1, n):
            lower[i, k] = upper[i][k] * inverse[k]
            for j in range(k + 1, n):
                upper[i][j] = upper[i][j] - lower[i, k] * upper[k][j]

    def solve(b: ca.SX) -> ca.SX:
        x = [b[i] for i in range(n)]
        for i in range(n):
            for k in range(i):
                x[i] = x[i] - lower[i, k] * x[k]
        for i in reversed(range(n)):
            for k in range(i + 1, n):
                x[i] = x[i] - upper[i][k] * x[k]
            x[i] = x[i] * inverse[i]
        return ca.vertcat(*x)

    return solve


def recursion_difference(n: int) -> float:
    """Largest difference of the recursion from the Lagrangian equations at random states, relative to the torque."""
    random = np.random.default_rng(SEED)
    lagrange, inverse = PlanarArm(n).inverse_dynamics, newton_euler.inverse_dynamics(n)
    differences = []
    for _ in range(N_STATES):
        q, dq, v, a = random.uniform(-5, 5, (4, n))
        numbers = (q, dq, v, a, random.uniform(0.2, 5, 3 * n), random.uniform(0.3, 2, n), 9.81, 1e-2)
        expected, found = (np.array(f(*numbers)) for f in (lagrange, inverse))
        differences.append(np.abs(found - expected).max() / np.abs(expected).max())
    return float(np.max(differences))
