"""Reproduces everything the paper shows, figures and claims, from FMUs."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from adaptimp_fmu.files.parts import MissingPartError
from adaptimp_fmu.files.temporary_folder import temporary_folder
from adaptimp_fmu.files.whole_file import write_whole
from orchestration.paper.built_fmus import fmus
from orchestration.paper.claims.cache import claims_of
from orchestration.paper.claims.claim import Claim
from orchestration.paper.claims.evaluation import evaluate
from orchestration.paper.claims.page import as_markdown, as_records, word
from orchestration.paper.evidence import Evidence
from orchestration.paper.figures.draw import draw
from orchestration.paper.laboratory import Job
from orchestration.paper.page.report import NAME, paper_page, write_page
from orchestration.paper.scenarios import PLANAR_SCENARIOS, SCENARIOS, Scenario
from orchestration.paper.strength import read_strength
from orchestration.paper.studies.native_runs import NativeLaboratory
from orchestration.report.page import Page
from orchestration.results.result import Result
from orchestration.sandbox.archive import file_hash

Tell = Callable[[str], None]


@dataclass(frozen=True)
class Report:
    """What was reproduced.

    Attributes
    ----------
    figures, claims_file, page
        Files that were written.
    claims
        The claims with their verdicts.
    words
        How strongly each claim holds, in a phrase, by claim.
    kept
        Whether the claims were measured by an earlier run.
    """

    figures: list[Path]
    claims_file: Path
    page: Path
    claims: list[Claim]
    words: Mapping[str, str]
    kept: bool


def reproduce(folder: Path, tell: Tell, image: str = "png", *, fresh: bool = False) -> Report:
    """Run all scenarios, draw the figures, measure the claims.

    Parameters
    ----------
    folder
        Where the figures, ``claims.json``, ``claims.md`` and ``report.html`` go.
    tell
        Called with a sentence before each stage.
    image
        Format of the figures, ``"png"`` or ``"svg"``.
    fresh
        Whether to measure the claims even if they are in the cache.
    """
    scenarios = PLANAR_SCENARIOS
    identifiers = {i for scenario in scenarios.values() for i in scenario.models.values()}
    tell(f"Building {len(identifiers)} FMUs, or taking them from the cache")
    laboratory = NativeLaboratory(fmus(sorted(identifiers)))
    results: dict[str, Result] = {}
    for scenario in SCENARIOS.values():
        tell(f"Running {scenario.name}: {scenario.caption}")
        results[scenario.name] = laboratory.run(Job(scenario.name))
    tell("Drawing the figures")
    figures = draw(results, folder, image)
    tell("Measuring the claims, over 30 seeds where noise matters, or taking them from the cache")
    digests = _digests(laboratory, scenarios)
    claims, kept = claims_of(digests, lambda: evaluate(Evidence(laboratory, results)), fresh=fresh)
    strength = read_strength()
    claims_file = folder / "claims.json"
    write_whole(claims_file, f"{json.dumps(as_records(claims, digests, strength), indent=2)}\n".encode())
    write_whole(folder / "claims.md", as_markdown(claims, digests, strength).encode())
    words = {claim.id: word(claim, strength) for claim in claims}
    tell("Writing the page of the paper")
    page = folder / NAME
    write_page(_page(results, claims, words, tell), page)
    return Report(figures, claims_file, page, claims, words, kept)


def _page(results: Mapping[str, Result], claims: Sequence[Claim], words: Mapping[str, str], tell: Tell) -> Page:
    """The page of the paper, with the live part unless its programs would have to be built and cannot be."""
    from orchestration.paper.page.live import live_parts
    from orchestration.paper.page.live_data import native_hashes

    page = paper_page(results, claims, words)
    try:
        return live_parts(native_hashes(results)).added_to(page)
    except MissingPartError as error:
        tell(f"The page runs nothing live. {error}")
        return page


def _digests(laboratory: NativeLaboratory, scenarios: Mapping[str, Scenario]) -> dict[str, str]:
    """SHA-256 of each scenario's SSP package."""
    with temporary_folder() as folder:
        return {
            name: file_hash(scenario.system(laboratory.fmus).write(folder / f"{name}.ssp"))
            for name, scenario in scenarios.items()
        }
