"""Evaluates what the paper's theory says about saturated actuators, eqs. (27) and (28), along a run of algorithm 1.

    Delta F_s = J^-T (tau - tau_cmd)                     the tip force that saturation takes away
    |H_hat_x^-1| <= h*                                                                          (27)
    dV_c/dt <= -alpha - gamma beta^2 + 2 mu (delta + |Delta F_s|)
            <= -alpha - gamma beta^2 + 2 h* (delta + |Delta F_s|) beta                          (28)

So saturation may let V_c grow, though only where the errors are small: alpha and beta^2 are quadratic in (e, de),
and the last term is linear. Outside of a region of (e, de), whose size follows from the largest |Delta F_s|, the
right side of (28) is negative.
"""

import math
from dataclasses import dataclass

import casadi as ca
import numpy as np

from fmus.mechanics.algebra import solve_spd
from fmus.mechanics.planar_arm import PlanarArm
from orchestration.paper import lyapunov
from orchestration.paper.measure import ESTIMATE, at_ticks, norms
from orchestration.paper.numbers import ADAPTIVE_DAMPING, ARM, TARGET_INERTIA, TARGET_STIFFNESS
from orchestration.results.result import Result

SATURATION_COLUMNS = (
    *(
        f"{name}[{i}]"
        for name in ("controller.e", "controller.e_star", "controller.tau_cmd", "actuator.tau", "plant.q")
        for i in (1, 2)
    ),
    *(f"controller.{name}" for name in ("p_hat[1]", "alpha", "beta", "gamma", "mu")),
    ESTIMATE,
)
"""Columns that `along` needs."""
GROWTH = ("excess", "rises_outside", "largest", "end")
"""Names of the numbers of `growth`."""


@dataclass(frozen=True)
class Gains:
    """Numbers of a run of algorithm 1.

    Attributes
    ----------
    psi
        Psi, 1/s, the same for both axes.
    gain
        Gamma of m2, kg2.s2/m2.
    noise_bound
        The bound delta of the sensor's error, N, eq. (21).
    """

    psi: float
    gain: float
    noise_bound: float


@dataclass(frozen=True)
class Region:
    """Reach of the region of (e, de) outside of which the right side of (28) is negative.

    Attributes
    ----------
    e, de
        The largest |e|, m, and the largest |de|, m/s, in the region.
    """

    e: float
    de: float


@dataclass(frozen=True)
class Along:
    """Terms of (27) and (28) at the ticks of a run; arrays have the shape (n_ticks,).

    Attributes
    ----------
    time
        Instants of the ticks, s.
    missing
        |Delta F_s|, N; it is 0 where no actuator saturates.
    h_star
        Largest |H_hat_x^-1| of the run, 1/kg.
    beta, gamma
        |e*|, m/s, and the gain of F_c, 1/s.
    sharp, bound
        Right side of the line before (28), and of (28), m2/s3.
    V
        V_c, m2/s2.
    rate
        Difference of V_c to the next tick over the time between both, m2/s3; the last tick repeats its predecessor.
    e, de
        |e|, m, and |de|, m/s.
    region
        Where the right side of (28) may be positive at the largest |Delta F_s| of the run, if F_c does not help.
    """

    time: np.ndarray
    missing: np.ndarray
    h_star: float
    beta: np.ndarray
    gamma: np.ndarray
    sharp: np.ndarray
    bound: np.ndarray
    V: np.ndarray
    rate: np.ndarray
    e: np.ndarray
    de: np.ndarray
    region: Region

    @property
    def saturated(self) -> np.ndarray:
        """Whether an actuator saturates, shape (n_ticks,)."""
        return self.missing > 0

    @property
    def outside(self) -> np.ndarray:
        """Whether the right side of (28) is negative at the largest |Delta F_s| of the run, shape (n_ticks,)."""
        return self.bound + 2 * self.h_star * (self.missing.max() - self.missing) * self.beta < 0

    def excess(self) -> float:
        """Sum of what V_c's changes while saturated exceed the time integral of (28) by, over V_c at the start."""
        counted = self.saturated[:-1]
        beyond = np.diff(self.V) - self.bound[:-1] * np.diff(self.time)
        return float(beyond[counted & (beyond > 0)].sum() / self.V[0])


def growth(run: Along) -> dict[str, float]:
    """What V_c does in a run with saturation, as four numbers; all are NaN of a run without.

    Returns
    -------
    dict
        ``excess`` is that of `Along`. ``rises_outside`` is the number of saturated ticks outside of the region of (28)
        at which V_c rises; it is NaN if no saturated tick lies there, since nothing is known then. ``largest`` is the
        largest V_c from the first saturated tick on, and ``end`` is V_c at the end, both over V_c at the start.
    """
    saturated = run.saturated
    if not saturated.any():
        return dict.fromkeys(GROWTH, math.nan)
    outside = saturated & run.outside
    rises = float((outside & (run.rate > 0)).sum()) if outside.any() else math.nan
    largest, end = run.V[int(saturated.argmax()) :].max() / run.V[0], run.V[-1] / run.V[0]
    return dict(zip(GROWTH, (run.excess(), rises, float(largest), float(end)), strict=True))


def along(result: Result, gains: Gains) -> Along:
    """Evaluate (27) and (28) at the ticks of a run of algorithm 1."""
    q, masses = at_ticks(result, "plant.q"), at_ticks(result, "controller.p_hat", 2)
    tau, command = at_ticks(result, "actuator.tau"), at_ticks(result, "controller.tau_cmd")
    alpha, beta, gamma, mu = (result.at_ticks(f"controller.{name}") for name in ("alpha", "beta", "gamma", "mu"))
    e, e_star = at_ticks(result, "controller.e"), at_ticks(result, "controller.e_star")
    missing = norms(tip_force(q, tau - command))
    h_star = float(mobility_norm(q, masses).max())
    push, disturbance = alpha + gamma * beta**2, gains.noise_bound + missing
    time, V = result.tick_times("controller.e[1]"), lyapunov.craig(result, gains.psi, gains.gain)
    rate = np.diff(V) / np.diff(time)
    return Along(
        time=time,
        missing=missing,
        h_star=h_star,
        beta=beta,
        gamma=gamma,
        sharp=-push + 2 * mu * disturbance,
        bound=-push + 2 * h_star * disturbance * beta,
        V=V,
        rate=np.append(rate, rate[-1]),
        e=norms(e),
        de=norms(e_star - gains.psi * e),
        region=region(h_star * float(disturbance.max()), gains.psi),
    )


def region(
    acceleration: float,
    psi: float,
    stiffness: float = TARGET_STIFFNESS / TARGET_INERTIA,
    damping: float = ADAPTIVE_DAMPING / TARGET_INERTIA,
) -> Region:
    """Reach of the set alpha <= 2 h* (delta + |Delta F_s|) beta, outside of which (28) makes V_c fall even without F_c.

    Parameters
    ----------
    acceleration
        h* (delta + |Delta F_s|), m/s2.
    psi
        Psi, 1/s, between 0 and the damping.
    stiffness, damping
        K/M, 1/s2, and B/M, 1/s.

    Notes
    -----
    In the coordinates y = (e sqrt(2 psi k), de sqrt(2 (b - psi))) alpha is |y|^2 and beta is c |u'y| with a unit
    vector u. So the set consists of two disks of radius c h* (delta + |Delta F_s|) that touch at the origin.
    With two axes that have the same gains the reach is the same.
    """
    weights = np.array([math.sqrt(2 * psi * stiffness), math.sqrt(2 * (damping - psi))])
    direction = np.array([psi, 1.0]) / weights
    c = float(np.linalg.norm(direction))
    e, de = c * acceleration * (1 + direction / c) / weights
    return Region(float(e), float(de))


def tip_force(q: np.ndarray, tau: np.ndarray) -> np.ndarray:
    """The tip forces J^-T tau of the paper's arm, N, for joint angles, rad, and torques, N.m; all of shape (n, 2)."""
    angles = ca.SX.sym("q", 2)
    J = ca.Function("J", [angles], [ca.vec(PlanarArm(2).jacobian(angles, ARM.link_lengths))])
    columns = np.array(J.map(len(q))(q.T)).T.reshape(-1, 2, 2)  # the columns of J are the rows of J'
    return np.linalg.solve(columns, tau[:, :, None])[:, :, 0]


def mobility_norm(q: np.ndarray, masses: np.ndarray) -> np.ndarray:
    """The spectral norm of H_x^-1 = J H^-1 J' of the paper's arm, 1/kg, shape (n,).

    Parameters
    ----------
    q, masses
        Joint angles, rad, and masses, kg, both of shape (n, 2).
    """
    arm, angles, m = PlanarArm(2), ca.SX.sym("q", 2), ca.SX.sym("m", 2)
    J, H = arm.jacobian(angles, ARM.link_lengths), arm.inertia(angles, m, ARM.link_lengths)
    mobility = ca.Function("mobility", [angles, m], [ca.vec(ca.mtimes(J, solve_spd(H, J.T)))])
    matrices = np.array(mobility.map(len(q))(q.T, masses.T)).T.reshape(-1, 2, 2)
    return np.abs(np.linalg.eigvalsh(matrices)).max(axis=1)
