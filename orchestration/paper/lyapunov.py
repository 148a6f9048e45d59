"""Evaluates the Lyapunov functions V_c (17) and V_s (35) along runs; the true p is known here.

The numbers of a run (gains, the bound delta of the noise) are arguments, so that a study may vary them.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from orchestration.paper.cases import PLANAR_CASE, Kinetic
from orchestration.paper.measure import ESTIMATE, Contact, at_ticks, contact
from orchestration.paper.numbers import (
    ADAPTIVE_DAMPING,
    TARGET_INERTIA,
    TARGET_STIFFNESS,
    TRUE_M2,
)
from orchestration.paper.task_shape import lengths, scales
from orchestration.results.result import Result

_STIFFNESS, _DAMPING = TARGET_STIFFNESS / TARGET_INERTIA, ADAPTIVE_DAMPING / TARGET_INERTIA  # 1/s2 and 1/s

CRAIG_COLUMNS = tuple(f"controller.{name}[{i}]" for name in ("e", "e_star") for i in (1, 2))
"""Columns that `craig` needs, besides the estimate."""

SLIDING_COLUMNS = tuple(
    f"{name}[{i}]" for name in ("controller.s", "controller.e", "plant.q", "plant.F_ext", "plant.x") for i in (1, 2)
)
"""Columns that `sliding_bounds` needs, besides the estimate."""


@dataclass(frozen=True)
class Parameter:
    """A parameter that is adapted.

    Attributes
    ----------
    estimate
        Column of its estimate.
    true, gain
        Its true value, and Gamma.
    """

    estimate: str
    true: float
    gain: float


Gain = float | Sequence[Parameter]
"""Gamma of m2 where m2 alone is adapted, or all parameters that are."""


def craig(result: Result, psi: float, gain: Gain) -> np.ndarray:
    """V_c of algorithm 1 at the ticks of a run, shape (n_ticks,).

    Parameters
    ----------
    psi
        Psi, 1/s, the same for all coordinates.
    gain
        Gamma of m2, kg2.s2/m2, or the parameters that are adapted.
    """
    e, e_star = at_ticks(result, "controller.e"), at_ticks(result, "controller.e_star")
    de = e_star - psi * e
    quadratic = (_STIFFNESS + psi * _DAMPING) * e**2 + 2 * psi * e * de + de**2
    return (quadratic * scales(e.shape[1]) ** 2).sum(axis=1) + _parameter_error(result, gain)


def _parameter_error(result: Result, gain: Gain) -> np.ndarray:
    """The sum of (p_hat - p)^2 / Gamma, shape (n_ticks,)."""
    if isinstance(gain, (int, float)):
        return (result.at_ticks(ESTIMATE) - TRUE_M2) ** 2 / gain
    return np.sum([(result.at_ticks(one.estimate) - one.true) ** 2 / one.gain for one in gain], axis=0)


def craig_rise(result: Result, V: np.ndarray, layer: float) -> float:
    """Sum of V_c's rises at ticks with |e*| above a layer, m/s, over V_c at the start."""
    return rise(V, lengths(at_ticks(result, "controller.e_star"))[:-1] > layer)


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
        Gamma of m2, kg.s2/m2, or the parameters that are adapted.
    K_d
        N.s/m.
    noise_bound
        The bound delta of the sensor's error, N.
    kinetic
        Twice the kinetic energy s' H_x s, from q and s.
    """

    psi: float
    gain: Gain
    K_d: float
    noise_bound: float
    kinetic: Kinetic = PLANAR_CASE.kinetic


def sliding_bounds(result: Result, gains: SlidingGains) -> SlidingBounds:
    """Measure a run of algorithm 2 against the bounds of s and e.

    Raises
    ------
    NoContactError
        If the tip never touched the wall.
    """
    s, e = at_ticks(result, "controller.s"), lengths(at_ticks(result, "controller.e"))
    size = lengths(s)
    V = 0.5 * (gains.kinetic(at_ticks(result, "plant.q"), s) + _parameter_error(result, gains.gain))
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
