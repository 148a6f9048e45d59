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
        f"{described(here)}. Sampled every {1e6 * PERIODS[-1]:g} us, with limits of {TORQUE_SHARE:.0%} of the largest"
        f" torque at that period: {described(finer)}. {cause(here, finer)}",
    )


def judge(run: saturation.Along) -> Values:
    """What C20 is asked of, from a run of algorithm 1 with saturation.

    Nothing holds of a run without saturation. If no saturated tick lies outside of the region of (28), nothing is known
    of what V_c does there, so the number of its rises there is NaN.
    """
    return dict(zip(CRITERIA, saturation.growth(run).values(), strict=True))


def described(run: saturation.Along) -> str:
    """The numbers of a run in a sentence."""
    saturated, region = run.saturated, run.region
    if not saturated.any():
        return "no actuator saturates, so (28) has nothing to say"
    first, last = np.flatnonzero(saturated)[[0, -1]]
    positive, rising = (float(np.mean(which[saturated])) for which in (run.bound > 0, run.rate > 0))
    gain = float(np.median(run.gamma[saturated])) * float(run.time[1] - run.time[0])
    return (
        f"{saturated.sum()} saturated ticks from {run.time[first]:.4f} to {run.time[last]:.4f} s, |Delta F_s| up to"
        f" {run.missing.max():.3g} N, h* = {run.h_star:.3g} /kg; the right side of (28) is positive at {positive:.0%}"
        f" of these ticks, and dV_c/dt at {rising:.0%}; dV_c/dt lies beyond (28) at {share_beyond(run):.1%} of them;"
        f" in all V_c rises beyond (28) by {run.excess():.1e} of V_c(0), which is {_excess_at_first(run):.2g} times V_c"
        f" at the first of these ticks; V_c over V_c(0) is {run.V[first] / run.V[0]:.1e} at the first of them, up to"
        f" {run.V[first : last + 1].max() / run.V[0]:.1e} until the last, {run.V[-1] / run.V[0]:.1e} at the end;"
        f" without F_c, (28) allows growth up to |e| = {region.e * 1e3:.3g} mm and |de| = {region.de:.3g} m/s, while"
        f" |e| <= {run.e[saturated].max() * 1e3:.2g} mm at saturated ticks; {_told_outside(run)}; gamma times the"
        f" period is {gain:.2g} in the median"
    )


def cause(here: saturation.Along, finer: saturation.Along) -> str:
    """What a run with a shorter period says about the ticks at which dV_c/dt lies beyond (28)."""
    if not here.saturated.any():
        return "So nothing is known of what a shorter period changes"
    if not share_beyond(here) > 0:
        return "dV_c/dt keeps (28) at all saturated ticks of fig6"
    if not finer.saturated.any():
        return "Without a saturated tick at the shorter period these runs do not show whether sampling is the cause"
    if share_beyond(finer) < share_beyond(here):
        return (
            "dV_c/dt lies beyond (28) at a smaller share of the saturated ticks with the shorter period. So the sampled"
            " F_c is at least a part of the cause: (28) is that of the law in continuous time"
        )
    return (
        "The shorter period brings dV_c/dt no nearer to (28), so these runs do not show that sampling is the cause,"
        " though (28) is that of the law in continuous time"
    )


def share_beyond(run: saturation.Along) -> float:
    """The share of the saturated ticks at which dV_c/dt lies beyond (28); NaN of a run without any."""
    return float(np.mean((run.rate > run.bound)[run.saturated])) if run.saturated.any() else float("nan")


def _excess_at_first(run: saturation.Along) -> float:
    """What `Along.excess` gives, over V_c at the first saturated tick instead of V_c at the start."""
    return run.excess() * float(run.V[0] / run.V[run.saturated.argmax()])


def _told_outside(run: saturation.Along) -> str:
    """How many saturated ticks lie outside of the region of (28), and what V_c does there."""
    if not _outside(run).any():
        return "with F_c none of them lies outside, so the run says nothing of what V_c does there"
    return f"with F_c {_outside(run).sum()} of them lie outside, and V_c rises at {_rises_outside(run).sum()} of these"


def _outside(run: saturation.Along) -> np.ndarray:
    """Saturated ticks outside of the region of (28), shape (n_ticks,)."""
    return run.saturated & run.outside


def _rises_outside(run: saturation.Along) -> np.ndarray:
    """Saturated ticks outside of the region of (28) at which V_c rises, shape (n_ticks,)."""
    return _outside(run) & (run.rate > 0)


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
        "asked of fig6; a run without a saturated tick outside of the region does not meet the second criterion",
    ),
)
