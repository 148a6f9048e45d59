"""Measures what the theory of algorithm 1 says about saturated actuators, (27) and (28): C20."""

import numpy as np

from orchestration.paper import saturation
from orchestration.paper.calibrations import CHOSEN_CALIBRATION, Calibration
from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.claims.judged import Values
from orchestration.paper.evidence import PERIODS, Evidence
from orchestration.paper.numbers import TORQUE_SHARE


def gains_of(calibration: Calibration) -> saturation.Gains:
    """The numbers of algorithm 1 at a calibration."""
    values = calibration.values
    return saturation.Gains(values["Psi_1"], values["Gamma_1"], calibration.noise_bound)


def _saturation_bound(evidence: Evidence) -> Finding:
    gains = gains_of(CHOSEN_CALIBRATION)
    here, finer = (saturation.along(result, gains) for result in (evidence.results["fig6"], evidence.saturated_finely))
    return Finding(
        judge(here),
        f"{described(here)}. (28) is that of the law in continuous time: where gamma times the period exceeds 2, the"
        " sampled F_c overshoots e* = 0 in one tick, and above 4 it makes e* grow."
        f" Sampled every {1e6 * PERIODS[-1]:g} us, with limits of {TORQUE_SHARE:.0%} of the largest"
        f" torque at that period: {described(finer)}",
    )


def judge(run: saturation.Along) -> Values:
    """What C20 is asked of, from a run of algorithm 1 with saturation; nothing holds of a run without."""
    if not run.saturated.any():
        return dict.fromkeys(CRITERIA, float("nan"))
    first = int(run.saturated.argmax())
    return {
        limits.SATURATION_BOUND: run.excess(),
        limits.RISES_OUTSIDE: float(np.sum(_rises_outside(run))),
        limits.SATURATED_ENERGY: float(run.V[first:].max() / run.V[0]),
        limits.ENERGY_AT_END: float(run.V[-1] / run.V[0]),
    }


def described(run: saturation.Along) -> str:
    """The numbers of a run in a sentence."""
    saturated, region = run.saturated, run.region
    if not saturated.any():
        return "no actuator saturates, so (28) has nothing to say"
    first, last = np.flatnonzero(saturated)[[0, -1]]
    positive, rising, beyond = (
        float(np.mean(which[saturated])) for which in (run.bound > 0, run.rate > 0, run.rate > run.bound)
    )
    gain = float(np.median(run.gamma[saturated])) * float(run.time[1] - run.time[0])
    return (
        f"{saturated.sum()} saturated ticks from {run.time[first]:.4f} to {run.time[last]:.4f} s, |Delta F_s| up to"
        f" {run.missing.max():.3g} N, h* = {run.h_star:.3g} /kg; the right side of (28) is positive at {positive:.0%}"
        f" of these ticks, dV_c/dt at {rising:.0%}, and beyond (28) at {beyond:.1%}, by {run.excess():.1e} of V_c(0)"
        f" in all; V_c over V_c(0) {run.V[first] / run.V[0]:.1e} at the first of them, up to"
        f" {run.V[first : last + 1].max() / run.V[0]:.1e} until the last, {run.V[-1] / run.V[0]:.1e} at the end;"
        f" without F_c, (28) allows growth up to |e| = {region.e * 1e3:.3g} mm and |de| = {region.de:.3g} m/s, while"
        f" |e| <= {run.e[saturated].max() * 1e3:.2g} mm at saturated ticks; with F_c {np.sum(saturated & run.outside)}"
        f" of them lie outside, and V_c rises at {_rises_outside(run).sum()} of these; gamma times the period is"
        f" {gain:.2g} in the median"
    )


def _rises_outside(run: saturation.Along) -> np.ndarray:
    """Saturated ticks outside of the region of (28) at which V_c rises, shape (n_ticks,)."""
    return run.saturated & run.outside & (run.rate > 0)


CRITERIA = (limits.SATURATION_BOUND, limits.RISES_OUTSIDE, limits.SATURATED_ENERGY, limits.ENERGY_AT_END)

QUESTIONS = (
    Question(
        "C20",
        "Saturation may let V_c grow, though no faster than (28) says and not outside of a region of small errors;"
        " then V_c falls again",
        "III-D, (27)-(28)",
        CRITERIA,
        _saturation_bound,
        f"fig6, and fig5, fig6 sampled every {1e6 * PERIODS[-1]:g} us (seed 1)",
        "asked of fig6",
    ),
)
