"""How far a setting is from breaking each sentence of Section V: the objective of the calibration.

The *excess* of a part of a sentence is zero at its limit, and negative while it holds:

- of a number with a limit, the logarithm of the number over its limit: -0.69 at half of the limit;
- of an error that is to be larger in one figure than in another, 1 - d / `EFFECT`, where d is the mean over the
  standard deviation of the logarithms of the seeds' ratios: with d = 0.5 some 69 % of the seeds show the larger error,
  and the 95 % interval of the median ratio of 30 seeds lies just above 1;
- of torques, how far the median over the seeds lies above its limit, in units of `TORQUE_UNIT`.

`cost` of a setting at which all sentences hold is the largest excess, so the smallest margin decides. Else it is the
sum of all positive excesses, so a search that begins elsewhere is led to where they hold.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from orchestration.paper.claims import criteria
from orchestration.paper.claims.criteria import Criterion
from orchestration.paper.measure import Summary
from orchestration.paper.numbers import TORQUE_SHARE
from orchestration.paper.studies.calibration.trial import FIGURES, Trial

EFFECT = 0.5
TORQUE_UNIT = 0.1
TINY = 1e-9  # of a limit: what lies below is as good as none

Excess = Mapping[str, float]
Value = Callable[[Summary], float]


def excesses(trial: Trial) -> Excess:
    """Excess of each part of the claims C4 to C10 and C16, by a name such as ``C4 settled, fig5``."""
    found = {f"{claim} larger {name}": 1 - _effect(np.log(r)) / EFFECT for claim, name, r in _ratios(trial)}
    return {**_limited(trial), **found}


def broken(trial: Trial) -> tuple[str, ...]:
    """Claims that do not hold in a trial; where an error is to be larger, the median of the ratios decides."""
    beyond = {name.split()[0] for name, value in _limited(trial).items() if not value <= 0}
    not_larger = {claim for claim, _, ratios in _ratios(trial) if not np.median(ratios) > 1}
    return tuple(sorted(beyond | not_larger, key=lambda claim: int(claim[1:])))


def visibly_worse(trial: Trial) -> bool:
    """Whether medians of both errors of Fig. 6 in contact are larger than those of Fig. 5 by 10 % or more."""
    return all(
        np.median(ratios) >= criteria.CLEARLY_LARGER.limit for claim, _, ratios in _ratios(trial) if claim == "C7"
    )


def cost(found: Excess) -> float:
    """The cost of a setting, from its excesses."""
    values = np.array(list(found.values()))
    beyond = float(np.clip(values, 0, None).sum())
    return beyond if beyond > 0 else float(values.max())


def _estimate(runs: Sequence[Summary]) -> Excess:
    """C4 to C6 of one figure."""
    fluctuation = float(np.median([s.m2_fluctuation for s in runs]))
    return {
        "C4 settled": _worst(runs, lambda s: s.m2_settled, criteria.M2_SETTLED),
        "C4 at contact": _worst(runs, lambda s: s.m2_at_contact, criteria.M2_AT_CONTACT),
        "C5 deviation": _worst(runs, lambda s: s.m2_in_contact, criteria.M2_IN_CONTACT),
        "C5 fluctuation": _log(criteria.M2_FLUCTUATION.limit, fluctuation),
        "C6 recovery": _worst(runs, lambda s: s.m2_recovery, criteria.M2_RECOVERY),
    }


def _limited(trial: Trial) -> Excess:
    """The parts that have a limit."""
    found: dict[str, float] = {}
    for figure in FIGURES:
        found |= {f"{name}, {figure}": value for name, value in _estimate(trial.runs[figure]).items()}
    variant = trial.runs["spong-ortega"]
    return {
        **found,
        **_bounded("C7", trial.runs["fig6"]),
        **_torque(trial),
        **_free_motion(trial),
        **_slightly(trial),
        **_bounded("C16", variant),
        "C16 m2_hat": _worst(variant, lambda s: s.m2_in_contact, criteria.M2_IN_CONTACT),
    }


def _ratios(trial: Trial) -> Iterator[tuple[str, str, np.ndarray]]:
    """Claim, kind of error, and its ratio to that of Fig. 5 at each seed, where an error is to be larger."""
    values: Mapping[str, Value] = {"tracking": lambda s: s.e_contact, "force": lambda s: s.force_error}
    for claim, figure in (("C7", "fig6"), ("C10", "fig7")):
        for name, value in values.items():
            pairs = zip(trial.runs[figure], trial.runs["fig5"], strict=True)
            yield claim, name, np.array([value(one) / value(other) for one, other in pairs])


def _effect(values: np.ndarray) -> float:
    """Mean over standard deviation; of a single value its sign."""
    mean = float(values.mean())
    return mean / max(float(values.std()), TINY) if len(values) > 1 else math.copysign(EFFECT, mean)


def _bounded(claim: str, runs: Sequence[Summary]) -> Excess:
    return {
        f"{claim} bounded": _worst(runs, lambda s: s.e_max, criteria.BOUNDED_ERROR),
        f"{claim} end": _worst(runs, lambda s: s.end, criteria.END),
    }


def _torque(trial: Trial) -> Excess:
    """C8."""
    one, two = (np.array([s.torque for s in trial.runs[figure]]) for figure in ("fig5", "fig7"))
    ratio = float(np.median(two / one, axis=0).max())
    within = float((np.median(two, axis=0) / trial.torque_limits).max())
    return {"C8 ratio": (ratio - TORQUE_SHARE) / TORQUE_UNIT, "C8 within": (within - 1) / TORQUE_UNIT}


def _free_motion(trial: Trial) -> Excess:
    """C9."""
    start = max(s.e_start for s in trial.runs["fig7"])
    return {
        "C9 start": _log(start, criteria.START_ERROR.limit),
        "C9 against a fixed mass": _log(start, criteria.FIXED_MASS_RATIO.limit * trial.fixed_mass.e_start),
        "C9 free": _worst(trial.runs["fig7"], lambda s: s.e_free, criteria.FREE_ERROR),
    }


def _slightly(trial: Trial) -> Excess:
    """That errors in contact are no more than slightly larger in Fig. 7 than in Fig. 5."""
    return {
        "C10 slightly larger tracking": _more(trial, lambda s: s.e_contact, criteria.SLIGHTLY_LARGER_ERROR),
        "C10 slightly larger force": _more(trial, lambda s: s.force_error, criteria.SLIGHTLY_LARGER_FORCE),
    }


def _more(trial: Trial, value: Value, criterion: Criterion) -> float:
    one, two = (float(np.median([value(s) for s in trial.runs[figure]])) for figure in ("fig5", "fig7"))
    return _log(two - one, criterion.limit)


def _worst(runs: Sequence[Summary], value: Value, criterion: Criterion) -> float:
    return _log(max(value(s) for s in runs), criterion.limit)


def _log(value: float, limit: float) -> float:
    """The logarithm of a value over its limit; a value that is not positive counts as `TINY` of the limit."""
    return math.log(max(value / limit, TINY))
