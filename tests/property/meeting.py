"""A plant and the controllers at the same random states, for the theory of tasks of positions and angles.

The planar arm of three joints meets its catalog's FMUs. An arm in space meets the equation of motion in NumPy, and its
gains have axes of their own. All vectors of the task are in the axes of the gains; samples are rows.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from adaptimp_fmu import SampledModel
from fmus.craig_adaptive_impedance import craig_adaptive_impedance
from fmus.hogan_impedance import hogan_impedance
from fmus.robots.planar_robot import PlanarRobot
from fmus.slotine_li_adaptive_impedance import slotine_li_adaptive_impedance
from fmus.spong_ortega_adaptive_impedance import spong_ortega_adaptive_impedance
from tests.property.chains import Chains
from tests.property.definitions import evaluator, outputs
from tests.property.samples import EPS
from tests.property.spatial_chains import SpatialChains
from tests.property.spatial_robots import robot
from tests.property.task_space import TaskSpace, apply

PLANAR, PLANAR_REDUNDANT = "planar", "planar, redundant"
PLANT = "Plant3RPose"
HOGAN, CRAIG, SLOTINE_LI, SPONG_ORTEGA = (
    "HoganImpedance",
    "CraigAdaptiveImpedance",
    "SlotineLiAdaptiveImpedance",
    "SpongOrtegaAdaptiveImpedance",
)
TOLERANCE = 1e-10  # of the largest terms; rounding: see `Meeting.roundings`
TS = 1e-4  # s, start of the sampling period
SIZES = {PLANAR: 1000}
SIZE_IN_SPACE = 200
DRAWN = {6: 12, 7: 30}
"""By the number of joints: states that are drawn for each one that is far enough from singular."""
TASK = 6  # coordinates of a task in space
LENGTH = 0.15  # m: what is 1 m of a position is 1/0.15 rad of an angle
Columns = dict[str, np.ndarray]
LAWS: dict[str, Callable[[Any], SampledModel]] = {
    HOGAN: lambda arm: hogan_impedance(arm, "Law"),
    CRAIG: lambda arm: craig_adaptive_impedance("Law", arm),
    SLOTINE_LI: lambda arm: slotine_li_adaptive_impedance("Law", arm),
    SPONG_ORTEGA: lambda arm: spong_ortega_adaptive_impedance("Law", arm),
}
OF_TASK = ("x_v", "dx_v", "ddx_v")
"""Inputs that an FMU takes in the axes of the base; the states x_t and dx_t are in those of the gains."""
SHOWN = ("e_star", "F_c", "s")
"""Outputs that an FMU shows in the axes of the base."""


@dataclass(frozen=True)
class Meeting:
    """Arms, what a controller is given beside forces and estimates, and true and estimated parameters.

    Attributes
    ----------
    given
        By name, shape (size, k).
    wrench
        What the tip exerts on the environment, N and N.m, shape (size, m).
    move
        Acceleration of the joints, shape (size, n), for their torques.
    """

    name: str
    arms: TaskSpace
    given: Columns
    p: np.ndarray
    p_hat: np.ndarray
    wrench: np.ndarray
    move: Callable[[np.ndarray], np.ndarray]

    @property
    def size(self) -> int:
        """Number of samples."""
        return len(self.p)

    @property
    def nominal(self) -> np.ndarray:
        """Start parameters of a controller that are neither the true ones nor the estimates."""
        return 0.5 * (self.p + self.p_hat)

    def evaluate(self, law: str, given: Columns) -> Columns:
        """What a law shows; given and shown in the axes of the gains."""
        taken = {name: self.arms.in_base(v) if name in OF_TASK else v for name, v in given.items()}
        shown = _law(self.name, law)(**{name: values.T for name, values in taken.items()})
        return {name: self.arms.in_task(v) if name in SHOWN else v for name, v in shown.items()}

    def force(self, wrench: np.ndarray) -> np.ndarray:
        """The force of a wrench in the coordinates of the task."""
        return apply(self.arms.wrench_map, wrench)


@dataclass(frozen=True)
class Loop:
    """Closed loop of a law: accelerations, errors and forces, shape (size, m)."""

    shown: Columns
    given: Columns
    ddq: np.ndarray
    ddx: np.ndarray
    e: np.ndarray
    de: np.ndarray
    ddx_t: np.ndarray
    F_ext: np.ndarray
    F_hat: np.ndarray
    condition: np.ndarray


def norm(vectors: np.ndarray) -> np.ndarray:
    """Euclidean norm of each row, or of each matrix."""
    return np.linalg.norm(vectors.reshape(len(vectors), -1), axis=1)


def scales(arms: TaskSpace) -> np.ndarray:
    """1 for positions, and `LENGTH` for angles, shape (m,)."""
    positions = 3 if isinstance(arms, SpatialChains) else 2
    return np.where(np.arange(arms.x.shape[1]) < positions, 1.0, LENGTH)


@cache
def meeting(name: str) -> Meeting:
    """Half of the arms touch something; e and e' are of the size of 1 cm, 0.05 rad and 1 m/s."""
    if name == PLANAR_REDUNDANT:
        return _redundant_in_the_plane()
    return _in_the_plane() if name == PLANAR else _in_space(name)


@cache
def closed_loop(name: str, law: str) -> Loop:
    """The acceleration at which the torque of a law and the equation of motion fit each other."""
    at, rng = meeting(name), np.random.default_rng(15)
    size, n, m = at.size, at.arms.n, at.arms.x.shape[1]
    noise = rng.normal(0, 30, (size, m)) * np.where(scales(at.arms) == 1, 1, LENGTH)
    given = at.given | {"F_hat": at.wrench + noise, "L": rng.uniform(0.1, 0.3, (size, 1))}
    given["Gamma"] = rng.uniform(0.5, 5, at.p.shape)
    if law == HOGAN:
        given = {name: values for name, values in given.items() if name not in ("L", "Gamma", "Psi")}
        given["p_start"] = at.p
    elif law == SLOTINE_LI:
        given |= {"p_hat": at.p_hat, "K_d": rng.uniform(10, 300, (size, m)) * scales(at.arms) ** 2}
        given["p_start"] = at.nominal
    else:
        given["noise_bound"] = rng.uniform(0, 200, (size, 1))
    if law == CRAIG:
        given["p_hat"] = at.p_hat
    if law == SPONG_ORTEGA:
        fixed = at.p + _more(at)
        given |= {"p_start": fixed, "phi_hat": fixed - at.p_hat, "acc_filter_time": np.zeros((size, 1))}

    def acceleration(ddq: np.ndarray) -> tuple[np.ndarray, Columns]:
        more = {"ddq": ddq, "a_f": ddq} if law == SPONG_ORTEGA else {"ddq": ddq}
        shown = at.evaluate(law, given | more)
        return at.move(shown["tau_cmd"]), shown

    # The torque of the variant is affine in ddq, since a_f = ddq without the filter; that of the others is constant.
    c = acceleration(np.zeros((size, n)))[0]
    units = np.eye(n) if law == SPONG_ORTEGA else []
    G = np.zeros((size, n, n))
    for j, unit in enumerate(units):
        G[:, :, j] = acceleration(np.tile(unit, (size, 1)))[0] - c
    ddq = np.linalg.solve(np.eye(n) - G, c[..., None])[..., 0]
    _, shown = acceleration(ddq)
    F_hat = at.force(given["F_hat"])
    e, de = at.arms.x - given["x_t"], at.arms.dx - given["dx_t"]
    pull = given["B"] * (given["dx_t"] - given["dx_v"]) + given["K"] * (given["x_t"] - given["x_v"]) + F_hat
    return Loop(
        shown,
        given,
        ddq=ddq,
        ddx=at.arms.acceleration(ddq),
        e=e,
        de=de,
        ddx_t=given["ddx_v"] - pull / given["M"],  # (11)
        F_ext=at.force(at.wrench),
        F_hat=F_hat,
        condition=np.maximum(1.0, np.linalg.cond(np.eye(n) - G)),
    )


def _more(at: Meeting) -> np.ndarray | float:
    """What Spong and Ortega's fixed parameters have more than the true ones: inertia must not be less."""
    if at.name == PLANAR:
        return 1.0
    more = np.zeros(at.p.shape[1])
    n = at.arms.n
    more[12 * n : 13 * n] = 0.3  # rotors, kg m2: H_0 - H is then positive definite
    return more


@cache
def _law(name: str, law: str) -> Callable[..., Columns]:
    """The outputs of a law for columns by name."""
    if name == PLANAR:
        return lambda **columns: outputs(f"{law}3RPose", **columns)
    return evaluator(LAWS[law](PlanarRobot(3) if name == PLANAR_REDUNDANT else robot(name)))


def _controller(arms: TaskSpace, rng: np.random.Generator) -> Columns:
    """Gains, virtual trajectory and TIRT."""
    scale, (size, m) = scales(arms), arms.x.shape

    def uniform(low: float, high: float) -> np.ndarray:
        return rng.uniform(low, high, (size, m))

    M, B = uniform(0.5, 5) * scale**2, uniform(100, 500) * scale**2
    given = {"M": M, "B": B, "K": uniform(500, 8000) * scale**2, "Psi": uniform(0.2, 0.9) * B / M}
    for name, middle, width in (
        ("x_v", arms.x, 0.01),
        ("dx_v", arms.dx, 0.5),
        ("ddx_v", 0, 20),
        ("x_t", arms.x, 0.01),
        ("dx_t", arms.dx, 0.5),
    ):
        given[name] = middle + width / scale * rng.normal(size=(size, m))
    return given


def _in_the_plane() -> Meeting:
    """Arms like the default one, against walls."""
    rng = np.random.default_rng(12)
    chains, common, p, p_hat = _planar_arms(rng, SIZES[PLANAR], angle=True)
    size = len(p)

    def uniform(low: float, high: float, k: int) -> np.ndarray:
        return rng.uniform(low, high, (size, k))

    turn, depth = uniform(-np.pi, np.pi, 1), uniform(-0.005, 0.005, 1)
    normal = np.hstack([np.cos(turn), np.sin(turn)])
    plant = {
        **common,
        "m": p[:, :3],
        "viscous": p[:, 3:6],
        "coulomb": p[:, 6:],
        "wall_normal": normal,
        "wall_offset": (normal * chains.x[:, :2]).sum(axis=1, keepdims=True) - depth,
        "mu": uniform(0, 0.5, 1),
        "mode_contact": (depth > 0).astype(float),
        "mode_pushing": np.ones((size, 1)),
    }
    columns = {name: values.T for name, values in plant.items()}
    return Meeting(
        PLANAR,
        chains,
        common | _controller(chains, rng),
        p,
        p_hat,
        wrench=outputs(PLANT, **columns)["F_ext"],
        move=lambda tau: outputs(PLANT, **columns, tau=tau.T)["ddq"],
    )


def _redundant_in_the_plane() -> Meeting:
    """The same arms with a task of the position alone, some of which carry a load at the tip."""
    rng = np.random.default_rng(13)
    chains, common, p, p_hat = _planar_arms(rng, SIZES[PLANAR], angle=False)
    size = len(p)
    load = rng.normal(0, 100, (size, 2)) * (rng.random((size, 1)) < 0.5)
    given = common | {"posture": chains.q + rng.normal(0, 0.5, (size, 3))} | _controller(chains, rng)
    return Meeting(PLANAR_REDUNDANT, chains, given, p, p_hat, load, _moved(chains, p, load))


def _planar_arms(rng: np.random.Generator, size: int, *, angle: bool) -> tuple[Chains, Columns, np.ndarray, np.ndarray]:
    """Arms of three joints, what their FMUs are given of them, and two sets of parameters."""

    def uniform(low: float, high: float, k: int = 3) -> np.ndarray:
        return rng.uniform(low, high, (size, k))

    q = uniform(-np.pi, np.pi)
    q[:, 1] = rng.uniform(0.8, 2.2, size) * rng.choice([-1, 1], size)
    dq, l = uniform(-3, 3), np.hstack([uniform(0.8, 1.2, 2), uniform(0.4, 0.7, 1)])
    p, p_hat = (np.hstack([uniform(1, 3), uniform(0, 2, 6)]) for _ in range(2))
    gravity, coulomb_velocity = uniform(0, 10, 1), uniform(0.05, 0.5, 1)
    chains = Chains(q, dq, l, gravity[:, 0], coulomb_velocity[:, 0], angle)
    common = {"q": q, "dq": dq, "l": l, "gravity": gravity, "coulomb_velocity": coulomb_velocity}
    return chains, common, p, p_hat


def _moved(arms: TaskSpace, p: np.ndarray, wrench: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """The equation of motion: accelerations of the joints for torques."""
    H, bias = arms.H(p), arms.torque(p, arms.rates, np.zeros_like(arms.rates))
    held = np.einsum("kij,ki->kj", arms.J, apply(arms.wrench_map, wrench))
    return lambda tau: np.linalg.solve(H, (tau - bias - held)[..., None])[..., 0]


def _in_space(name: str) -> Meeting:
    """An arm in any position, with any payload, frame of its angles and frame of its gains.

    Those states are taken at which the angles and the arm are so far from singular that the rounding of what is
    computed here stays below `TOLERANCE`. The pitch is up to 72 deg.
    """
    rng, arm = np.random.default_rng(12), robot(name)
    drawn = DRAWN[arm.n] * SIZE_IN_SPACE

    def uniform(low: float, high: float, k: int) -> np.ndarray:
        return rng.uniform(low, high, (drawn, k))

    frames = [uniform(-np.pi, np.pi, 3) for _ in range(2)]
    columns = [uniform(-np.pi, np.pi, arm.n), uniform(-2, 2, arm.n), uniform(-10, 10, 3), uniform(0.05, 0.5, 1)[:, 0]]
    every = SpatialChains(name, *columns, *frames)
    p, p_hat = (_parameters(name, rng, drawn) for _ in range(2))
    rounding = np.maximum(every.roundings(p), every.roundings(p_hat))
    kept = np.flatnonzero((np.cos(every.phi[:, 1]) > 0.3) & (rounding < TOLERANCE))[:SIZE_IN_SPACE]
    arms = SpatialChains(name, *(values[kept] for values in (*columns, *frames)))
    p, p_hat = p[kept], p_hat[kept]
    wrench = rng.normal(0, 100, (len(kept), 6)) * scales(arms) * (rng.random((len(kept), 1)) < 0.5)
    given = {name: getattr(arms, name) for name in ("q", "dq", "gravity", "reference_rpy", "task_rpy")}
    given |= {"coulomb_velocity": arms.coulomb_velocity[:, None]} | _controller(arms, rng)
    if arm.n > TASK:
        given["posture"] = arms.q + rng.normal(0, 0.5, arms.q.shape)
    return Meeting(name, arms, given, p, p_hat, wrench, _moved(arms, p, wrench))


def _parameters(name: str, rng: np.random.Generator, size: int) -> np.ndarray:
    """Parameters of bodies up to 30 % off the arm's, with friction, and a payload of up to 2 kg; shape (size, r)."""
    arm = robot(name)
    n = arm.n
    p = np.tile(np.array(arm.p_start), (size, 1))
    p[:, : 10 * n] *= np.repeat(rng.uniform(0.7, 1.3, (size, n)), 10, axis=1)
    p[:, 10 * n : 12 * n] = rng.uniform(0, 2, (size, 2 * n))
    p[:, 12 * n : 13 * n] += rng.uniform(0.1, 0.3, (size, n))
    p[:, 13 * n :] = arm.payload.parameters * rng.uniform(0, 2, (size, 1))
    return p


def rounding_of_steps(p_hat: np.ndarray, phi: np.ndarray, Gamma: np.ndarray) -> np.ndarray:
    """Rounding of phi' Gamma^-1 dp_hat/dt, shape (size,), where dp_hat/dt is a difference of two p_hat by `TS`."""
    return (np.abs(phi) / Gamma * 4 * EPS * (np.abs(p_hat) + np.abs(phi)) / TS).sum(axis=1)
