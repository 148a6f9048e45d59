"""Reproduces the figures of the paper with the PUMA 560, and asks the claims of it: ``adaptimp paper --robot puma``."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from adaptimp_fmu.files.temporary_folder import temporary_folder
from adaptimp_fmu.files.whole_file import write_whole
from orchestration.paper.built_fmus import fmus
from orchestration.paper.cases import FIGURES, PUMA_CASE
from orchestration.paper.claims.cache import claims_of
from orchestration.paper.claims.claim import Claim
from orchestration.paper.claims.evaluation import evaluate_in_space
from orchestration.paper.claims.spatial_page import page_in_space, records_in_space
from orchestration.paper.evidence import Evidence
from orchestration.paper.figures.spatial import draw_in_space
from orchestration.paper.laboratory import Job
from orchestration.paper.spatial_scenarios import SPATIAL
from orchestration.paper.studies.native_runs import NativeLaboratory
from orchestration.results.result import Result
from orchestration.sandbox.archive import file_hash

NAME = "puma-claims"
Tell = Callable[[str], None]


@dataclass(frozen=True)
class SpatialReport:
    """What was reproduced.

    Attributes
    ----------
    figures, claims_file
        Files that were written.
    claims
        The claims with their verdicts.
    kept
        Whether the claims were measured by an earlier run.
    """

    figures: list[Path]
    claims_file: Path
    claims: list[Claim]
    kept: bool


def reproduce_in_space(folder: Path, tell: Tell, image: str = "png", *, fresh: bool = False) -> SpatialReport:
    """Run the scenarios of the PUMA 560, draw the figures, measure the claims.

    Parameters
    ----------
    folder
        Where the figures, ``puma-claims.json`` and ``puma-claims.md`` go.
    tell
        Called with a sentence before each stage.
    image
        Format of the figures, ``"png"`` or ``"svg"``.
    fresh
        Whether to measure the claims even if they are in the cache.
    """
    identifiers = sorted({i for scenario in SPATIAL.values() for i in scenario.models.values()})
    tell(f"Building {len(identifiers)} FMUs, or taking them from the cache")
    laboratory = NativeLaboratory(fmus(identifiers))
    results = _results(laboratory, tell)
    tell("Drawing the figures")
    captions = {figure: PUMA_CASE.scenario(figure).caption for figure in FIGURES}
    figures = draw_in_space(results, captions, folder, image)
    tell("Measuring the claims, over 30 seeds where noise matters, or taking them from the cache")
    with temporary_folder() as place:
        digests = {
            name: file_hash(scenario.system(laboratory.fmus).write(place / f"{name}.ssp"))
            for name, scenario in SPATIAL.items()
        }
    claims, kept = claims_of(digests, lambda: evaluate_in_space(Evidence(laboratory, results, PUMA_CASE)), fresh=fresh)
    claims_file = folder / f"{NAME}.json"
    write_whole(claims_file, f"{json.dumps(records_in_space(claims, digests), indent=2)}\n".encode())
    write_whole(folder / f"{NAME}.md", page_in_space(claims, digests).encode())
    return SpatialReport(figures, claims_file, claims, kept)


def _results(laboratory: NativeLaboratory, tell: Tell) -> Mapping[str, Result]:
    """The runs of the figures; those of Figs. 2 and 3 are the same one."""
    runs: dict[str, Result] = {}
    for name in dict.fromkeys(PUMA_CASE.runs[figure] for figure in FIGURES):
        tell(f"Running {name}: {SPATIAL[name].caption}")
        runs[name] = laboratory.run(Job(name))
    return {figure: runs[PUMA_CASE.runs[figure]] for figure in FIGURES}
