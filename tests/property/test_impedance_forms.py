"""Evidence for C15: the three forms of impedance control agree for square Jacobians; form (5) also serves others.

The closed loop is formed here, in NumPy, from eq. (1): H ddq + C dq + g + f = tau - J' F.
"""

from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np
import pytest

from fmus.control.impedance import (
    ArmEstimate,
    Measured,
    null_space_damping,
    target_acceleration,
    torque_mobility,
    torque_operational,
    torque_resolved,
)
from fmus.control.tirt import Impedance
from fmus.mechanics.planar_arm import PlanarArm
from fmus.mechanics.planar_model import PlanarArmModel
from tests.property.samples import EPS, Samples, evaluate, random_arms

SIZE = 500
TWO, POSE = PlanarArm(2), PlanarArm(3, pose=True)  # as many joints as task coordinates
THREE, FOUR, FOUR_POSE = PlanarArm(3), PlanarArm(4), PlanarArm(4, pose=True)  # redundant
AGREEMENT = 1e-10  # of the torque; 4e-13 at worst is what the condition of these samples leaves
FORMS = {"(4)": torque_operational, "(5)": torque_mobility, "(6)-(7)": torque_resolved}
DAMPING = 12.5  # 1/s


@dataclass(frozen=True)
class Loop:
    """Samples, controller inputs (m, SIZE), and what decides rounding: all of shape (SIZE, ...)."""

    samples: Samples
    task: tuple[np.ndarray, ...]
    J: np.ndarray
    H: np.ndarray
    bias: np.ndarray
    drift: np.ndarray
    demand: np.ndarray

    @property
    def tolerance(self) -> np.ndarray:
        """Rounding of a torque, N.m, shape (SIZE,).

        A small linear solve loses EPS times the condition number: W = J H^-1 J' has at most cond(J)^2 cond(H). The
        terms are of the size of H J^-1 (demand - dJ dq), of the bias and of J' F. Seen: 0.15 of this.
        """
        norm, F = np.linalg.norm, self.task[0]
        reach = norm(np.linalg.pinv(self.J), axis=(1, 2)) * (norm(self.demand, axis=1) + norm(self.drift, axis=1))
        contact = norm(self.J, axis=(1, 2)) * norm(F, axis=0)
        terms = norm(self.H, axis=(1, 2)) * reach + norm(self.bias, axis=1) + contact
        return 2 * EPS * np.linalg.cond(self.J) ** 2 * np.linalg.cond(self.H) * terms


@cache
def functions(arm: PlanarArm) -> dict[str, ca.Function]:
    """The laws and the plant's terms as functions of all symbols."""
    n, m = arm.n, arm.task.size
    q, dq, p, l = (ca.SX.sym(name, k) for name, k in (("q", n), ("dq", n), ("p", 3 * n), ("l", n)))
    gravity, coulomb_velocity = ca.SX.sym("gravity"), ca.SX.sym("coulomb_velocity")
    F, x_v, dx_v, ddx_v, M, B, K = task = [ca.SX.sym(name, m) for name in ("F", "x_v", "dx_v", "ddx_v", "M", "B", "K")]
    measured, model = Measured(q, dq, F), ArmEstimate(PlanarArmModel(arm, l, gravity, coulomb_velocity), p)
    virtual, impedance = (x_v, dx_v, ddx_v), Impedance(M, B, K)
    x, dx = arm.forward_kinematics(q, l), ca.mtimes(arm.jacobian(q, l), dq)
    laws = {name: form(measured, model, virtual, impedance) for name, form in FORMS.items() if n == m or name == "(5)"}
    values = laws | {
        "demand": target_acceleration(x, dx, virtual, F, impedance),
        "bias": model.bias(q, dq),
        "null": null_space_damping(measured, model, ca.SX(DAMPING)),
    }
    arguments = [q, dq, p, l, gravity, coulomb_velocity, *task]
    return {name: ca.Function("value", arguments, [value]) for name, value in values.items()}


@cache
def loop(arm: PlanarArm) -> Loop:
    """Random arms near a virtual trajectory: 3 cm, 0.5 m/s and 20 m/s2 away, forces of 300 N; angles in rad alike."""
    n = arm.n
    s, rng = random_arms(n, SIZE, seed=15, regular=True), np.random.default_rng(n)
    J = evaluate(arm.jacobian, s.q, s.l)
    x, dx = evaluate(arm.forward_kinematics, s.q, s.l)[..., 0].T, np.einsum("kij,jk->ik", J, s.dq)
    near = (x + rng.normal(0, 0.03, x.shape), dx + rng.normal(0, 0.5, x.shape), rng.normal(0, 20, x.shape))
    impedance = tuple(rng.uniform(low, high, x.shape) for low, high in ((0.5, 5), (50, 500), (500, 8000)))
    task = (rng.normal(0, 300, x.shape), *near, *impedance)
    columns = (s.q, s.dq, s.p, s.l, s.gravity, s.coulomb_velocity, *task)
    bias, demand = (evaluate(functions(arm)[name], *columns)[..., 0] for name in ("bias", "demand"))
    drift = np.einsum("kij,jk->ki", evaluate(arm.jacobian_rate, s.q, s.dq, s.l), s.dq)
    return Loop(s, task, J, evaluate(arm.inertia, s.q, s.m, s.l), bias, drift, demand)


def torque(arm: PlanarArm, name: str) -> np.ndarray:
    """Torque of a law at all samples, N.m, shape (SIZE, n)."""
    s = loop(arm).samples
    columns = (s.q, s.dq, s.p, s.l, s.gravity, s.coulomb_velocity, *loop(arm).task)
    return evaluate(functions(arm)[name], *columns)[..., 0]


def tip_acceleration(arm: PlanarArm, tau: np.ndarray) -> np.ndarray:
    """J ddq + dJ dq of the plant, eq. (1), m/s2, shape (SIZE, m)."""
    at = loop(arm)
    contact = np.einsum("kij,ik->kj", at.J, at.task[0])
    ddq = np.linalg.solve(at.H, (tau - at.bias - contact)[..., None])[..., 0]
    return np.einsum("kij,kj->ki", at.J, ddq) + at.drift


def acceleration_tolerance(arm: PlanarArm) -> np.ndarray:
    """A torque's rounding, through J H^-1, m/s2."""
    at = loop(arm)
    return np.linalg.norm(at.J @ np.linalg.inv(at.H), axis=(1, 2)) * at.tolerance


@pytest.mark.parametrize("arm", [TWO, POSE])
@pytest.mark.parametrize("form", ["(4)", "(5)"])
def test_forms_agree_for_square_jacobians(arm: PlanarArm, form: str) -> None:
    miss = np.linalg.norm(torque(arm, form) - torque(arm, "(6)-(7)"), axis=1)
    size = np.linalg.norm(torque(arm, form), axis=1)
    assert np.median(size) > 100  # N.m: not a comparison of zeros
    assert (miss <= loop(arm).tolerance).all()
    assert (miss <= AGREEMENT * size).all()


@pytest.mark.parametrize(
    ("arm", "form"),
    [*((arm, form) for arm in (TWO, POSE) for form in FORMS), *((arm, "(5)") for arm in (THREE, FOUR, FOUR_POSE))],
)
def test_the_tip_accelerates_as_the_target_impedance_demands(arm: PlanarArm, form: str) -> None:
    miss = np.linalg.norm(tip_acceleration(arm, torque(arm, form)) - loop(arm).demand, axis=1)
    assert (miss <= acceleration_tolerance(arm)).all()


@pytest.mark.parametrize("arm", [TWO, POSE])
def test_target_acceleration_is_equation_3(arm: PlanarArm) -> None:
    s, (F, x_v, dx_v, ddx_v, M, B, K) = loop(arm).samples, loop(arm).task
    x = evaluate(arm.forward_kinematics, s.q, s.l)[..., 0].T
    dx = np.einsum("kij,jk->ik", loop(arm).J, s.dq)
    residual = M * (loop(arm).demand.T - ddx_v) + B * (dx - dx_v) + K * (x - x_v) + F
    # A sum of four terms, none above 10 kN here; one rounding each, and the rounding of x times K.
    assert np.abs(residual).max() <= 10 * EPS * 1e4


@pytest.mark.parametrize("arm", [THREE, FOUR, FOUR_POSE])
def test_null_space_damping_leaves_the_tip_alone_and_takes_energy(arm: PlanarArm) -> None:
    at, tau = loop(arm), torque(arm, "null")
    change = np.linalg.norm(tip_acceleration(arm, tau) - tip_acceleration(arm, 0 * tau), axis=1)
    rates = np.linalg.norm(at.samples.dq, axis=0)
    # H dq and the difference of two tip accelerations are the terms that cancel; W is solved once, as in `Loop`.
    terms = DAMPING * np.linalg.norm(at.H, axis=(1, 2)) * rates
    through = np.linalg.norm(at.J @ np.linalg.inv(at.H), axis=(1, 2))
    rounding = 2 * EPS * np.linalg.cond(at.J) ** 2 * np.linalg.cond(at.H) * terms
    assert (change <= through * rounding + acceleration_tolerance(arm)).all()
    power = np.einsum("ki,ik->k", tau, at.samples.dq)
    assert (power <= rounding * rates).all()
    assert np.median(power) < -1  # W: it does take energy


@pytest.mark.parametrize("arm", [TWO, POSE])
def test_null_space_damping_is_nothing_without_a_null_space(arm: PlanarArm) -> None:
    at, tau = loop(arm), torque(arm, "null")
    terms = DAMPING * np.linalg.norm(at.H, axis=(1, 2)) * np.linalg.norm(at.samples.dq, axis=0)
    rounding = 2 * EPS * np.linalg.cond(at.J) ** 2 * np.linalg.cond(at.H) * terms
    assert (np.linalg.norm(tau, axis=1) <= rounding).all()
