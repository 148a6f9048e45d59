"""Measures the claims about adaptive control, Figs. 5 to 7, over 30 noise seeds: C4 to C10 and C16."""

import numpy as np

from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims import judged
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.claims.judged import FIGURES, spread
from orchestration.paper.effect import shown
from orchestration.paper.evidence import Evidence
from orchestration.paper.laboratory import SEEDS
from orchestration.paper.measure import SETTLED, contact

SEEDS_TEXT = f"seeds {SEEDS[0]}-{SEEDS[-1]}"
ALL_SEEDS = "all seeds"
MANIFOLD = 2.0  # ratio of errors from which it is told as a multiple


def _approaches(evidence: Evidence) -> Finding:
    settled = {name: spread(evidence.noise[name], lambda s: s.m2_settled)[1] for name in FIGURES}
    error = {name: spread(evidence.noise[name], lambda s: s.m2_at_contact)[1] for name in FIGURES}
    text = "; ".join(
        f"{name} within {100 * SETTLED:g} % from {settled[name]:.2f} s, {error[name]:.1%} off at contact"
        for name in FIGURES
    )
    return Finding(judged.approach(evidence.noise), text)


def _deviates_little(evidence: Evidence) -> Finding:
    spreads = {name: spread(evidence.noise[name], lambda s: s.m2_in_contact) for name in FIGURES}
    text = "; ".join(f"{name} {median:.1%}, worst {worst:.1%}" for name, (median, worst) in spreads.items())
    medians = {name: spread(evidence.noise[name], lambda s: s.m2_fluctuation)[0] for name in FIGURES}
    fluctuation = ", ".join(f"{name} {value:.3f} kg" for name, value in medians.items())
    return Finding(
        {**judged.deviation(evidence.noise), **judged.fluctuation(evidence.noise)},
        f"deviation, median: {text}; fluctuation, from the smallest to the largest value in contact: {fluctuation};"
        f" with seed 1: {_drifts(evidence)}",
    )


def _drifts(evidence: Evidence) -> str:
    """How much of the range of m2_hat in contact is a drift with the first seed, by figure."""
    parts = []
    for name in FIGURES:
        result = evidence.results[name]
        estimate = evidence.case.shape.estimate
        touch, ticks = contact(result), result.tick_times(estimate)
        during = (ticks >= touch.first) & (ticks <= touch.last)
        parts.append(f"{name} {drift(*ranges(ticks[during], result.at_ticks(estimate)[during]))}")
    return ", ".join(parts)


def drift(whole: float, rest: float) -> str:
    """What a range, kg, and that without the straight line that fits best say: whether it is mostly a drift."""
    told = "mostly a drift" if rest < whole / 2 else "not mostly a drift"
    return f"{whole:.3f} kg, and {rest:.3f} kg without the straight line that fits best ({told})"


def ranges(times: np.ndarray, values: np.ndarray) -> tuple[float, float]:
    """The range of values, and what remains of it without the straight line that fits them best; shapes (n,)."""
    line = np.polynomial.Polynomial.fit(times, values, 1)
    return float(np.ptp(values)), float(np.ptp(values - line(times)))


def _recovers(evidence: Evidence) -> Finding:
    spreads = {name: spread(evidence.noise[name], lambda s: s.m2_recovery) for name in FIGURES}
    text = "; ".join(
        f"{name} {median * 1e3:.3g} ms, worst {worst * 1e3:.3g} ms" for name, (median, worst) in spreads.items()
    )
    return Finding(judged.recovery(evidence.noise), f"median: {text}")


def _saturation(evidence: Evidence) -> Finding:
    worst = spread(evidence.noise["fig6"], lambda s: s.e_max)[1]
    result = evidence.results["fig6"]
    share = max(result[column].mean() for column in evidence.case.by_joint("actuator.saturated"))
    return Finding(
        judged.saturation(evidence.noise),
        f"{_larger(evidence, 'fig6')}; bounded: |e| <= {worst * 1e3:.2g} mm in all runs. The limit is reached during"
        f" {share:.2%} of the run",
    )


def _larger(evidence: Evidence, name: str) -> str:
    """How much larger the errors of a figure in contact are than those of Fig. 5, in words."""
    units = (("|e| in contact", "mm", 1e3, lambda s: s.e_contact), ("force error", "N", 1.0, lambda s: s.force_error))
    parts = []
    for effect, (quantity, unit, scale, value) in zip(judged.contact_effects(evidence.noise, name), units, strict=True):
        before, after = (scale * spread(evidence.noise[n], value)[0] for n in ("fig5", name))
        parts.append(
            f"{quantity} {before:.3g} {unit} in fig5 and {after:.3g} {unit} in {name} (medians), ratio"
            f" {shown(effect.median)} ({shown(effect.low)} to {shown(effect.high)}), larger at {effect.larger.yes} of"
            f" {effect.larger.n} seeds: {by_how_much(effect.median)}"
        )
    return "; ".join(parts)


def by_how_much(ratio: float) -> str:
    """How much larger or smaller the median ratio of an error says that the error is, in words."""
    if ratio == 1:
        return "in the median neither larger nor smaller"
    if ratio < 1:
        return f"in the median not larger, but smaller by {100 * (1 - ratio):.1f} %"
    size = f"{ratio:.2g} times as large" if ratio >= MANIFOLD else f"larger by {100 * (ratio - 1):.1f} %"
    clear = "clearly" if ratio >= limits.CLEARLY_LARGER.limit else "not clearly"
    return f"in the median {size}, {clear} larger"


def _less_torque(evidence: Evidence) -> Finding:
    one = np.array([s.torque for s in evidence.noise["fig5"]])
    two = np.array([s.torque for s in evidence.noise["fig7"]])
    ratio = two / one
    allowed = np.array(evidence.case.torque_limits)
    margin = 1 - two.max(axis=0) / allowed
    joints = []
    for i in range(len(allowed)):
        typical = 1 - np.median(two[:, i]) / allowed[i]
        joints.append(
            f"joint {i + 1}: ratio {np.median(ratio[:, i]):.2f}, worst {ratio[:, i].max():.2f}, margin to the"
            f" limit {typical:+.1%}, worst {margin[i]:+.1%}, beyond it in {(two[:, i] > allowed[i]).sum()} of"
            f" {len(two)} seeds"
        )
    return Finding(
        judged.torque(evidence.noise, allowed),
        f"algorithm 2 over algorithm 1, {'; '.join(joints)}",
    )


def _small_in_free_motion(evidence: Evidence) -> Finding:
    start, free = (spread(evidence.noise["fig7"], f)[1] for f in (lambda s: s.e_start, lambda s: s.e_free))
    fixed = evidence.start_without_adaptation()
    return Finding(
        {**judged.free_motion(evidence.noise), limits.FIXED_MASS_RATIO: start / fixed},
        f"|e| <= {start * 1e3:.2g} mm while m2_hat adapts, against {fixed * 1e3:.2g} mm without adaptation;"
        f" <= {free * 1e3:.2g} mm from half of the free motion on",
    )


def _slightly_larger(evidence: Evidence) -> Finding:
    medians = [spread(evidence.noise[name], lambda s: s.e_contact)[0] for name in ("fig5", "fig7")]
    return Finding(judged.contact_errors(evidence.noise), f"{_larger(evidence, 'fig7')}{slight_in_length(*medians)}")


def slight_in_length(before: float, after: float) -> str:
    """That median errors, m, have a large ratio where they have one, as a sentence after another."""
    if after < MANIFOLD * before:
        return ""
    return f". The median |e| in contact is {after / before:.2g} times that of fig5, which the allowance does not count"


def _fixed_inverse(evidence: Evidence) -> Finding:
    runs = evidence.noise["spong-ortega"]
    e = spread(runs, lambda s: s.e_max)[1]
    m2 = spread(runs, lambda s: s.m2_in_contact)[1]
    end = spread(runs, lambda s: s.end)[1]
    return Finding(
        judged.fixed_inverse(evidence.noise),
        f"all {len(runs)} runs: |e| <= {e * 1e3:.2g} mm, m2_hat off by at most {m2:.1%} in contact, end"
        f" {end * 1e3:.2g} mm from {evidence.case.place}",
    )


QUESTIONS = (
    Question(
        "C4",
        "m2_hat quickly approaches 1 kg during the first free motion",
        "V, Figs. 5-7",
        (limits.M2_SETTLED, limits.M2_AT_CONTACT),
        _approaches,
        f"fig5, fig6, fig7, {SEEDS_TEXT}",
        ALL_SEEDS,
    ),
    Question(
        "C5",
        "During contact m2_hat fluctuates, and deviates less than 20 %",
        "V, Figs. 5-7",
        (limits.M2_IN_CONTACT, limits.M2_FLUCTUATION),
        _deviates_little,
        f"fig5, fig6, fig7, {SEEDS_TEXT}",
        "the deviation for all seeds",
    ),
    Question(
        "C6",
        "m2_hat recovers as soon as the tip leaves the wall at b",
        "V, Figs. 5-7",
        (limits.M2_RECOVERY,),
        _recovers,
        f"fig5, fig6, fig7, {SEEDS_TEXT}",
        ALL_SEEDS,
    ),
    Question(
        "C7",
        "Saturation at 75 %: larger tracking and force errors, performance acceptable, errors bounded",
        "V, Fig. 6, (28)",
        (limits.SATURATED_ERROR, limits.SATURATED_FORCE, limits.BOUNDED_ERROR, limits.END),
        _saturation,
        f"fig5, fig6, {SEEDS_TEXT}",
        "the latter two for all seeds",
    ),
    Question(
        "C8",
        "Algorithm 2 needs considerably less torque; 75 % of algorithm 1's maximum never saturates it",
        "V, Fig. 7",
        (limits.TORQUE_RATIO, limits.TORQUE_WITHIN),
        _less_torque,
        f"fig5, fig7, {SEEDS_TEXT}",
        "the paper shows one noise, so these are medians over the seeds; exceptions are counted",
    ),
    Question(
        "C9",
        "Algorithm 2: tracking error very small in free motion",
        "V, Fig. 7",
        (limits.START_ERROR, limits.FIXED_MASS_RATIO, limits.FREE_ERROR),
        _small_in_free_motion,
        f"fig7, {SEEDS_TEXT}",
        ALL_SEEDS,
    ),
    Question(
        "C10",
        "Algorithm 2: tracking and force errors in contact slightly larger than algorithm 1 unsaturated",
        "V, Fig. 7",
        (
            limits.LARGER_ERROR,
            limits.SLIGHTLY_LARGER_ERROR,
            limits.LARGER_FORCE,
            limits.SLIGHTLY_LARGER_FORCE,
        ),
        _slightly_larger,
        f"fig5, fig7, {SEEDS_TEXT}",
        '"slightly" is an absolute allowance, in mm and N, and not a ratio',
    ),
    Question(
        "C16",
        "The variant with a fixed inverse does the same task",
        "III-C, remark 2",
        (limits.BOUNDED_ERROR, limits.M2_IN_CONTACT, limits.END),
        _fixed_inverse,
        f"spong-ortega, {SEEDS_TEXT}",
        ALL_SEEDS,
    ),
)
