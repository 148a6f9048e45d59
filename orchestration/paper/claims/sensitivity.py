"""Measures the claim that algorithm 2 is less sensitive to Psi and Gamma: C11."""

from collections.abc import Sequence

from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.claims.criteria import Criterion
from orchestration.paper.evidence import GAMMA_GRID_FACTORS, PSI_GRID, Evidence
from orchestration.paper.measure import Summary
from orchestration.paper.numbers import LARGEST_PSI


def stable(summary: Summary) -> bool:
    """Whether a run is stable, as `criteria.STABLE` says."""
    return _met(limits.STABLE, (summary.e_max, summary.end))


def accurate(summary: Summary) -> bool:
    """Whether a run is accurate, as `criteria.ACCURATE` says."""
    return _met(limits.ACCURATE, (summary.e_free, summary.e_contact, summary.m2_in_contact))


def _met(criteria: Sequence[Criterion], measured: Sequence[float]) -> bool:
    return all(criterion.met(value) for criterion, value in zip(criteria, measured, strict=True))


def _counts(evidence: Evidence, *, accurately: bool) -> tuple[dict[str, int], str]:
    """The number of good runs by scenario, and a sentence."""
    counts = {
        name: sum(s is not None and stable(s) and (accurate(s) or not accurately) for _, _, s in rows)
        for name, rows in evidence.sensitivity.items()
    }
    total = len(evidence.sensitivity["fig5"])
    failed = {name: sum(s is None for _, _, s in rows) for name, rows in evidence.sensitivity.items()}
    compared = "as many" if counts["fig7"] == counts["fig5"] else "more" if counts["fig7"] > counts["fig5"] else "fewer"
    return counts, (
        f"algorithm 1 {counts['fig5']} of {total}, algorithm 2 {counts['fig7']} of {total}, {compared};"
        f" {failed['fig5']} and {failed['fig7']} runs failed"
    )


def _more_stable(evidence: Evidence) -> Finding:
    counts, text = _counts(evidence, accurately=False)
    return Finding({limits.MORE_STABLE_RUNS: counts["fig7"] - counts["fig5"]}, f"stable: {text}")


def _more_accurate(evidence: Evidence) -> Finding:
    counts, text = _counts(evidence, accurately=True)
    return Finding({limits.MORE_ACCURATE_RUNS: counts["fig7"] - counts["fig5"]}, f"stable and accurate: {text}")


_RUNS = "fig5, fig7 without limits (seed 1)"
_GRID = (
    f"of {len(PSI_GRID)} x {len(GAMMA_GRID_FACTORS)} runs over the part that both algorithms allow, Psi from"
    f" {PSI_GRID[0]:.3g} to {PSI_GRID[-1]:.3g} 1/s (algorithm 1 needs less than B/M = {LARGEST_PSI:g}), and Gamma from"
    " a tenth to ten times that of the figure; a run is stable if " + " and ".join(map(str, limits.STABLE))
)

QUESTIONS = (
    Question(
        "C11a",
        "For a stable execution of the task algorithm 2 is less sensitive to Psi and Gamma than algorithm 1",
        "V",
        (limits.MORE_STABLE_RUNS,),
        _more_stable,
        _RUNS,
        _GRID,
    ),
    Question(
        "C11b",
        "For a stable and accurate execution algorithm 2 is less sensitive to Psi and Gamma than algorithm 1",
        "V",
        (limits.MORE_ACCURATE_RUNS,),
        _more_accurate,
        _RUNS,
        f"{_GRID}, and accurate if {', '.join(map(str, limits.ACCURATE))}",
    ),
)
