"""C4 to C10 and C16 over many seeds of the noise, at the chosen values."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.campaigns.study import Study
from orchestration.paper.numbers import TORQUE_LIMITS
from orchestration.paper.ready import scenario
from orchestration.paper.share import Share
from orchestration.paper.studies.claims_at import SCENARIOS, Evidence, verdicts
from orchestration.paper.studies.native_runs import Runner
from orchestration.paper.studies.summary_measure import ideal_force, summary_measure, summary_of

if TYPE_CHECKING:
    import xarray as xr

CLAIMS = ("C4", "C5", "C6", "C7", "C8", "C9", "C10", "C16")


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
    """

    n: int
    yes: Mapping[str, int]
    together: Mapping[str, bool]

    def share(self, claim: str) -> Share:
        """The share of the seeds at which a claim holds."""
        return Share(self.yes[claim], self.n)

    def write(self, path: Path) -> None:
        """Write the verdicts as JSON."""
        write_whole(path, f"{json.dumps(asdict(self), indent=1)}\n".encode())

    @classmethod
    def read(cls, path: Path) -> "OverSeeds":
        """Read verdicts from JSON."""
        return cls(**json.loads(path.read_text(encoding="utf-8")))


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


def over_seeds(tables: Mapping[str, "xr.Dataset"]) -> OverSeeds:
    """Judge the claims by the tables of all four scenarios."""
    limits = np.array(TORQUE_LIMITS)
    seeds = tables[SCENARIOS[0]]["seed"].to_numpy()
    runs = {
        name: {
            int(seed): summary_of({str(key): values.sel(seed=seed) for key, values in table.items()})
            for seed in seeds
            if table["status"].sel(seed=seed) == "complete"
        }
        for name, table in tables.items()
    }
    alone = [
        verdicts(Evidence({name: [found[int(seed)]] for name, found in runs.items() if int(seed) in found}, limits))
        for seed in seeds
    ]
    whole = {name: list(found.values()) for name, found in runs.items() if len(found) == len(seeds)}
    together = verdicts(Evidence(whole, limits))
    yes = {claim: sum(found[claim] for found in alone) for claim in CLAIMS}
    return OverSeeds(len(seeds), yes, {claim: together[claim] for claim in CLAIMS})
