"""Evaluates the Lyapunov functions V_c (17) and V_s (35) along runs; the true p is known here.

The numbers of a run (gains, the bound delta of the noise) are arguments, so that a study may vary them.
"""

from dataclasses import dataclass

import numpy as np

from orchestration.paper.measure import ESTIMATE, Contact, at_ticks, contact, norms
from orchestration.paper.numbers import (
    ADAPTIVE_DAMPING,
    TARGET_INERTIA,
    TARGET_STIFFNESS,
    TRUE_M2,
    TRUE_MASSES,
)
from orchestration.results.result import Result

_STIFFNESS, _DAMPING = TARGET_STIFFNESS / TARGET_INERTIA, ADAPTIVE_DAMPING / TARGET_INERTIA  # 1/s2 and 1/s

CRAIG_COLUMNS = tuple(f"controller.{name}[{i}]" for name in ("e", "e_star") for i in (1, 2))
"""Columns that `craig` needs, besides the estimate."""

SLIDING_COLUMNS = tuple(
    f"{name}[{i}]" for name in ("controller.s", "controller.e", "plant.q", "plant.F_ext", "plant.x") for i in (1, 2)
)
"""Columns that `sliding_bounds` needs, besides the estimate."""


def craig(result: Result, psi: float, gain: float) -> np.ndarray:
    """V_c of algorithm 1 at the ticks of a run, shape (n_ticks,).

    Parameters
    ----------
    psi
        Psi, 1/s, the same for both axes.
    gain
        Gamma of m2, kg2.s2/m2.
    """
    e, e_star = at_ticks(result, "controller.e"), at_ticks(result, "controller.e_star")
    de = e_star - psi * e
    quadratic = (_STIFFNESS + psi * _DAMPING) * e**2 + 2 * psi * e * de + de**2
    return quadratic.sum(axis=1) + (result.at_ticks(ESTIMATE) - TRUE_M2) ** 2 / gain


def craig_rise(result: Result, V: np.ndarray, layer: float) -> float:
    """Sum of V_c's rises at ticks with |e*| above a layer, m/s, over V_c at the start."""
    return rise(V, norms(at_ticks(result, "controller.e_star"))[:-1] > layer)


def craig_growth(result: Result, V: np.ndarray, touch: Contact) -> float:
    """The largest V_c from the first to the last contact over V_c at the first contact."""
    ticks = result.tick_times("controller.e[1]")
    during = V[(ticks >= touch.first) & (ticks <= touch.last)]
    return float(during.max() / during[0])


def rise(V: np.ndarray, counted: np.ndarray) -> float:
    """Sum of the rises of V at the counted ticks but the last, shape (n_ticks - 1,), over V at the start."""
    change = np.diff(V)
    return float(change[counted & (change > 0)].sum() / V[0])


@dataclass(frozen=True)
class SlidingBounds:
    """What a run with the gain K_d says about the sliding variable s, m/s.

    Attributes
    ----------
    rise
        Sum of V_s's rises where |s| >= delta/k_d, over V_s(0).
    rms, rms_bound, largest
        Of |s| over the run, and the bound of this; largest from contact on.
    ultimate
        Largest |s| from contact on over delta/k_d.
    e_ratio
        Largest |e| over |e0| + sup|s|/psi.
    """

    rise: float
    rms: float
    rms_bound: float
    largest: float
    ultimate: float
    e_ratio: float


@dataclass(frozen=True)
class SlidingGains:
    """Numbers of a run of algorithm 2.

    Attributes
    ----------
    psi
        Psi, 1/s.
    gain
        Gamma of m2, kg.s2/m2.
    K_d
        N.s/m.
    noise_bound
        The bound delta of the sensor's error, N.
    """

    psi: float
    gain: float
    K_d: float
    noise_bound: float


def sliding_bounds(result: Result, gains: SlidingGains) -> SlidingBounds:
    """Measure a run of algorithm 2 against the bounds of s and e.

    Raises
    ------
    NoContactError
        If the tip never touched the wall.
    """
    s, e = at_ticks(result, "controller.s"), norms(at_ticks(result, "controller.e"))
    size, phi = norms(s), result.at_ticks(ESTIMATE) - TRUE_M2
    V = 0.5 * (_kinetic(result, s) + phi**2 / gains.gain)
    bound = gains.noise_bound / gains.K_d
    largest = float(size[result.tick_times("controller.s[1]") >= contact(result).first].max())
    return SlidingBounds(
        rise=rise(V, size[:-1] >= bound) if V[0] > 0 else 0.0,
        rms=float(np.sqrt((size**2).mean())),
        rms_bound=float(bound + np.sqrt(V[0] / (gains.K_d * (result.time[-1] - result.time[0])))),
        largest=largest,
        ultimate=largest / bound,
        e_ratio=float(e.max() / (e[0] + size.max() / gains.psi)),
    )


def _kinetic(result: Result, s: np.ndarray) -> np.ndarray:
    """Twice the kinetic energy S' H_x s of an arm whose tip moves with s, m/s, shape (n_ticks,).

    The masses are points at the ends of the links. So the second one moves with s, and the first one with l_1 dq_1.
    """
    q = at_ticks(result, "plant.q")
    second = q[:, 0] + q[:, 1]
    speed = (s[:, 0] * np.cos(second) + s[:, 1] * np.sin(second)) / np.sin(q[:, 1])
    return TRUE_MASSES[0] * speed**2 + TRUE_MASSES[1] * (s[:, 0] ** 2 + s[:, 1] ** 2)
