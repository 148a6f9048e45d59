"""Searches for the calibration: many settings with one seed, the best of them improved, and those put to the proof.

1. *Look*: settings that are known to be good, Sobol points around them and Sobol points anywhere, each with one seed.
2. *Improve*: differential evolution (Storn and Price 1997) from the best of these, over `SEEDS` seeds. A setting that
   breaks much with one seed is not tried with more.
3. *Prove*: the best settings that differ from one another, rounded, over 30 seeds and with all values changed by up to
   5 %. The one that keeps all sentences most often is the choice.

Every step is seeded, so the search gives the same setting everywhere.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from orchestration.errors import SimulationError
from orchestration.paper.calibrations import Setting
from orchestration.paper.measure import NoContactError
from orchestration.paper.studies.calibration.keeping import Proof, prove
from orchestration.paper.studies.calibration.objective import cost, excesses
from orchestration.paper.studies.calibration.space import rounded, setting_at, starts
from orchestration.paper.studies.calibration.trial import Bench
from orchestration.paper.studies.native_runs import Runner

FAILED = 1e3  # cost of a setting at which a run fails
SEEDS = tuple(range(1, 7))
SCREEN = 2.0  # cost with one seed from which more seeds are not worth their time
SCREENED = 1e2  # is added to such a cost
POPULATION, GENERATIONS = 24, 20
ANYWHERE, AROUND, WIDTH = 96, 24, 0.3
PROVED, APART = 4, 0.1  # settings that are put to the proof, and their least distance in the shares
RANDOM_SEED = 1991
Tell = Callable[[str], None]


@dataclass(frozen=True)
class Plan:
    """How much work a search is.

    Attributes
    ----------
    anywhere, around
        Number of settings that are looked at in the whole space, and around each setting that is known.
    population, generations
        Of the differential evolution.
    proved
        Number of settings that are put to the proof.
    """

    anywhere: int = ANYWHERE
    around: int = AROUND
    population: int = POPULATION
    generations: int = GENERATIONS
    proved: int = PROVED


@dataclass(frozen=True)
class Found:
    """What a search has found.

    Attributes
    ----------
    looked_at, tried
        Number of settings that were tried with one seed in the first step, and in the second.
    held_at_first
        Number of settings of the first step at which all sentences hold with one seed.
    proofs
        The settings that were put to the proof, the best first.
    """

    looked_at: int
    held_at_first: int
    tried: int
    proofs: tuple[Proof, ...]


def search(laboratory: Runner, known: Sequence[Setting], pool: Executor, tell: Tell, plan: Plan = Plan()) -> Found:
    """Search for a setting at which all sentences hold, with as much room as there is.

    Parameters
    ----------
    known
        Settings to start from.
    tell
        Called with a sentence after each step.
    """
    first = starts(known, plan.anywhere, plan.around, WIDTH)
    costs = np.array(list(pool.map(lambda shares: _cost(laboratory, shares, SEEDS[:1]), first)))
    held = int((costs <= 0).sum())
    tell(f"looked at {len(first)} settings with one seed: all sentences hold at {held}")
    population = first[np.argsort(costs, kind="stable")[: plan.population]]
    improved = _improve(laboratory, population, plan.generations, pool, tell)
    candidates = _apart(improved, plan.proved)
    proofs = sorted(
        (prove(laboratory, rounded(setting_at(shares)), pool) for shares in candidates),
        key=lambda proof: proof.kept,
        reverse=True,
    )
    tell(f"put {len(proofs)} settings to the proof: the best keeps all sentences in {proofs[0].kept:.0%}")
    return Found(len(first), held, len(improved), tuple(proofs))


def _improve(
    laboratory: Runner, population: np.ndarray, generations: int, pool: Executor, tell: Tell
) -> list[tuple[float, np.ndarray]]:
    """Cost and shares of every setting that differential evolution has tried."""
    from scipy.optimize import differential_evolution

    tried: list[tuple[float, np.ndarray]] = []

    def costs(points: np.ndarray) -> np.ndarray:
        found = np.array(list(pool.map(lambda shares: _screened(laboratory, shares), points.T)))
        tried.extend(zip(found.tolist(), points.T.copy(), strict=True))
        tell(f"tried {len(tried)} settings: least cost {min(cost for cost, _ in tried):.3f}")
        return found

    differential_evolution(
        costs,
        [(0.0, 1.0)] * population.shape[1],
        init=population,
        maxiter=generations,
        tol=0.0,
        atol=0.0,
        mutation=(0.4, 0.9),
        recombination=0.8,
        polish=False,
        vectorized=True,
        updating="deferred",
        rng=np.random.default_rng(RANDOM_SEED),
    )
    return tried


def _screened(laboratory: Runner, shares: np.ndarray) -> float:
    """The cost over all seeds; where one seed alone is bad, that cost and `SCREENED`."""
    alone = _cost(laboratory, shares, SEEDS[:1])
    return alone + SCREENED if alone > SCREEN else _cost(laboratory, shares, SEEDS)


def _cost(laboratory: Runner, shares: np.ndarray, seeds: Sequence[int]) -> float:
    try:
        return cost(excesses(Bench(laboratory, setting_at(shares)).trial(seeds)))
    except (SimulationError, NoContactError):
        return FAILED


def _apart(tried: Sequence[tuple[float, np.ndarray]], n: int) -> list[np.ndarray]:
    """The n best points that lie apart from one another."""
    chosen: list[np.ndarray] = []
    for _, shares in sorted(tried, key=lambda row: row[0]):
        if all(np.linalg.norm(shares - other) >= APART for other in chosen):
            chosen.append(shares)
        if len(chosen) == n:
            break
    return chosen
