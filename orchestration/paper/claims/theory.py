"""Measures the claims about equations and Lyapunov functions: C14, C15, C17, C18.

The true p is known here, so V_c (17) and V_s can be evaluated along runs.
"""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from orchestration.paper import lyapunov, theory
from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.evidence import K_D_GRID, PERIODS, Evidence
from orchestration.paper.lyapunov import SlidingBounds, SlidingGains, sliding_bounds
from orchestration.paper.measure import at_ticks, contact, norms
from orchestration.paper.numbers import NOISE_BOUND, TRUE_M2, WRONG_M2
from orchestration.results.result import Result

LOOSE = 0.1  # ratio of the needed gamma to its bound below which the bound says next to nothing


def _craig_decreases(evidence: Evidence) -> Finding:
    psi, gain, eps, margin = (
        evidence.scenario_value("fig5", f"controller.{name}")
        for name in ("Psi[1]", "Gamma[2]", "gamma_eps", "gamma_margin")
    )
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
        f"during contact V_c of fig5 grows {growth:.4g}-fold; at {_PERIODS} us, with the same noise,"
        f" {_list(growths, '.4g')}-fold; its rises outside of the boundary layer over V_c(0) at these periods:"
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
    """What runs at the gains `K_D_GRID` say about s."""
    psi, gain, damping = (evidence.scenario_value("fig7", f"controller.{n}") for n in ("Psi[1]", "Gamma[2]", "K_d[1]"))
    return [
        sliding_bounds(result, SlidingGains(psi, gain * (K_d / damping if in_proportion else 1), K_d, NOISE_BOUND))
        for result, K_d in zip(results, K_D_GRID, strict=True)
    ]


def _sliding_is_bounded(evidence: Evidence) -> Finding:
    known, unknown = (_sliding(evidence, r) for r in (evidence.damped_from_true, evidence.damped_from_wrong))
    rows = (*unknown, *known)
    falls, rms = max(row.rise for row in rows), max(row.rms / row.rms_bound for row in rows)
    e_ratio = max(row.e_ratio for row in rows)
    large = sum(_ticks_of_large_s(r) for r in (evidence.damped_from_true, evidence.damped_from_wrong))
    return Finding(
        {limits.RISE: falls, limits.RMS: rms, limits.ERROR_BOUND: e_ratio},
        f"{where_s_is_large(large, falls)}; rms(s) at most {rms:.2f} of its bound; |e|"
        f" at most {e_ratio:.2f} of |e0| + sup|s|/psi; largest |s| from contact on over delta/k_d, at K_d ="
        f" {_list(K_D_GRID, 'g')}: {_list([r.ultimate for r in known], '.2g')} from the true m2,"
        f" {_list([r.ultimate for r in unknown], '.2g')} from {WRONG_M2:g} kg: the paper's ultimate bound |s| <="
        " delta/k_d need not hold before m2_hat is right (V_s contains phi)",
    )


def _ticks_of_large_s(results: Sequence[Result]) -> int:
    """The number of ticks with |s| >= delta/k_d in runs at the gains `K_D_GRID`."""
    pairs = zip(results, K_D_GRID, strict=True)
    return sum(int((norms(at_ticks(result, "controller.s")) >= NOISE_BOUND / K_d).sum()) for result, K_d in pairs)


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
    return Finding(
        {limits.FALLS_WITH_GAIN: [b / a for a, b in pairwise(wrong)]},
        f"largest |s| from contact on, in mm/s, at K_d = {_list(K_D_GRID, 'g')}: from {WRONG_M2:g} kg"
        f" {_list(wrong, '.3g')}; from the true m2 {_list(true, '.3g')}; from {WRONG_M2:g} kg"
        f" with a Gamma that grows in proportion to K_d {_list(grown, '.3g')}. From {WRONG_M2:g} kg {steps(wrong)};"
        f" from the true m2 {steps(true)}; with a Gamma in proportion to K_d {steps(grown)}",
    )


def steps(sizes: Sequence[float]) -> str:
    """At which steps of `K_D_GRID` the sizes of s fall, in words."""
    risen = [
        f"from K_d = {low:g} to {high:g}"
        for (low, high), (before, after) in zip(pairwise(K_D_GRID), pairwise(sizes), strict=True)
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
    needed = (2 * mu[case_c] * NOISE_BOUND - alpha[case_c]) / beta[case_c] ** 2
    ratio = needed / bound[case_c]
    return Finding({limits.CASE_C: case_c.sum(), limits.GAMMA: ratio}, bounded(ratio))


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


def _forms_agree(evidence: Evidence) -> Finding:  # noqa: ARG001 - needs no run
    square, redundant = theory.form_difference(), theory.redundant_residual()
    return Finding(
        {limits.FORMS: (square, redundant)},
        f"n = 2: relative difference of tau {square:.1e}; n = 3: (5) meets (3) to {redundant:.1e} relative",
    )


def _skew_symmetric(evidence: Evidence) -> Finding:  # noqa: ARG001 - needs no run
    residual = theory.skew_residual()
    return Finding({limits.SKEW: residual}, f"symmetric part of dH_x/dt - 2 C_x: {residual:.1e} of its norm")


_DAMPINGS = f"K_d from {K_D_GRID[0]:g} to {K_D_GRID[-1]:g} N.s/m"
_PERIODS = _list([1e6 * period for period in PERIODS], "g")  # us

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
