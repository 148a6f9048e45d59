"""Everything the paper shows, from real FMUs: the main job."""

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from orchestration.master import Options, simulate
from orchestration.paper.claims import Claim, as_records, evaluate
from orchestration.paper.figures import draw
from orchestration.paper.provide import fmus
from orchestration.paper.scenarios import SCENARIOS
from orchestration.result import Result

Tell = Callable[[str], None]


@dataclass(frozen=True)
class Report:
    """Files written, and the claims."""

    figures: list[Path]
    claims_file: Path
    claims: list[Claim]


def reproduce(folder: Path, tell: Tell, image: str = "png") -> Report:
    """Run all scenarios, draw the figures, measure the claims.

    Parameters
    ----------
    folder
        Where the figures and ``claims.json`` go.
    tell
        Called with a sentence before each stage.
    image
        Format of the figures, ``"png"`` or ``"svg"``.
    """
    identifiers = {i for scenario in SCENARIOS.values() for i in scenario.units.values()}
    tell(f"Building {len(identifiers)} FMUs, or taking them from the cache")
    files = fmus(sorted(identifiers))
    results: dict[str, Result] = {}
    for scenario in SCENARIOS.values():
        tell(f"Running {scenario.name}: {scenario.caption}")
        results[scenario.name] = simulate(scenario.system(files), options=Options(strict=True))
    tell("Drawing the figures")
    figures = draw(results, folder, image)
    tell("Measuring the claims")
    claims = evaluate(results)
    claims_file = folder / "claims.json"
    claims_file.write_text(json.dumps(as_records(claims), indent=2) + "\n", encoding="utf-8")
    return Report(figures, claims_file, claims)
