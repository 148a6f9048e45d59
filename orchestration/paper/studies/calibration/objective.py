"""How far a setting is from breaking each sentence of Section V: the objective of the calibration.

The *excess* of a sentence is zero at its limit, negative while it holds, and one for about one unit of trouble:

- of a number with a limit, the logarithm of the number over its limit: -0.69 at half of the limit;
- of an error that is to be larger in one figure than in another: the lower quartile over the seeds of the ratio of both
  must lie above 1, and `RATIO_UNIT` more is one unit;
- of torques: the median over the seeds must lie below 75 %, and `TORQUE_UNIT` less is one unit.

`cost` of a setting at which all sentences hold is the largest excess, so the smallest margin decides. Else it is the
sum of all positive excesses, so a search that begins elsewhere is led to where they hold.
"""

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from orchestration.paper.claims import criteria
from orchestration.paper.claims.criteria import Criterion
from orchestration.paper.measure import Summary
from orchestration.paper.numbers import TORQUE_SHARE
from orchestration.paper.studies.calibration.trial import FIGURES, Trial

RATIO_UNIT = 0.05
TORQUE_UNIT = 0.1
LEAST_FLUCTUATION = 0.05  # kg, C5: 2 % of the 2.5 kg that panel (b) of the figures must show
OF_FIXED_MASS = 0.5  # C9: of the error of the same law without adaptation
TINY = 1e-9
QUARTILE = 0.25

Excess = Mapping[str, float]
Value = Callable[[Summary], float]


def excesses(trial: Trial, quantile: float = QUARTILE) -> Excess:
    """Excess of each part of the claims C4 to C10 and C16, by a name such as ``C4 settled, fig5``.

    Parameters
    ----------
    quantile
        Of the ratios over the seeds that must lie above 1 where an error is to be larger.
    """
    found: dict[str, float] = {}
    for figure in FIGURES:
        found |= {f"{name}, {figure}": value for name, value in _estimate(trial.runs[figure]).items()}
    return {
        **found,
        **_larger("C7", trial, "fig6", quantile),
        **_bounded("C7", trial.runs["fig6"]),
        **_torque(trial),
        **_free_motion(trial),
        **_larger("C10", trial, "fig7", quantile),
        **_slightly(trial),
        **_bounded("C16", trial.runs["spong-ortega"]),
        "C16 m2_hat": _worst(trial.runs["spong-ortega"], lambda s: s.m2_in_contact, criteria.M2_IN_CONTACT),
    }


def broken(trial: Trial) -> tuple[str, ...]:
    """Claims that do not hold in a trial; where an error is to be larger, the median of the ratios decides."""
    return tuple(dict.fromkeys(name.split()[0] for name, value in excesses(trial, 0.5).items() if not value <= 0))


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
        "C5 fluctuation": _log(LEAST_FLUCTUATION, fluctuation),
        "C6 recovery": _worst(runs, lambda s: s.m2_recovery, criteria.M2_RECOVERY),
    }


def _larger(claim: str, trial: Trial, figure: str, quantile: float) -> Excess:
    """That errors in contact are larger in a figure than in Fig. 5."""
    values: Mapping[str, Value] = {"tracking": lambda s: s.e_contact, "force": lambda s: s.force_error}
    found = {}
    for name, value in values.items():
        ratios = [value(a) / value(b) for a, b in zip(trial.runs[figure], trial.runs["fig5"], strict=True)]
        found[f"{claim} larger {name}"] = (1 - float(np.quantile(ratios, quantile))) / RATIO_UNIT
    return found


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
        "C9 against a fixed mass": _log(start, OF_FIXED_MASS * trial.fixed_mass.e_start),
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
