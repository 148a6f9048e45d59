"""Measures the claims about equations and Lyapunov functions: C14, C15, C17, C18.

The true p is known here, so V_c (17) and V_s can be evaluated along runs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import casadi as ca
import numpy as np

from fmus.mechanics.planar_arm import PlanarArm
from orchestration.paper import theory
from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.evidence import K_D_GRID, PERIODS, Evidence
from orchestration.paper.measure import ESTIMATE, at_ticks, contact, norms
from orchestration.paper.numbers import ARM, NOISE_BOUND, TRUE_M2, TRUE_MASSES, WRONG_M2
from orchestration.results.result import Result


def _craig_rise(evidence: Evidence, result: Result) -> float:
    """Sum of V_c's rises outside the boundary layer, over V_c(0)."""
    psi = evidence.scenario_value("fig5", "controller.Psi[1]")
    M, B, K = (evidence.scenario_value("fig5", f"controller.{name}[1]") for name in ("M", "B", "K"))
    gain = evidence.scenario_value("fig5", "controller.Gamma[2]")
    eps = evidence.scenario_value("fig5", "controller.gamma_eps")
    margin = evidence.scenario_value("fig5", "controller.gamma_margin")
    e, e_star = at_ticks(result, "controller.e"), at_ticks(result, "controller.e_star")
    de = e_star - psi * e
    quadratic = (K / M + psi * B / M) * e**2 + 2 * psi * e * de + de**2
    V = quadratic.sum(axis=1) + (result.at_ticks(ESTIMATE) - TRUE_M2) ** 2 / gain
    outside = norms(e_star)[:-1] > eps / np.sqrt(margin - 1)
    return _rise(V, outside)


def _rise(V: np.ndarray, counted: np.ndarray) -> float:
    change = np.diff(V)
    return float(change[counted & (change > 0)].sum() / V[0])


@dataclass(frozen=True)
class Bounds:
    """What a run with the gain K_d says about the sliding variable s, m/s.

    Attributes
    ----------
    rise
        Sum of V_s's rises where |s| >= delta/k_d, over V_s(0).
    rms, largest
        Of |s| over the run; largest from contact on.
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


def _bounds(evidence: Evidence, result: Result, K_d: float) -> Bounds:
    gain = evidence.scenario_value("fig7", "controller.Gamma[2]")
    psi = evidence.scenario_value("fig7", "controller.Psi[1]")
    s, e = at_ticks(result, "controller.s"), norms(at_ticks(result, "controller.e"))
    size, phi = norms(s), result.at_ticks(ESTIMATE) - TRUE_M2
    V = 0.5 * (_kinetic(result, s) + phi**2 / gain)
    bound = NOISE_BOUND / K_d
    largest = float(size[result.tick_times("controller.s[1]") >= contact(result).first].max())
    return Bounds(
        rise=_rise(V, size[:-1] >= bound) if V[0] > 0 else 0.0,
        rms=float(np.sqrt((size**2).mean())),
        rms_bound=float(bound + np.sqrt(V[0] / (K_d * (result.time[-1] - result.time[0])))),
        largest=largest,
        ultimate=largest / bound,
        e_ratio=float(e.max() / (e[0] + size.max() / psi)),
    )


def _kinetic(result: Result, s: np.ndarray) -> np.ndarray:
    """S' H_x s at the ticks, shape (n_ticks,)."""
    arm = PlanarArm(2)
    q, v = ca.SX.sym("q", 2), ca.SX.sym("v", 2)
    dq = ca.solve(arm.jacobian(q, ARM.link_lengths), v)
    energy = ca.Function("energy", [q, v], [ca.mtimes([dq.T, arm.inertia(q, TRUE_MASSES, ARM.link_lengths), dq])])
    states = at_ticks(result, "plant.q")
    return np.array(energy.map(len(s))(states.T, s.T)).ravel()


def _stability(evidence: Evidence) -> Finding:
    rises = [_craig_rise(evidence, result) for result in evidence.sampled]
    orders = [np.log(a / b) / np.log(2) for a, b in pairwise(rises)]
    unknown, known = (
        [_bounds(evidence, r, k) for r, k in zip(results, K_D_GRID, strict=True)]
        for results in (evidence.damped_from_wrong, evidence.damped_from_true)
    )
    falls = max(row.rise for row in (*unknown, *known))
    rms = max(row.rms / row.rms_bound for row in (*unknown, *known))
    e_ratio = max(row.e_ratio for row in (*unknown, *known))
    from_true, from_wrong = ([1e3 * row.largest for row in rows] for rows in (known, unknown))
    parts = (
        f"rises of V_c over V_c(0) at {_PERIODS} us: {_list(rises, '.2%')} (orders {_list(orders, '.2f')}),"
        " so it decreases in the limit",
        f"V_s rises by at most {falls:.1e} of V_s(0) where |s| >= delta/k_d",
        f"rms(s) at most {rms:.2f} of its bound",
        f"largest |s| in mm/s from contact on at K_d = {_list(K_D_GRID, 'g')}: {_list(from_true, '.3g')} from"
        f" the true m2, {_list(from_wrong, '.3g')} from {WRONG_M2:g} kg (a larger K_d slows the adaptation)",
        f"over delta/k_d {_list([r.ultimate for r in known], '.2g')} and"
        f" {_list([r.ultimate for r in unknown], '.2g')}: the paper's ultimate bound |s| <= delta/k_d holds"
        " once m2_hat is right, and not before (V_s contains phi)",
        f"|e| at most {e_ratio:.2f} of |e0| + sup|s|/psi",
    )
    values = {
        limits.CRAIG_ORDER: orders,
        limits.RISE: falls,
        limits.RMS: rms,
        limits.FALLS_WITH_GAIN: [b.largest / a.largest for a, b in pairwise(known)],
        limits.ERROR_BOUND: e_ratio,
    }
    return Finding(values, "; ".join(parts))


def _list(values: Sequence[float], form: str) -> str:
    return ", ".join(format(value, form) for value in values)


def _gamma_bound(evidence: Evidence) -> Finding:
    result = evidence.results["fig5"]
    beta, mu, alpha = (result.at_ticks(f"controller.{n}") for n in ("beta", "mu", "alpha"))
    bound = result.at_ticks("controller.gamma_bound")
    case_c = bound > 0
    needed = (2 * mu[case_c] * NOISE_BOUND - alpha[case_c]) / beta[case_c] ** 2
    ratio = needed / bound[case_c]
    return Finding(
        {limits.CASE_C: case_c.sum(), limits.GAMMA: ratio},
        f"needed / gamma* <= {ratio.max():.3g} over {case_c.sum()} ticks in case (c), median {np.median(ratio):.2g}",
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


_PERIODS = _list([1e6 * period for period in PERIODS], "g")  # us

QUESTIONS = (
    Question(
        "C14",
        "With F_c and (25) V_c decreases; V_s decreases where |s| >= delta/k_d, so s is bounded; a larger K_d"
        " gives a smaller s; |e| <= |e0| + sup|s|/psi",
        "(20)-(25), (35)",
        (limits.CRAIG_ORDER, limits.RISE, limits.RMS, limits.FALLS_WITH_GAIN, limits.ERROR_BOUND),
        _stability,
        f"fig5 at three sampling periods, fig7 without limits at five K_d from m2 = {WRONG_M2:g} and {TRUE_M2:g} kg"
        " (seed 1)",
        f"sampling periods of {_PERIODS} us; K_d from {K_D_GRID[0]:g} to {K_D_GRID[-1]:g} N.s/m",
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
