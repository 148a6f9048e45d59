"""Puts a setting to the proof: how often all sentences hold over seeds, and when all values change by a little."""

from collections import Counter
from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass

from orchestration.errors import SimulationError
from orchestration.paper.calibrations import Setting
from orchestration.paper.laboratory import SEEDS, Runner
from orchestration.paper.measure import NoContactError
from orchestration.paper.studies.calibration.objective import broken, cost, excesses
from orchestration.paper.studies.calibration.space import perturbed
from orchestration.paper.studies.calibration.trial import Bench

PERTURBATIONS = 32
PERTURBED_SEEDS = tuple(range(1, 17))
FAILED = "a run fails"


@dataclass(frozen=True)
class Proof:
    """A setting and how well it keeps the sentences of Section V.

    Attributes
    ----------
    setting
        The setting.
    noise_bound, torque_limits
        The constants that follow from its runs, N and N.m.
    cost
        Its cost over all `SEEDS`; negative if all sentences hold.
    excesses
        Excess of each part of the claims over all seeds.
    seeds, perturbations
        Number of seeds, and of changed settings.
    seeds_kept, perturbations_kept
        How many of them keep all sentences, each seed judged alone.
    by_seed, by_perturbation
        For each claim the number of seeds, and of changed settings, that break it.
    """

    setting: Setting
    noise_bound: float
    torque_limits: tuple[float, float]
    cost: float
    excesses: Mapping[str, float]
    seeds: int
    seeds_kept: int
    by_seed: Mapping[str, int]
    perturbations: int
    perturbations_kept: int
    by_perturbation: Mapping[str, int]

    @property
    def kept(self) -> float:
        """The smaller one of both shares."""
        return min(self.seeds_kept / self.seeds, self.perturbations_kept / self.perturbations)


def prove(laboratory: Runner, setting: Setting, pool: Executor, n: int = PERTURBATIONS) -> Proof:
    """Put a setting to the proof with n changes of all its values.

    Raises
    ------
    SimulationError
        If a run fails at the setting itself.
    NoContactError
        If the tip never touches the wall there.
    """
    trial = Bench(laboratory, setting).trial(SEEDS, len(SEEDS))
    found = excesses(trial)
    alone = [broken(trial.alone(number)) for number in range(len(SEEDS))]
    changed = list(pool.map(lambda near: _broken_at(laboratory, near), perturbed(setting, n)))
    one, two = trial.torque_limits.tolist()
    return Proof(
        setting=dict(setting),
        noise_bound=trial.noise_bound,
        torque_limits=(one, two),
        cost=cost(found),
        excesses=found,
        seeds=len(SEEDS),
        seeds_kept=alone.count(()),
        by_seed=_counted(alone),
        perturbations=len(changed),
        perturbations_kept=changed.count(()),
        by_perturbation=_counted(changed),
    )


def _broken_at(laboratory: Runner, setting: Setting) -> tuple[str, ...]:
    try:
        return broken(Bench(laboratory, setting).sketch(PERTURBED_SEEDS))
    except (SimulationError, NoContactError):
        return (FAILED,)


def _counted(names: list[tuple[str, ...]]) -> dict[str, int]:
    return dict(sorted(Counter(name for claims in names for name in claims).items()))
