"""Tunes the gains of algorithm 2, by SciPy's differential evolution and by Optuna.

The cost of a run is the largest ratio of a measured number to its limit among the claims C4, C5, C6 and C9. Below 1 all
of them hold.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from orchestration.campaigns.study import Study
from orchestration.paper.claims import criteria
from orchestration.paper.ready import scenario
from orchestration.paper.scenarios import UNSATURATED
from orchestration.paper.studies.summary_measure import summary_measure

GAINS: Mapping[str, tuple[float, float]] = {
    "controller.Psi": (20.0, 300.0),
    "controller.Gamma[2]": (0.5, 50.0),
    "controller.K_d": (10.0, 1000.0),
}
"""Ranges of the gains, in 1/s, kg.s2/m2 and N.s/m."""
LIMITS = {
    "m2_settled": criteria.M2_SETTLED,
    "m2_at_contact": criteria.M2_AT_CONTACT,
    "m2_in_contact": criteria.M2_IN_CONTACT,
    "m2_recovery": criteria.M2_RECOVERY,
    "e_start": criteria.START_ERROR,
    "e_free": criteria.FREE_ERROR,
}


@dataclass(frozen=True)
class Tuned:
    """What an optimizer has found.

    Attributes
    ----------
    gains
        The best gains, by name.
    cost
        Their cost.
    runs
        Number of runs that were made.
    """

    gains: Mapping[str, float]
    cost: float
    runs: int


def gains_study() -> Study:
    """The run of Fig. 7 without limits of torque, with what the cost needs.

    Examples
    --------
    >>> from orchestration.paper.studies.tuning import cost, gains_study
    >>> found = gains_study().evaluate({"controller.Psi": 100.0, "controller.Gamma[2]": 4.0, "controller.K_d": 100.0})
    >>> bool(cost(found) < 1)
    True
    """
    return Study(scenario("fig7").set(UNSATURATED), measure=summary_measure())


def cost(found: Any) -> Any:
    """The cost of a run, or of each row of a DataFrame; infinite where a run failed."""
    ratios = np.array([found[name] / criterion.limit for name, criterion in LIMITS.items()], dtype=float)
    return np.where(np.isnan(ratios).any(axis=0), np.inf, ratios.max(axis=0))[()]


def tuned_by_scipy(study: Study, generations: int = 20, seed: int = 0, workers: int | None = None) -> Tuned:
    """Tune the gains by `scipy.optimize.differential_evolution`; a generation is one call of `Study.evaluate`.

    Examples
    --------
    >>> from orchestration.paper.studies.tuning import gains_study, tuned_by_scipy
    >>> found = tuned_by_scipy(gains_study(), generations=1)
    >>> found.runs, bool(found.cost < 1)
    (90, True)
    """
    import pandas as pd
    from scipy.optimize import differential_evolution

    runs = 0

    def costs(logarithms: np.ndarray) -> np.ndarray:
        nonlocal runs
        runs += logarithms.shape[1]
        points = pd.DataFrame(10.0**logarithms.T, columns=list(GAINS))
        return cost(study.evaluate(points, workers=workers))

    found = differential_evolution(
        costs,
        np.log10(list(GAINS.values())),
        maxiter=generations,
        vectorized=True,
        updating="deferred",
        polish=False,
        rng=np.random.default_rng(seed),
    )
    gains = dict(zip(GAINS, (10.0**found.x).tolist(), strict=True))
    return Tuned(gains, float(found.fun), runs)


def tuned_by_optuna(study: Study, trials: int = 100, seed: int = 0) -> Tuned:
    """Tune the gains by Optuna, which asks for gains and is told their cost.

    Examples
    --------
    >>> from orchestration.paper.studies.tuning import gains_study, tuned_by_optuna
    >>> found = tuned_by_optuna(gains_study(), trials=20)
    >>> found.runs, bool(found.cost < 1)
    (20, True)
    """
    import optuna

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    search = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=seed))
    for _ in range(trials):
        trial = search.ask()
        gains = {name: trial.suggest_float(name, *ends, log=True) for name, ends in GAINS.items()}
        search.tell(trial, float(cost(study.evaluate(gains))))
    return Tuned(dict(search.best_params), float(search.best_value), trials)
