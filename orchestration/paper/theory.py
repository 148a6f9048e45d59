"""Evaluates equations of the paper at random states of the arm, which a seed fixes."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from fmus.control.impedance import (
    ArmEstimate,
    Measured,
    target_acceleration,
    torque_mobility,
    torque_operational,
    torque_resolved,
)
from fmus.control.tirt import Impedance
from fmus.mechanics.algebra import solve_spd, solve_square
from fmus.mechanics.arm import ArmModel
from fmus.mechanics.planar_arm import PlanarArm
from fmus.mechanics.planar_model import PlanarArmModel
from orchestration.paper.numbers import N_STATES

SEED = 1991


@dataclass(frozen=True)
class Sampled:
    """An arm at random states.

    Attributes
    ----------
    n, size
        Numbers of joints and of task coordinates.
    states
        Random values by name, of shape (elements, N_STATES): at least q, dq, F_hat, virtual and impedance.
    arm
        Gives the equations of the arm and its parameters p from symbols for the states, by name.
    """

    n: int
    size: int
    states: Mapping[str, np.ndarray]
    arm: Callable[[Mapping[str, ca.SX]], tuple[ArmModel, ca.SX]]


def form_difference() -> float:
    """Largest difference among the forms (4), (5), (6)-(7) for n = 2, relative to the torque."""
    return difference_of_forms(planar(2))


def redundant_residual() -> float:
    """Largest miss of eq. (3) by a three-joint arm under (5), relative to the demanded acceleration."""
    return miss_of_target(planar(3))


def difference_of_forms(sampled: Sampled) -> float:
    """Largest difference among the forms (4), (5), (6)-(7) for an arm, relative to the torque."""
    torques = _torques(sampled, (torque_operational, torque_mobility, torque_resolved))
    scale = np.abs(torques).max(axis=(0, 1))
    return float((np.ptp(torques, axis=0).max(axis=0) / scale).max())


def miss_of_target(sampled: Sampled) -> float:
    """Largest miss of eq. (3) by an arm under (5), relative to the demanded acceleration."""
    function, arguments = _problem(sampled, _acceleration_miss)
    return float(np.array(function(*arguments)).max())


def skew_residual() -> float:
    """Largest symmetric part of dH_x/dt - 2 C_x, relative to its norm, for n = 2."""
    arm = PlanarArm(2)
    q, dq, m, l = (ca.SX.sym(name, 2) for name in ("q", "dq", "m", "l"))
    J, dJ = arm.jacobian(q, l), arm.jacobian_rate(q, dq, l)
    H, C = arm.inertia(q, m, l), arm.coriolis(q, dq, m, l)
    ratio = symmetric_part((H, C), (J, dJ), (q, dq))
    states = _states(2)
    function = ca.Function("skew", [q, dq, m, l], [ratio]).map(N_STATES)
    return float(np.array(function(states["q"], states["dq"], states["m"], states["l"])).max())


def symmetric_part(dynamics: tuple[ca.SX, ca.SX], jacobians: tuple[ca.SX, ca.SX], motion: tuple[ca.SX, ca.SX]) -> ca.SX:
    """The norm of the symmetric part of dH_x/dt - 2 C_x, relative to the norms of both.

    Parameters
    ----------
    dynamics
        H and C, shape (n, n).
    jacobians
        J and dJ, shape (n, n).
    motion
        Symbols q and dq, shape (n,).
    """
    (H, C), (J, dJ), (q, dq) = dynamics, jacobians, motion
    n = q.numel()
    inverse = solve_square(J, ca.SX.eye(n))
    H_x = ca.mtimes([inverse.T, H, inverse])
    C_x = ca.mtimes([inverse.T, C - ca.mtimes([H, inverse, dJ]), inverse])
    rate = ca.reshape(ca.jtimes(ca.vec(H_x), q, dq), n, n)
    S = rate - 2 * C_x
    return ca.norm_fro(S + S.T) / (ca.norm_fro(rate) + 2 * ca.norm_fro(C_x))


@cache
def _states(n: int) -> dict[str, np.ndarray]:
    """Random states away from singular ones, arrays of shape (size, N_STATES)."""
    random = np.random.default_rng(SEED)

    def uniform(low: float, high: float, size: int) -> np.ndarray:
        return random.uniform(low, high, (size, N_STATES))

    q = uniform(-math.pi, math.pi, n)
    q[1] = np.where(random.random(N_STATES) < 0.5, -1, 1) * random.uniform(0.3, math.pi - 0.3, N_STATES)
    return {
        "q": q,
        "dq": uniform(-5, 5, n),
        "m": uniform(0.2, 5, n),
        "friction": uniform(0, 2, 2 * n),
        "l": uniform(0.3, 2, n),
        "F_hat": uniform(-1000, 1000, 2),
        "virtual": uniform(-3, 3, 6),
        "impedance": uniform(1, 500, 6),
    }


def planar(n: int) -> Sampled:
    """The paper's arm with n joints at random states, masses and lengths."""

    def arm(symbols: Mapping[str, ca.SX]) -> tuple[ArmModel, ca.SX]:
        p = ca.vertcat(symbols["m"], symbols["friction"])
        return PlanarArmModel(PlanarArm(n), symbols["l"], ca.SX(9.81), ca.SX(1e-2)), p

    return Sampled(n, 2, _states(n), arm)


def _problem(sampled: Sampled, law) -> tuple[ca.Function, list[np.ndarray]]:
    """A law as a function mapped over the random states, and its arguments."""
    symbols = {name: ca.SX.sym(name, values.shape[0]) for name, values in sampled.states.items()}
    model = ArmEstimate(*sampled.arm(symbols))
    measured = Measured(symbols["q"], symbols["dq"], symbols["F_hat"])
    virtual = tuple(ca.vertsplit(symbols["virtual"], sampled.size))
    impedance = Impedance(*ca.vertsplit(symbols["impedance"], sampled.size))
    value = law(measured, model, virtual, impedance)
    function = ca.Function("law", list(symbols.values()), [value]).map(N_STATES)
    return function, list(sampled.states.values())


def _torques(sampled: Sampled, laws) -> np.ndarray:
    """Torques of several laws, shape (len(laws), n, N_STATES)."""
    values = []
    for law in laws:
        function, arguments = _problem(sampled, law)
        values.append(np.array(function(*arguments)))
    return np.stack(values)


def _acceleration_miss(measured: Measured, model: ArmEstimate, virtual, impedance: Impedance) -> ca.SX:
    q, dq, F = measured.q, measured.dq, measured.F_hat
    J, dJ = model.arm.jacobian(q), model.arm.jacobian_rate(q, dq)
    tau = torque_mobility(measured, model, virtual, impedance)
    ddq = solve_spd(model.inertia(q), tau - model.bias(q, dq) - ca.mtimes(J.T, F))
    ddx = ca.mtimes(J, ddq) + ca.mtimes(dJ, dq)
    x, dx = model.arm.forward_kinematics(q), ca.mtimes(J, dq)
    demand = target_acceleration(x, dx, virtual, F, impedance)
    return ca.norm_2(ddx - demand) / ca.norm_2(demand)
