"""Claims about the adaptive runs of Figs. 5 to 7, over 30 seeds: C4 to C10 and C16."""

from collections.abc import Callable

import numpy as np

from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.evidence import Evidence
from orchestration.paper.measure import Summary
from orchestration.paper.numbers import TORQUE_LIMITS, TORQUE_SHARE

FIGURES = ("fig5", "fig6", "fig7")
SEEDS_TEXT = "seeds 1-30"


def spread(summaries: list[Summary], value: Callable[[Summary], float]) -> tuple[float, float]:
    """Median and largest value."""
    values = [value(summary) for summary in summaries]
    return float(np.median(values)), float(max(values))


def _approaches(evidence: Evidence) -> Finding:
    parts, met = [], True
    for name in FIGURES:
        _, settled = spread(evidence.noise[name], lambda s: s.m2_settled)
        _, error = spread(evidence.noise[name], lambda s: s.m2_at_contact)
        met &= settled <= 0.46 and error <= 0.05
        parts.append(f"{name} within 10 % from {settled:.2f} s, {error:.1%} off at contact")
    return Finding(met, "; ".join(parts))


def _deviates_little(evidence: Evidence) -> Finding:
    spreads = {name: spread(evidence.noise[name], lambda s: s.m2_in_contact) for name in FIGURES}
    text = "; ".join(f"{name} {median:.1%}, worst {worst:.1%}" for name, (median, worst) in spreads.items())
    return Finding(all(worst < 0.2 for _, worst in spreads.values()), f"median: {text}")


def _recovers(evidence: Evidence) -> Finding:
    spreads = {name: spread(evidence.noise[name], lambda s: s.m2_recovery) for name in FIGURES}
    text = "; ".join(
        f"{name} {median * 1e3:.3g} ms, worst {worst * 1e3:.3g} ms" for name, (median, worst) in spreads.items()
    )
    return Finding(all(worst <= 0.1 for _, worst in spreads.values()), f"median: {text}")


def _saturation(evidence: Evidence) -> Finding:
    free, saturated = evidence.noise["fig5"], evidence.noise["fig6"]
    e5, e6 = (spread(s, lambda x: x.e_contact)[0] for s in (free, saturated))
    f5, f6 = (spread(s, lambda x: x.force_error)[0] for s in (free, saturated))
    worst = spread(saturated, lambda s: s.e_max)[1]
    end = spread(saturated, lambda s: s.end)[1]
    result = evidence.results["fig6"]
    share = max(result[f"actuator.saturated[{i}]"].mean() for i in (1, 2))
    acceptable = worst <= 5e-3 and end <= 1e-3
    return Finding(
        bool(acceptable and e6 > e5 and f6 > f5),
        f"medians, without and with saturation: |e| in contact {e5 * 1e3:.2g} and {e6 * 1e3:.2g} mm, force"
        f" error {f5:.3g} and {f6:.3g} N; bounded: |e| <= {worst * 1e3:.2g} mm in all runs. The limit is"
        f" reached during {share:.2%} of the run, in peaks of the sliding term F_c of a few samples: cutting"
        " them does not enlarge the errors",
    )


def _less_torque(evidence: Evidence) -> Finding:
    one = np.array([s.torque for s in evidence.noise["fig5"]])
    two = np.array([s.torque for s in evidence.noise["fig7"]])
    ratio = two / one
    limits = np.array(TORQUE_LIMITS)
    margin = 1 - two.max(axis=0) / limits
    joints = []
    for i in (0, 1):
        typical = 1 - np.median(two[:, i]) / limits[i]
        joints.append(
            f"joint {i + 1}: ratio {np.median(ratio[:, i]):.2f}, worst {ratio[:, i].max():.2f}, margin to the"
            f" limit {typical:+.1%}, worst {margin[i]:+.1%}, beyond it in {(two[:, i] > limits[i]).sum()} of"
            f" {len(two)} seeds"
        )
    considerably = (np.median(ratio, axis=0) <= TORQUE_SHARE).all()
    below = (np.median(two, axis=0) <= limits).all()
    return Finding(bool(considerably and below), f"algorithm 2 over algorithm 1, {'; '.join(joints)}")


def _small_in_free_motion(evidence: Evidence) -> Finding:
    start, free = (spread(evidence.noise["fig7"], f)[1] for f in (lambda s: s.e_start, lambda s: s.e_free))
    return Finding(
        start <= 5e-3 and free <= 1e-4,
        f"|e| <= {start * 1e3:.2g} mm while m2_hat adapts, <= {free * 1e3:.2g} mm from half of the free motion on",
    )


def _slightly_larger(evidence: Evidence) -> Finding:
    one, two = evidence.noise["fig5"], evidence.noise["fig7"]
    e1, e2 = (spread(s, lambda x: x.e_contact)[0] for s in (one, two))
    f1, f2 = (spread(s, lambda x: x.force_error)[0] for s in (one, two))
    met = e1 < e2 <= e1 + 5e-4 and f1 < f2 <= f1 + 30
    return Finding(
        met,
        f"medians of algorithms 1 and 2: |e| in contact {e1 * 1e3:.2g} and {e2 * 1e3:.2g} mm, force error"
        f" {f1:.3g} and {f2:.3g} N",
    )


def _fixed_inverse(evidence: Evidence) -> Finding:
    runs = evidence.noise["spong-ortega"]
    e = spread(runs, lambda s: s.e_max)[1]
    m2 = spread(runs, lambda s: s.m2_in_contact)[1]
    end = spread(runs, lambda s: s.end)[1]
    return Finding(
        e <= 5e-3 and m2 < 0.2 and end <= 1e-3,
        f"all {len(runs)} runs: |e| <= {e * 1e3:.2g} mm, m2_hat off by at most {m2:.1%} in contact, end"
        f" {end * 1e3:.2g} mm from (1.5, 0)",
    )


QUESTIONS = (
    Question(
        "C4",
        "m2_hat quickly approaches 1 kg during the first free motion",
        "V, Figs. 5-7",
        "within 10 % (from 150 %) in the first half of the free motion (0.46 s), within 5 % at contact",
        _approaches,
        f"fig5, fig6, fig7, {SEEDS_TEXT}",
    ),
    Question(
        "C5",
        "During contact m2_hat deviates less than 20 %",
        "V, Figs. 5-7",
        "|m2_hat - 1 kg| < 0.2 kg from first to last contact, all seeds",
        _deviates_little,
        f"fig5, fig6, fig7, {SEEDS_TEXT}",
    ),
    Question(
        "C6",
        "m2_hat recovers as soon as the tip leaves the wall at b",
        "V, Figs. 5-7",
        "within 5 % for good at most 0.1 s after the last contact, all seeds",
        _recovers,
        f"fig5, fig6, fig7, {SEEDS_TEXT}",
    ),
    Question(
        "C7",
        "Saturation at 75 %: larger tracking and force errors, performance acceptable, errors bounded",
        "V, Fig. 6, (28)",
        "median |e| in contact and median force error larger than unsaturated; |e| <= 5 mm, ends within 1 mm",
        _saturation,
        f"fig5, fig6, {SEEDS_TEXT}",
    ),
    Question(
        "C8",
        "Algorithm 2 needs considerably less torque; 75 % of algorithm 1's maximum never saturates it",
        "V, Fig. 7",
        "medians over the seeds, per joint: ratio of the largest torques <= 0.75, and the largest command"
        " below Fig. 6's limit (the paper shows one noise; exceptions are counted)",
        _less_torque,
        f"fig5, fig7, {SEEDS_TEXT}",
    ),
    Question(
        "C9",
        "Algorithm 2: tracking error very small in free motion",
        "V, Fig. 7",
        "|e| <= 5 mm during the first free motion and <= 0.1 mm in its second half, all seeds",
        _small_in_free_motion,
        f"fig7, {SEEDS_TEXT}",
    ),
    Question(
        "C10",
        "Algorithm 2: tracking and force errors in contact slightly larger than algorithm 1 unsaturated",
        "V, Fig. 7",
        "medians larger, by at most 0.5 mm (5 % of the depth) and 30 N (5 % of the peak)",
        _slightly_larger,
        f"fig5, fig7, {SEEDS_TEXT}",
    ),
    Question(
        "C16",
        "The variant with a fixed inverse does the same task",
        "III-C, remark 2",
        "|e| <= 5 mm, m2_hat within 20 % in contact, ends within 1 mm of (1.5, 0), all seeds",
        _fixed_inverse,
        f"spong-ortega, {SEEDS_TEXT}",
    ),
)
