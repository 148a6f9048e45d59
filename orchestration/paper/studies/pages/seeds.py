"""The part of the page on many seeds of the noise at a calibration."""

from orchestration.paper.studies.pages.text import percent, table
from orchestration.paper.studies.seeds import COMPARED, OverSeeds


def over_seeds(calibration: str, found: OverSeeds) -> str:
    """Verdicts over the seeds at a calibration, and how much larger errors are."""
    rows = [[claim, percent(found.share(claim)), "holds" if found.together[claim] else "fails"] for claim in found.yes]
    effects = [
        [of, f"{effect.median:.3g}", f"{effect.low:.3g} to {effect.high:.3g}", percent(effect.larger)]
        for of, effect in found.effects.items()
    ]
    return f"""## {found.n:,} seeds at the calibration `{calibration}`

    uv run python -m orchestration.paper.studies.robustness --seeds {found.n} --calibration {calibration}

judges the claims over the seeds 1 to {found.n:,}. In the second column each seed is judged alone. In the last one all
seeds are judged at once: by medians, and by the worst of all.{_by_chance(found)}

{table(("claim", "share of the seeds", "all seeds at once"), rows)}
The ratio of an error in one figure to that in another, with the same noise in both. In the third column stands the
interval of its median, at 95 %, from order statistics.

{table(("errors", "median ratio", "interval", "share of the seeds in which it is above 1"), effects)}"""


def left_out(calibration: str, found: OverSeeds) -> str:
    """What stands in the place of verdicts that were measured with other values of a calibration."""
    return f"""## Seeds at the calibration `{calibration}`

The kept verdicts over {found.n:,} seeds were measured with other values than the calibration has now, so they are left
out here.

    uv run python -m orchestration.paper.studies.robustness --seeds {found.n} --calibration {calibration}

measures them again.
"""


def _by_chance(found: OverSeeds) -> str:
    """What single seeds say of claims that compare errors, and that all seeds refute."""
    said = ", and ".join(
        f"{claim} holds at {100 * found.share(claim).value:.0f} % of single seeds"
        for claim, *_ in COMPARED
        if not found.together[claim] and found.yes[claim]
    )
    return f" By chance {said}: a share of the settings that is no larger says nothing." if said else ""
