"""Searches for the calibration: many settings with one seed, the best of them improved, and those put to the proof.

1. *Look*: settings that are known to be good, Sobol points around them and Sobol points anywhere, each with one seed.
   The known ones and the best of the others are tried over `SEEDS` seeds.
2. *Improve*: an evolution strategy from the best of these on, over the same seeds. A setting that
   breaks much with one seed is not tried with more.
3. *Prove*: the best settings that differ from one another, rounded, over 30 seeds and with all values changed by up to
   5 %. So are the known ones, as they are. The one that keeps all sentences most often is the first.

Every step is seeded, so the search gives the same setting everywhere.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from orchestration.errors import SimulationError
from orchestration.paper.calibrations import Setting
from orchestration.paper.laboratory import Runner
from orchestration.paper.measure import NoContactError
from orchestration.paper.studies.calibration.evolution import minimize
from orchestration.paper.studies.calibration.keeping import Proof, prove
from orchestration.paper.studies.calibration.objective import broken, cost, excesses, visibly_worse
from orchestration.paper.studies.calibration.space import rounded, setting_at, starts
from orchestration.paper.studies.calibration.trial import Bench

FAILED = 1e3  # cost of a setting at which a run fails
SEEDS = tuple(range(1, 17))
SCREEN = 2.0  # cost with one seed from which more seeds are not worth their time
SCREENED = 1e2  # is added to such a cost
OFFSPRING, GENERATIONS, SPREAD = 10, 16, 0.1
ANYWHERE, AROUND, WIDTH = 16, 16, 0.3
STARTS = 6  # settings of the first step, and the known ones, are tried over all seeds: one seed ranks them by chance
PROVED, APART = 3, 0.1  # settings that are put to the proof, and their least distance in the shares
RANDOM_SEED = 1991
REPEATED = 3
Tell = Callable[[str], None]


@dataclass(frozen=True)
class Plan:
    """How much work a search is.

    Attributes
    ----------
    anywhere, around
        Number of settings that are looked at in the whole space, and around each setting that is known.
    offspring, generations
        Settings in a generation, and number of generations.
    proved
        Number of settings that are put to the proof.
    """

    anywhere: int = ANYWHERE
    around: int = AROUND
    offspring: int = OFFSPRING
    generations: int = GENERATIONS
    proved: int = PROVED


USUAL = Plan()
"""The search that docs/calibration.md shows."""


@dataclass(frozen=True)
class Tried:
    """A setting that was tried.

    Attributes
    ----------
    shares
        Where it lies in the ranges of the searched values, shape (n_searched,).
    cost
        Its cost.
    cheaper
        Whether C8 holds.
    visibly_worse
        Whether the errors of Fig. 6 are larger than those of Fig. 5 by 10 % or more.
    """

    shares: np.ndarray
    cost: float
    cheaper: bool = False
    visibly_worse: bool = False


@dataclass(frozen=True)
class Found:
    """What a search has found.

    Attributes
    ----------
    looked_at
        Number of settings that were tried with one seed in the first step.
    first_costs
        Costs of the first `REPEATED` of them, so that a small part of the search can be repeated.
    held_at_first
        Number of those at which all sentences hold with one seed.
    tried
        Number of settings that were tried over all seeds of the second step.
    held
        Number of those at which all sentences hold.
    cheaper, visibly_worse, both, all_visibly
        Number of those at which C8 holds, at which Fig. 6 is visibly worse, at which both is so, and at which Fig. 6 is
        visibly worse while all sentences hold.
    proofs
        The settings that were put to the proof, the best first.
    """

    looked_at: int
    first_costs: tuple[float, ...]
    held_at_first: int
    tried: int
    held: int
    cheaper: int
    visibly_worse: int
    both: int
    all_visibly: int
    proofs: tuple[Proof, ...]


def search(laboratory: Runner, known: Sequence[Setting], pool: Executor, tell: Tell, plan: Plan = USUAL) -> Found:
    """Search for a setting at which all sentences hold, with as much room as there is.

    Parameters
    ----------
    known
        Settings to start from.
    tell
        Called with a sentence after each step.
    """
    first = starts(known, plan.anywhere, plan.around, WIDTH)
    looked = list(pool.map(lambda shares: tried_at(laboratory, shares, SEEDS[:1]), first))
    held_at_first = sum(one.cost <= 0 for one in looked)
    tell(f"looked at {len(first)} settings with one seed: all sentences hold at {held_at_first}")
    first_costs = tuple(one.cost for one in looked[:REPEATED])
    best = looked[: len(known)] + sorted(looked[len(known) :], key=lambda one: one.cost)[:STARTS]
    begun = list(pool.map(lambda one: tried_at(laboratory, one.shares, SEEDS), best))
    start = min(begun, key=lambda one: one.cost)
    tell(f"tried {len(begun)} of them over {len(SEEDS)} seeds: least cost {start.cost:.3f}")
    tried = begun + [one for one in _improve(laboratory, start.shares, plan, pool, tell) if one.cost < SCREENED]
    proofs = _proofs(laboratory, [*known, *(rounded(setting_at(at)) for at in _apart(tried, plan.proved))], pool)
    tell(f"put {len(proofs)} settings to the proof: the best keeps all sentences in {proofs[0].kept:.0%}")
    return Found(
        looked_at=len(first),
        first_costs=first_costs,
        held_at_first=held_at_first,
        tried=len(tried),
        held=sum(one.cost <= 0 for one in tried),
        cheaper=sum(one.cheaper for one in tried),
        visibly_worse=sum(one.visibly_worse for one in tried),
        both=sum(one.cheaper and one.visibly_worse for one in tried),
        all_visibly=sum(one.cost <= 0 and one.visibly_worse for one in tried),
        proofs=tuple(proofs),
    )


def _proofs(laboratory: Runner, settings: Sequence[Setting], pool: Executor) -> list[Proof]:
    """Each setting that differs from those before it, put to the proof, the best first."""
    different = [setting for i, setting in enumerate(settings) if dict(setting) not in map(dict, settings[:i])]
    return sorted((prove(laboratory, setting, pool) for setting in different), key=lambda proof: -proof.kept)


def _improve(laboratory: Runner, start: np.ndarray, plan: Plan, pool: Executor, tell: Tell) -> list[Tried]:
    """Every setting that the evolution has tried."""
    tried: list[Tried] = []

    def costs(points: np.ndarray) -> list[float]:
        found = list(pool.map(lambda shares: _screened(laboratory, shares), points))
        tried.extend(found)
        tell(f"tried {len(tried)} settings: least cost {min(one.cost for one in tried):.3f}")
        return [one.cost for one in found]

    minimize(costs, start, SPREAD, offspring=plan.offspring, generations=plan.generations, seed=RANDOM_SEED)
    return tried


def _screened(laboratory: Runner, shares: np.ndarray) -> Tried:
    """A setting over all seeds; where one seed alone is bad, with this seed's cost and `SCREENED`."""
    alone = tried_at(laboratory, shares, SEEDS[:1])
    return Tried(shares, alone.cost + SCREENED) if alone.cost > SCREEN else tried_at(laboratory, shares, SEEDS)


def tried_at(laboratory: Runner, shares: np.ndarray, seeds: Sequence[int]) -> Tried:
    """Try a setting over some seeds."""
    try:
        trial = Bench(laboratory, setting_at(shares)).sketch(seeds)
    except (SimulationError, NoContactError):
        return Tried(shares, FAILED)
    return Tried(shares, cost(excesses(trial)), "C8" not in broken(trial), visibly_worse(trial))


def _apart(tried: Sequence[Tried], n: int) -> list[np.ndarray]:
    """The n best points that lie apart from one another."""
    chosen: list[np.ndarray] = []
    for one in sorted(tried, key=lambda one: one.cost):
        if all(np.linalg.norm(one.shares - other) >= APART for other in chosen):
            chosen.append(one.shares)
        if len(chosen) == n:
            break
    return chosen
