"""What the criteria of the claims C4 to C10, C13 and C16 are asked of, computed from summaries of runs.

Each function maps summaries over the seeds, by scenario, to the measured values by criterion. Verdicts at the chosen
values (`orchestration.paper.claims.adaptive`) and in the space of the open values (`orchestration.paper.studies`)
come from the same functions.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.criteria import Criterion
from orchestration.paper.effect import paired_effect
from orchestration.paper.measure import Summary, at_ticks, contact
from orchestration.paper.strength import Effect
from orchestration.paper.task_shape import lengths
from orchestration.results.result import Result

FIGURES = ("fig5", "fig6", "fig7")
Noise = Mapping[str, Sequence[Summary]]
Values = Mapping[Criterion, float | Sequence[float] | np.ndarray]


def spread(summaries: Sequence[Summary], value: Callable[[Summary], float]) -> tuple[float, float]:
    """Median and largest of a value over runs; both are NaN if one of the values is."""
    values = [value(summary) for summary in summaries]
    return float(np.median(values)), float(np.max(values))


def met(values: Values) -> bool:
    """Whether all criteria are met."""
    return all([criterion.met(measured) for criterion, measured in values.items()])


def approach(noise: Noise) -> Values:
    """C4: when m2_hat settles before the contact in Figs. 5 to 7, and how far off it is at the contact."""
    return {
        limits.M2_SETTLED: [spread(noise[name], lambda s: s.m2_settled)[1] for name in FIGURES],
        limits.M2_AT_CONTACT: [spread(noise[name], lambda s: s.m2_at_contact)[1] for name in FIGURES],
    }


def deviation(noise: Noise) -> Values:
    """C5: the deviation of m2_hat in contact in Figs. 5 to 7."""
    return {limits.M2_IN_CONTACT: [spread(noise[name], lambda s: s.m2_in_contact)[1] for name in FIGURES]}


def recovery(noise: Noise) -> Values:
    """C6: the time in which m2_hat recovers after the contact in Figs. 5 to 7."""
    return {limits.M2_RECOVERY: [spread(noise[name], lambda s: s.m2_recovery)[1] for name in FIGURES]}


def fluctuation(noise: Noise) -> Values:
    """C5: the median range of m2_hat in contact in Figs. 5 to 7."""
    return {limits.M2_FLUCTUATION: [spread(noise[name], lambda s: s.m2_fluctuation)[0] for name in FIGURES]}


def contact_effects(noise: Noise, name: str, than: str = "fig5") -> tuple[Effect, Effect]:
    """By which ratio |e| in contact, and the error of the force, are larger in one figure than in another."""
    runs, others = noise[name], noise[than]
    return (
        paired_effect([s.e_contact for s in runs], [s.e_contact for s in others]),
        paired_effect([s.force_error for s in runs], [s.force_error for s in others]),
    )


def lower_end(effect: Effect) -> float:
    """The ratio that must exceed 1: the lower end of the interval, or the median of too few pairs for an interval."""
    return effect.low if np.isfinite(effect.low) else effect.median


def saturation(noise: Noise) -> Values:
    """C7: errors of Fig. 6 against those of Fig. 5, and their bounds."""
    e, force = contact_effects(noise, "fig6")
    return {
        limits.SATURATED_ERROR: lower_end(e),
        limits.SATURATED_FORCE: lower_end(force),
        limits.BOUNDED_ERROR: spread(noise["fig6"], lambda s: s.e_max)[1],
        limits.END: spread(noise["fig6"], lambda s: s.end)[1],
    }


def torque(noise: Noise, allowed: np.ndarray) -> Values:
    """C8: torques of Fig. 7 against those of Fig. 5 and the limits of Fig. 6, N.m, shape (n,)."""
    one = np.array([s.torque for s in noise["fig5"]])
    two = np.array([s.torque for s in noise["fig7"]])
    return {
        limits.TORQUE_RATIO: np.median(two / one, axis=0),
        limits.TORQUE_WITHIN: np.median(two, axis=0) - allowed,
    }


def free_motion(noise: Noise) -> Values:
    """C9: errors of Fig. 7 before the contact."""
    return {
        limits.START_ERROR: spread(noise["fig7"], lambda s: s.e_start)[1],
        limits.FREE_ERROR: spread(noise["fig7"], lambda s: s.e_free)[1],
    }


def contact_errors(noise: Noise) -> Values:
    """C10: errors of Fig. 7 in contact against those of Fig. 5."""
    one, two = noise["fig5"], noise["fig7"]
    e1, e2 = (spread(s, lambda x: x.e_contact)[0] for s in (one, two))
    f1, f2 = (spread(s, lambda x: x.force_error)[0] for s in (one, two))
    e, force = contact_effects(noise, "fig7")
    return {
        limits.LARGER_ERROR: lower_end(e),
        limits.SLIGHTLY_LARGER_ERROR: e2 - e1,
        limits.LARGER_FORCE: lower_end(force),
        limits.SLIGHTLY_LARGER_FORCE: f2 - f1,
    }


def fixed_inverse(noise: Noise) -> Values:
    """C16: the errors of the variant with a fixed inverse."""
    runs = noise["spong-ortega"]
    return {
        limits.BOUNDED_ERROR: spread(runs, lambda s: s.e_max)[1],
        limits.M2_IN_CONTACT: spread(runs, lambda s: s.m2_in_contact)[1],
        limits.END: spread(runs, lambda s: s.end)[1],
    }


def reference_distance(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Instants of the controller's ticks, s, and |x_t - x_v| there, m; both of shape (n_ticks,)."""
    distance = lengths(at_ticks(result, "controller.x_t") - at_ticks(result, "trajectory.x_v"))
    return result.tick_times("controller.x_t[1]"), distance


def reference_in_contact(result: Result) -> Mapping[Criterion, float]:
    """C13: |x_t - x_v| before the contact and when the contact ends, of a run of Fig. 5."""
    times, distance = reference_distance(result)
    touch = contact(result)
    return {
        limits.TIRT_BEFORE_CONTACT: float(distance[times < touch.first].max()),
        limits.TIRT_AT_END: float(distance[times >= touch.last][0]),
    }
