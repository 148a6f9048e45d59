"""Measures the claims about equations and Lyapunov functions: C14, C15, C17, C18.

The true p is known here, so V_c (17) and V_s can be evaluated along runs.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from types import ModuleType

import numpy as np

from orchestration.paper import lyapunov, spatial_theory, theory
from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.evidence import K_D_GRID, PERIODS, Evidence
from orchestration.paper.lyapunov import SlidingBounds, SlidingGains, sliding_bounds
from orchestration.paper.measure import at_ticks, contact
from orchestration.paper.numbers import TRUE_M2, WRONG_M2
from orchestration.paper.task_shape import SPATIAL, lengths
from orchestration.results.result import Result

LOOSE = 0.1  # ratio of the needed gamma to its bound below which the bound says next to nothing


def _craig_decreases(evidence: Evidence) -> Finding:
    psi, eps, margin = (
        evidence.scenario_value("fig5", f"controller.{name}") for name in ("Psi[1]", "gamma_eps", "gamma_margin")
    )
    gain = evidence.parameters("fig5")
    layer = eps / np.sqrt(margin - 1)
    rises, growths = [], []
    for result in evidence.sampled:
        V = lyapunov.craig(result, psi, gain)
        rises.append(lyapunov.craig_rise(result, V, layer))
        growths.append(lyapunov.craig_growth(result, V, contact(result)))
    shown = evidence.results["fig5"]
    growth = lyapunov.craig_growth(shown, lyapunov.craig(shown, psi, gain), contact(shown))
    orders = [order(coarser, finer) for coarser, finer in pairwise(rises)]
    return Finding(
        {limits.CRAIG_GROWTH: growth, limits.CRAIG_ORDER: orders},
        f"during contact V_c of fig5 grows {growth:.4g}-fold; at {_periods(evidence.case.periods)} us, with the same"
        f" noise, {_list(growths, '.4g')}-fold; its rises outside of the boundary layer over V_c(0) at these periods:"
        f" {_list(rises, '.2%')} (orders {_list(orders, '.2f')}). {_by_period(growths)}",
    )


def order(coarser: float, finer: float) -> float:
    """The power of the sampling period with which a size falls at half the period; infinite if it vanishes there."""
    return math.inf if finer == 0 else float(np.log2(coarser / finer))


def _by_period(growths: Sequence[float]) -> str:
    """What the growth of V_c at periods that become shorter says about the sampled F_c."""
    if all(finer < coarser for coarser, finer in pairwise(growths)):
        return "A sampled F_c lets V_c grow, the less the faster it is sampled"
    return "The growth does not fall at each shorter period"


def _sliding(evidence: Evidence, results: Sequence[Result], *, in_proportion: bool = False) -> list[SlidingBounds]:
    """What runs at the gains K_d of the case say about s."""
    case = evidence.case
    psi, damping = (evidence.scenario_value("fig7", f"controller.{name}[1]") for name in ("Psi", "K_d"))
    bounds = []
    for result, K_d in zip(results, case.dampings, strict=True):
        parameters = evidence.parameters("fig7", K_d / damping if in_proportion else 1.0)
        gains = SlidingGains(psi, parameters, K_d, case.noise_bound, case.kinetic)
        bounds.append(sliding_bounds(result, gains))
    return bounds


def _sliding_is_bounded(evidence: Evidence) -> Finding:
    known, unknown = (_sliding(evidence, r) for r in (evidence.damped_from_true, evidence.damped_from_wrong))
    rows = (*unknown, *known)
    falls, rms, e_ratio = np.max([(row.rise, row.rms / row.rms_bound, row.e_ratio) for row in rows], axis=0)
    large = sum(_ticks_of_large_s(evidence, r) for r in (evidence.damped_from_true, evidence.damped_from_wrong))
    return Finding(
        {limits.RISE: falls, limits.RMS: rms, limits.ERROR_BOUND: e_ratio},
        f"{where_s_is_large(large, falls)}; rms(s) at most {rms:.2f} of its bound; |e|"
        f" at most {e_ratio:.2f} of |e0| + sup|s|/psi; largest |s| from contact on over delta/k_d, at K_d ="
        f" {_list(evidence.case.dampings, 'g')}: {_list([r.ultimate for r in known], '.2g')} from the true m2,"
        f" {_list([r.ultimate for r in unknown], '.2g')} from {WRONG_M2:g} kg: the paper's ultimate bound |s| <="
        " delta/k_d need not hold before m2_hat is right (V_s contains phi)",
    )


def _ticks_of_large_s(evidence: Evidence, results: Sequence[Result]) -> int:
    """The number of ticks with |s| >= delta/k_d in runs at the gains K_d of the case."""
    delta, pairs = evidence.case.noise_bound, zip(results, evidence.case.dampings, strict=True)
    return sum(int((lengths(at_ticks(result, "controller.s")) >= delta / K_d).sum()) for result, K_d in pairs)


def where_s_is_large(ticks: int, rise: float) -> str:
    """What V_s does at the ticks with |s| >= delta/k_d: its largest rise in a run, as a share of V_s(0)."""
    if not ticks:
        return "no tick has |s| >= delta/k_d, so the runs say nothing of what V_s does there"
    return f"V_s rises by at most {rise:.1e} of V_s(0) at the {ticks} ticks with |s| >= delta/k_d"


def _smaller_with_gain(evidence: Evidence) -> Finding:
    wrong, true, grown = (
        [1e3 * row.largest for row in rows]
        for rows in (
            _sliding(evidence, evidence.damped_from_wrong),
            _sliding(evidence, evidence.damped_from_true),
            _sliding(evidence, evidence.damped_in_proportion, in_proportion=True),
        )
    )
    grid = evidence.case.dampings
    return Finding(
        {limits.FALLS_WITH_GAIN: [b / a for a, b in pairwise(wrong)]},
        f"largest |s| from contact on, in mm/s, at K_d = {_list(grid, 'g')}: from {WRONG_M2:g} kg"
        f" {_list(wrong, '.3g')}; from the true m2 {_list(true, '.3g')}; from {WRONG_M2:g} kg"
        f" with a Gamma that grows in proportion to K_d {_list(grown, '.3g')}. From {WRONG_M2:g} kg"
        f" {steps(wrong, grid)}; from the true m2 {steps(true, grid)}; with a Gamma in proportion to K_d"
        f" {steps(grown, grid)}",
    )


def steps(sizes: Sequence[float], grid: Sequence[float] = K_D_GRID) -> str:
    """At which steps of a grid of K_d the sizes of s fall, in words."""
    risen = [
        f"from K_d = {low:g} to {high:g}"
        for (low, high), (before, after) in zip(pairwise(grid), pairwise(sizes), strict=True)
        if after >= before
    ]
    return f"s does not fall {' and '.join(risen)}" if risen else "s falls at each step"


def _list(values: Sequence[float], form: str) -> str:
    return ", ".join(format(value, form) for value in values)


def _gamma_bound(evidence: Evidence) -> Finding:
    result = evidence.results["fig5"]
    beta, mu, alpha = (result.at_ticks(f"controller.{n}") for n in ("beta", "mu", "alpha"))
    bound = result.at_ticks("controller.gamma_bound")
    case_c = bound > 0
    delta = _noise_bounds(evidence, result)
    needed = (2 * mu[case_c] * delta[case_c] - alpha[case_c]) / beta[case_c] ** 2
    ratio = needed / bound[case_c]
    return Finding({limits.CASE_C: case_c.sum(), limits.GAMMA: ratio}, bounded(ratio))


def _noise_bounds(evidence: Evidence, result: Result) -> np.ndarray:
    """The bound delta at the ticks of a run, N, shape (n_ticks,); in space a moment counts E' m in the coordinates."""
    ticks = result.tick_times("controller.beta")
    delta = evidence.scenario_value("fig5", "controller.noise_bound")
    if evidence.case.shape.size != SPATIAL:
        return np.full(len(ticks), delta)
    pitch = result["plant.x[5]"][np.searchsorted(result.time, ticks - 1e-9)]
    return delta * np.sqrt(1 + np.abs(np.sin(pitch)))


def bounded(ratio: np.ndarray) -> str:
    """What the ratios of the needed gamma to gamma* say, shape (n_ticks,)."""
    if not ratio.size:
        return "no tick is in case (c), so nothing is known of the bound"
    true = limits.GAMMA.met(ratio)
    loose = true and float(ratio.max()) < LOOSE
    return (
        f"needed / gamma* <= {ratio.max():.3g} over {ratio.size} ticks in case (c), median {np.median(ratio):.2g}: the"
        f" bound is {'true' if true else 'not true'}"
        f"{', and says next to nothing about the size of gamma' if loose else ''}"
    )


def _equations(evidence: Evidence) -> tuple[ModuleType, int]:
    """The equations of the arm at random states, and its number of joints."""
    return (spatial_theory, 6) if evidence.case.shape.size == SPATIAL else (theory, 2)


def _forms_agree(evidence: Evidence) -> Finding:
    equations, n = _equations(evidence)
    square, redundant = equations.form_difference(), equations.redundant_residual()
    return Finding(
        {limits.FORMS: (square, redundant)},
        f"n = {n}: relative difference of tau {square:.1e}; n = {n + 1}: (5) meets (3) to {redundant:.1e} relative",
    )


def _skew_symmetric(evidence: Evidence) -> Finding:
    residual = _equations(evidence)[0].skew_residual()
    return Finding({limits.SKEW: residual}, f"symmetric part of dH_x/dt - 2 C_x: {residual:.1e} of its norm")


_DAMPINGS = f"K_d from {K_D_GRID[0]:g} to {K_D_GRID[-1]:g} N.s/m"


def _periods(periods: Sequence[float]) -> str:
    """Periods in us."""
    return _list([1e6 * period for period in periods], "g")


_PERIODS = _periods(PERIODS)

QUESTIONS = (
    Question(
        "C14a",
        "With F_c and (25) V_c decreases in contact",
        "III-C, (20)-(25)",
        (limits.CRAIG_GROWTH, limits.CRAIG_ORDER),
        _craig_decreases,
        "fig5, and fig5 at four sampling periods (seed 1)",
        f"sampling periods of {_PERIODS} us; shares of seeds and of the space ask for the first criterion alone",
    ),
    Question(
        "C14b",
        "V_s decreases where |s| >= delta/k_d, so s is bounded; |e| <= |e0| + sup|s|/psi",
        "IV-A, (35)",
        (limits.RISE, limits.RMS, limits.ERROR_BOUND),
        _sliding_is_bounded,
        f"fig7 without limits at five K_d from m2 = {WRONG_M2:g} and {TRUE_M2:g} kg (seed 1)",
        _DAMPINGS,
    ),
    Question(
        "C14c",
        "A larger K_d gives a smaller s",
        "IV-A, (35)",
        (limits.FALLS_WITH_GAIN,),
        _smaller_with_gain,
        f"fig7 without limits at five K_d from m2 = {WRONG_M2:g} kg (seed 1)",
        _DAMPINGS,
    ),
    Question(
        "C15",
        "The forms (4), (5), (6)-(7) agree for a square J; (5) serves a redundant arm",
        "II-B",
        (limits.FORMS,),
        _forms_agree,
    ),
    Question(
        "C17",
        "gamma* of (26) bounds the needed gamma",
        "(26)",
        (limits.CASE_C, limits.GAMMA),
        _gamma_bound,
        "fig5 (seed 1)",
    ),
    Question(
        "C18",
        "dH_x/dt - 2 C_x is skew-symmetric",
        "IV-A",
        (limits.SKEW,),
        _skew_symmetric,
    ),
)
