"""Evaluates equations of the paper for the PUMA 560 at random postures, and the energy s' H_x s along its runs."""

from dataclasses import replace
from functools import cache

import casadi as ca
import numpy as np

from fmus.mechanics.algebra import solve_square
from fmus.mechanics.chain import Chain, Joint, JointKind
from fmus.mechanics.rigid_body import Body
from fmus.mechanics.spatial_arm import SpatialArm
from fmus.mechanics.spatial_model import SpatialArmModel
from fmus.robots.puma560 import PUMA
from fmus.robots.spatial_robot import GRAVITY, rotation_matrix
from orchestration.paper import theory
from orchestration.paper.numbers import N_STATES
from orchestration.paper.spatial_numbers import COULOMB_VELOCITY, payload_parameters
from orchestration.paper.theory import SEED, Sampled

FAR = 1e-3  # least det(J J'), positions in reaches of the arm: tells postures that are far from singular ones
UPRIGHT = 0.2  # least cos(pitch)
SLIDE_MASS = 5.0  # kg, of the slide that makes the arm redundant
MASS_OF_LINK_1, MOMENTS_OF_LINK_1 = 10.0, (0.35, 0.0, 0.35, 0.0, 0.0, 0.35)  # kg and kg.m2, assumed on the slide


def form_difference() -> float:
    """Largest difference among the forms (4), (5), (6)-(7) for n = 6, relative to the torque."""
    return theory.difference_of_forms(_sampled(redundant=False))


def redundant_residual() -> float:
    """Largest miss of eq. (3) by the arm on a slide, n = 7, under (5), relative to the demanded acceleration."""
    return theory.miss_of_target(_sampled(redundant=True))


def skew_residual() -> float:
    """Largest symmetric part of dH_x/dt - 2 C_x, relative to its norm, for n = 6."""
    model = _model(PUMA.chain)
    n, arm = model.n, model.arm
    q, dq, p = ca.SX.sym("q", n), ca.SX.sym("dq", n), ca.SX(ca.DM(_parameters(PUMA.chain)))
    loaded = model.loaded(p)
    H, C = arm.inertia(q, loaded), arm.coriolis(q, dq, loaded)
    ratio = theory.symmetric_part((H, C), (model.jacobian(q), model.jacobian_rate(q, dq)), (q, dq))
    states = _sampled(redundant=False).states
    function = ca.Function("skew", [q, dq], [ratio]).map(N_STATES)
    return float(np.array(function(states["q"], states["dq"])).max())


def kinetic_energy(q: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Twice the kinetic energy s' H_x s of the arm with its payload, shape (n_ticks,), from q and s, (n_ticks, 6)."""
    return np.array(_energy().map(len(q))(q.T, s.T)).ravel()


@cache
def _energy() -> ca.Function:
    model = _model(PUMA.chain)
    q, s = ca.SX.sym("q", model.n), ca.SX.sym("s", model.task.size)
    rates = solve_square(model.jacobian(q), s)
    H = model.inertia(q, ca.SX(ca.DM(_parameters(PUMA.chain))))
    return ca.Function("energy", [q, s], [ca.dot(rates, ca.mtimes(H, rates))])


def _model(chain: Chain) -> SpatialArmModel:
    reference = ca.SX(ca.DM(rotation_matrix(PUMA.path.reference)))
    return SpatialArmModel(SpatialArm(chain), ca.SX(ca.DM(GRAVITY)), ca.SX(COULOMB_VELOCITY), reference)


def _parameters(chain: Chain) -> list[float]:
    return [*map(float, chain.p), *payload_parameters()]


def _on_a_slide(chain: Chain) -> Chain:
    """The arm on a slide along axis 2 of its base, which makes seven joints. Link 1, which it moves, gets a mass."""
    slide = Joint("slide", Body("slide", SLIDE_MASS), axis=(0.0, 1.0, 0.0), kind=JointKind.PRISMATIC)
    first, *others = chain.joints
    moved = replace(first, body=replace(first.body, mass=MASS_OF_LINK_1, inertia=MOMENTS_OF_LINK_1, axial_only=False))
    return replace(chain, joints=(slide, moved, *others))


@cache
def _sampled(*, redundant: bool) -> Sampled:
    """The arm at random postures that are far from singular ones, with random motion, forces and gains."""
    chain = _on_a_slide(PUMA.chain) if redundant else PUMA.chain
    model, random = _model(chain), np.random.default_rng(SEED)
    n, m = model.n, model.task.size

    def uniform(low: float, high: float, size: int) -> np.ndarray:
        return random.uniform(low, high, (size, N_STATES))

    states = {
        "q": _postures(PUMA.chain, random),
        "dq": uniform(-5, 5, n),
        "F_hat": uniform(-100, 100, m),
        "virtual": uniform(-3, 3, 3 * m),
        "impedance": uniform(1, 500, 3 * m),
    }
    if redundant:
        states["q"] = np.vstack([uniform(-0.5, 0.5, 1), states["q"]])
    p = ca.SX(ca.DM(_parameters(chain)))
    return Sampled(n, m, states, lambda _: (model, p))


def _postures(chain: Chain, random: np.random.Generator) -> np.ndarray:
    """Random joint angles, rad, shape (6, N_STATES)."""
    model = _model(chain)
    q = ca.SX.sym("q", model.n)
    J = model.arm.jacobian(q)
    scaled = ca.vertcat(J[:3, :] / chain.reach, J[3:, :])
    sound = ca.Function("sound", [q], [ca.vertcat(ca.det(scaled) ** 2, ca.cos(model.forward_kinematics(q)[4]))])
    tried = random.uniform(-np.pi, np.pi, (model.n, 20 * N_STATES))
    margins = np.array(sound.map(tried.shape[1])(tried))
    return tried[:, (margins[0] > FAR) & (margins[1] > UPRIGHT)][:, :N_STATES]
