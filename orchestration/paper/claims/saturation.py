"""Measures what the theory of algorithm 1 says about saturated actuators, (27) and (28): C20."""

import numpy as np

from orchestration.paper import saturation
from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.evidence import Evidence
from orchestration.paper.numbers import NOISE_BOUND


def _saturation_bound(evidence: Evidence) -> Finding:
    gains = saturation.Gains(
        psi=evidence.scenario_value("fig6", "controller.Psi[1]"),
        gain=evidence.scenario_value("fig6", "controller.Gamma[2]"),
        noise_bound=NOISE_BOUND,
    )
    return judge(saturation.along(evidence.results["fig6"], gains))


def judge(run: saturation.Along) -> Finding:
    """What a run of algorithm 1 with saturation says about C20."""
    ticks = np.flatnonzero(run.saturated)
    if not ticks.size:
        nothing = dict.fromkeys(CRITERIA, float("nan"))
        return Finding(nothing, "no actuator saturates, so (28) has nothing to say")
    first, last = ticks[[0, -1]]
    saturated = run.saturated
    outside = saturated & run.outside
    positive, rising = (float(np.mean(values[saturated] > 0)) for values in (run.bound, run.rate))
    beyond = float(np.mean(run.rate[saturated] > run.bound[saturated]))
    values = {
        limits.SATURATION_BOUND: run.excess(),
        limits.RISES_OUTSIDE: float(np.sum(outside & (run.rate > 0))),
        limits.SATURATED_ENERGY: float(run.V[first:].max() / run.V[0]),
        limits.ENERGY_AT_END: float(run.V[-1] / run.V[0]),
    }
    region, size = run.region, run.e[saturated].max()
    text = (
        f"{ticks.size} saturated ticks from {run.time[first]:.4f} to {run.time[last]:.4f} s, |Delta F_s| up to"
        f" {run.missing.max():.3g} N, h* = {run.h_star:.3g} /kg; the right side of (28) is positive at {positive:.0%}"
        f" of these ticks, dV_c/dt at {rising:.0%}, beyond (28) at {beyond:.0%} (a sampled law: these rises sum to"
        f" {run.excess():.1e} of V_c(0)); V_c over V_c(0) {run.V[first] / run.V[0]:.1e} at the first of them, up to"
        f" {run.V[first : last + 1].max() / run.V[0]:.1e} until the last, {run.V[-1] / run.V[0]:.1e} at the end;"
        f" the region in which (28) allows growth without F_c reaches to |e| = {region.e * 1e3:.3g} mm and"
        f" |de| = {region.de:.3g} m/s, while |e| <= {size * 1e3:.2g} mm at saturated ticks, {outside.sum()} of which"
        " lie outside: the bound is true, and far from tight"
    )
    return Finding(values, text)


CRITERIA = (limits.SATURATION_BOUND, limits.RISES_OUTSIDE, limits.SATURATED_ENERGY, limits.ENERGY_AT_END)

QUESTIONS = (
    Question(
        "C20",
        "Saturation may let V_c grow, though no faster than (28) says and not outside of a region of small errors;"
        " then V_c falls again",
        "III-D, (27)-(28)",
        CRITERIA,
        _saturation_bound,
        "fig6 (seed 1)",
    ),
)
