"""The claims of Figs. 5 to 7 over many seeds of the noise, at a calibration."""

import json
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.campaigns.study import Study
from orchestration.paper import settings
from orchestration.paper.calibrations import Calibration
from orchestration.paper.effect import paired_effect
from orchestration.paper.laboratory import Runner
from orchestration.paper.ready import scenario
from orchestration.paper.share import Share
from orchestration.paper.strength import Effect, effect_from
from orchestration.paper.studies.claims_at import Evidence, verdicts
from orchestration.paper.studies.raw_rows import Row
from orchestration.paper.studies.runs_at import FIXED_MASS, Chain
from orchestration.paper.studies.summary_measure import ideal_force, summary_measure

CLAIMS = ("C4", "C5", "C6", "C7", "C8", "C9", "C10", "C13", "C14a", "C16", "C17", "C7 clearly", "C10 clearly")
COMPARED = (("C7", "fig6", "fig5"), ("C10", "fig7", "fig5"))
"""Claims that compare errors of two figures: the first has the larger ones."""
ERRORS = ("e_contact", "e_contact_rms", "force_error")


@dataclass(frozen=True)
class OverSeeds:
    """Verdicts over many seeds.

    Attributes
    ----------
    n
        Number of seeds.
    yes
        For each claim the number of seeds at which it holds, each seed judged alone.
    together
        For each claim whether it holds over all seeds at once, as `orchestration.paper.claims` asks: medians, and the
        worst of all.
    effects
        How much larger the errors of Figs. 6 and 7 are than those of Fig. 5, such as ``fig6/fig5 e_contact``.
    numbers
        Numbers of the calibration, as `Calibration.numbers` gives them.
    """

    n: int
    yes: Mapping[str, int]
    together: Mapping[str, bool]
    effects: Mapping[str, Effect]
    numbers: Mapping[str, float]

    def is_of(self, calibration: Calibration) -> bool:
        """Whether the seeds were judged at the numbers that a calibration has today."""
        return dict(self.numbers) == dict(calibration.numbers)

    def share(self, claim: str) -> Share:
        """The share of the seeds at which a claim holds."""
        return Share(self.yes[claim], self.n)


def write_seeds(path: Path, found: Mapping[str, OverSeeds]) -> None:
    """Write verdicts by the name of a calibration as JSON."""
    record = {name: asdict(one) for name, one in found.items()}
    write_whole(path, f"{json.dumps(record, indent=1)}\n".encode())


def read_seeds(path: Path) -> dict[str, OverSeeds]:
    """Read verdicts by the name of a calibration."""
    record = json.loads(path.read_text(encoding="utf-8"))
    return {
        name: OverSeeds(**{**one, "effects": {of: effect_from(effect) for of, effect in one["effects"].items()}})
        for name, one in record.items()
    }


def over_seeds(laboratory: Runner, calibration: Calibration, n: int, pool: Executor) -> OverSeeds:
    """Judge the claims at a calibration over the seeds 1 to n, each alone and all at once.

    The bound of the noise and the limits of torque are those of the calibration.

    Raises
    ------
    SimulationError
        If a run without noise fails.
    """
    first = _chain(laboratory, calibration, 1)
    first.prepare_with(calibration.noise_bound)
    first.without_adaptation()
    fixed = {name: value for name, value in first.numbers.items() if name.startswith(FIXED_MASS)}

    def row(seed: int) -> Row:
        chain = _chain(laboratory, calibration, seed)
        chain.bound, chain.ideal = first.bound, first.ideal
        chain.adaptive()
        return Row({**chain.numbers, **fixed}, chain.failures)

    return judged_over(list(pool.map(row, range(1, n + 1))), calibration)


def judged_over(rows: Sequence[Row], calibration: Calibration) -> OverSeeds:
    """Judge the claims by the rows of some seeds at a calibration."""
    alone = [verdicts(Evidence([row])) for row in rows]
    together = verdicts(Evidence(rows))
    effects = {}
    for _, figure, than in COMPARED:
        for error in ERRORS:
            pairs = np.array([[row.numbers.get(f"{run}.{error}", np.nan) for run in (figure, than)] for row in rows])
            complete = pairs[~np.isnan(pairs).any(axis=1)]
            effects[f"{figure}/{than} {error}"] = paired_effect(complete[:, 0], complete[:, 1])
    yes = {claim: sum(found[claim] for found in alone) for claim in CLAIMS}
    return OverSeeds(len(rows), yes, {claim: together[claim] for claim in CLAIMS}, effects, dict(calibration.numbers))


def _chain(laboratory: Runner, calibration: Calibration, seed: int) -> Chain:
    return Chain(laboratory, calibration.values, seed, limits=settings.limits(calibration.torque_limits))


def seeds_study(name: str, laboratory: Runner, n: int = 1000) -> Study:
    """The runs of a scenario over the seeds 1 to n.

    Parameters
    ----------
    name
        ``fig5``, ``fig6``, ``fig7`` or ``spong-ortega``.
    laboratory
        Makes the ideal run, with which forces are compared.

    Examples
    --------
    >>> from orchestration.paper.studies.robustness import laboratory
    >>> from orchestration.paper.studies.seeds import seeds_study
    >>> table = seeds_study("fig7", laboratory(), 3).run()
    >>> table.sizes["seed"], bool((table["m2_in_contact"] < 0.2).all())
    (3, True)
    """
    return Study(scenario(name), measure=summary_measure(ideal_force(laboratory))).seeds(range(1, n + 1))
