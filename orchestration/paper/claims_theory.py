"""Claims about equations and Lyapunov functions: C14, C15, C17, C18.

The true p is known here, so V_c (17) and V_s can be evaluated along runs.
"""

from itertools import pairwise

import casadi as ca
import numpy as np

from fmus.arm import PlanarArm
from orchestration.paper import theory
from orchestration.paper.claim import Finding, Question
from orchestration.paper.evidence import K_D_GRID, Evidence
from orchestration.paper.measure import ESTIMATE, TRUE_M2, at_ticks, norms
from orchestration.paper.scenarios import NOISE_BOUND, TRUE_MASSES
from orchestration.result import Result


def _craig_lyapunov(evidence: Evidence) -> tuple[float, int]:
    """V_c's increase outside the boundary layer over the fall to its least value, and ticks there."""
    result = evidence.results["fig5"]
    value = evidence.scenario_value
    psi = value("fig5", "controller.Psi[1]")
    M, B, K = (value("fig5", f"controller.{name}[1]") for name in ("M", "B", "K"))
    gain = value("fig5", "controller.Gamma[2]")
    eps, margin = value("fig5", "controller.gamma_eps"), value("fig5", "controller.gamma_margin")
    e, e_star = at_ticks(result, "controller.e"), at_ticks(result, "controller.e_star")
    de = e_star - psi * e
    quadratic = (K / M + psi * B / M) * e**2 + 2 * psi * e * de + de**2
    V = quadratic.sum(axis=1) + (result.at_ticks(ESTIMATE) - TRUE_M2) ** 2 / gain
    outside = result.at_ticks("controller.beta")[:-1] > eps / np.sqrt(margin - 1)
    change = np.diff(V)
    rise = float(change[outside & (change > 0)].sum())
    return rise / float(V[0] - V.min()), int(outside.sum())


def _slotine_li_lyapunov(evidence: Evidence, result: Result, K_d: float) -> dict[str, float]:
    """Numbers of the statements on s at one gain."""
    gain = evidence.scenario_value("fig7", "controller.Gamma[2]")
    psi = evidence.scenario_value("fig7", "controller.Psi[1]")
    s, e = at_ticks(result, "controller.s"), norms(at_ticks(result, "controller.e"))
    size, phi = norms(s), result.at_ticks(ESTIMATE) - TRUE_M2
    V = 0.5 * (_kinetic(result, s) + phi**2 / gain)
    change, bound = np.diff(V), NOISE_BOUND / K_d
    outside = size[:-1] >= bound
    duration = result.time[-1] - result.time[0]
    return {
        "rise": float(change[outside & (change > 0)].sum() / V[0]),
        "rms": float(np.sqrt((size**2).mean())),
        "rms_bound": float(bound + np.sqrt(V[0] / (K_d * duration))),
        "ultimate": float(size[size.size // 2 :].max() / bound),
        "largest": float(size[int(0.45 * size.size) :].max()),
        "e": float(e.max()),
        "e_bound": float(e[0] + size.max() / psi),
    }


def _kinetic(result: Result, s: np.ndarray) -> np.ndarray:
    """S' H_x s at the ticks, shape (n_ticks,)."""
    arm = PlanarArm(2)
    q, v = ca.SX.sym("q", 2), ca.SX.sym("v", 2)
    dq = ca.solve(arm.jacobian(q, [1, 1]), v)
    energy = ca.Function("energy", [q, v], [ca.mtimes([dq.T, arm.inertia(q, TRUE_MASSES, [1, 1]), dq])])
    states = at_ticks(result, "plant.q")
    return np.array(energy.map(len(s))(states.T, s.T)).ravel()


def _stability(evidence: Evidence) -> Finding:
    rise, ticks = _craig_lyapunov(evidence)
    rows = [_slotine_li_lyapunov(evidence, r, k) for r, k in zip(evidence.damped, K_D_GRID, strict=True)]
    monotone = all(a["largest"] > b["largest"] for a, b in pairwise(rows))
    rms = all(row["rms"] <= row["rms_bound"] for row in rows)
    falls = max(row["rise"] for row in rows)
    bounded = all(row["e"] <= row["e_bound"] for row in rows)
    ultimate = ", ".join(f"{row['ultimate']:.2g}" for row in rows)
    largest = ", ".join(f"{row['largest'] * 1e3:.2g}" for row in rows)
    return Finding(
        rise <= 0.01 and falls <= 0.01 and rms and monotone and bounded,
        f"V_c rises by {rise:.2%} of its fall over {ticks} ticks outside the layer; V_s rises by at most"
        f" {falls:.2%} of V_s(0) where |s| >= delta/k_d; rms(s) within its bound: {rms}; at K_d ="
        f" {', '.join(f'{k:g}' for k in K_D_GRID)}: largest |s| from contact on {largest} mm/s (falling:"
        f" {monotone}),"
        f" over delta/k_d {ultimate} in the second half (the paper's ultimate bound asks for <= 1);"
        f" |e| <= |e0| + sup|s|/psi: {bounded}",
    )


def _gamma_bound(evidence: Evidence) -> Finding:
    result = evidence.results["fig5"]
    beta, mu, alpha = (result.at_ticks(f"controller.{n}") for n in ("beta", "mu", "alpha"))
    bound = result.at_ticks("controller.gamma_bound")
    case_c = bound > 0
    needed = (2 * mu[case_c] * NOISE_BOUND - alpha[case_c]) / beta[case_c] ** 2
    ratio = needed / bound[case_c]
    return Finding(
        bool(case_c.any() and ratio.max() <= 1 + 1e-9),
        f"needed / gamma* <= {ratio.max():.3g} over {case_c.sum()} ticks in case (c), median"
        f" {np.median(ratio):.2g}",
    )


def _forms_agree(evidence: Evidence) -> Finding:  # noqa: ARG001 - needs no run
    square, redundant = theory.form_difference(), theory.redundant_residual()
    return Finding(
        square <= 1e-10 and redundant <= 1e-10,
        f"n = 2: relative difference of tau {square:.1e}; n = 3: (5) meets (3) to {redundant:.1e} relative",
    )


def _skew_symmetric(evidence: Evidence) -> Finding:  # noqa: ARG001 - needs no run
    residual = theory.skew_residual()
    return Finding(residual <= 1e-10, f"symmetric part of dH_x/dt - 2 C_x: {residual:.1e} of its norm")


QUESTIONS = (
    Question(
        "C14",
        "With F_c and (25) V_c decreases; V_s decreases where |s| >= delta/k_d, so s is bounded; a larger K_d"
        " gives a smaller s; |e| <= |e0| + sup|s|/psi",
        "(20)-(25), (35)",
        "sampled at 20 us: rises of V_c outside beta < eps/sqrt(margin - 1), and of V_s where"
        " |s| >= delta/k_d, at most 1 % of the fall; rms(s) <= delta/k_d + sqrt(V_s(0)/(k_d T)); |s| from contact on falls with"
        " K_d from 30 to 3000",
        _stability,
        "fig5, fig7 without limits at five K_d (seed 1)",
    ),
    Question(
        "C15",
        "The forms (4), (5), (6)-(7) agree for a square J; (5) serves a redundant arm",
        "II-B",
        "relative differences <= 1e-10 at 1000 random states",
        _forms_agree,
    ),
    Question(
        "C17",
        "gamma* of (26) bounds the needed gamma",
        "(26)",
        "(2 mu delta - alpha)/beta^2 <= gamma* at every tick in case (c)",
        _gamma_bound,
        "fig5 (seed 1)",
    ),
    Question(
        "C18",
        "dH_x/dt - 2 C_x is skew-symmetric",
        "IV-A",
        "symmetric part <= 1e-10 of the norm at 1000 random states",
        _skew_symmetric,
    ),
)
