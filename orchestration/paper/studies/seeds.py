"""C4 to C10 and C16 over many seeds of the noise, at the chosen values."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from orchestration.campaigns.study import Study
from orchestration.paper.numbers import TORQUE_LIMITS
from orchestration.paper.ready import scenario
from orchestration.paper.studies.claims_at import SCENARIOS, Evidence, verdicts
from orchestration.paper.studies.native_runs import Runner
from orchestration.paper.studies.shares import Share
from orchestration.paper.studies.summary_measure import ideal_force, summary_measure, summary_of

if TYPE_CHECKING:
    import xarray as xr

CLAIMS = ("C4", "C5", "C6", "C7", "C8", "C9", "C10", "C16")


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


def over_seeds(tables: Mapping[str, "xr.Dataset"]) -> tuple[dict[str, Share], dict[str, bool]]:
    """Judge the claims by the tables of all four scenarios.

    Returns
    -------
    shares
        For each claim the share of the seeds at which it holds, each seed judged alone.
    together
        For each claim whether it holds over all seeds at once, as `orchestration.paper.claims` asks: medians, and the
        worst of all.
    """
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
    shares = {claim: Share(sum(found[claim] for found in alone), len(seeds)) for claim in CLAIMS}
    return shares, {claim: together[claim] for claim in CLAIMS}
