"""Lists what the package brings: scenarios, FMUs and algorithms, each with one line: ``adaptimp list``."""

import json as formats

from adaptimp_fmu.files.parts import lacks
from fmus.carried import description, why_not_carried
from fmus.catalog import MODELS, VARIANTS, model
from orchestration.campaigns.measuring.registry import ready_measures
from orchestration.cli.output import output, width
from orchestration.cli.tables import definitions
from orchestration.master.algorithm import SUMMARIES
from orchestration.paper.scenarios import ALL_SCENARIOS

USES = {
    "scenarios": "run NAME",
    "fmus": "info NAME",
    "variants": "info NAME",
    "algorithms": "run fig2 --algorithm NAME",
    "measures": "sweep fig5 --seeds 1-3 --measure NAME",
}
"""What is listed, and the command that takes a name."""
_TITLES = {"fmus": "FMUs", "variants": "Variants of FMUs"}


def list_all(*, json: bool) -> None:
    """Print the names of all scenarios, FMUs, their variants and algorithms, each with what it is."""
    found = {
        "scenarios": {name: scenario.caption for name, scenario in ALL_SCENARIOS.items()},
        "fmus": {name: _described(name) for name in MODELS},
        "variants": {name: _described(name) for name in VARIANTS},
        "algorithms": dict(SUMMARIES),
        "measures": {name: summary for name, (_, summary) in ready_measures().items()},
    }
    if json:
        output.data(formats.dumps(found, indent=2))
        return
    for kind in ("fmus", "variants"):
        found[kind] = {name: f"{text}{_needed(name)}" for name, text in found[kind].items()}
    for title, use in USES.items():
        if title != "scenarios":
            output.data("")
        output.data(f"{_TITLES.get(title, title.capitalize())}  (adaptimp {use})")
        output.data(definitions(list(found[title].items()), width(), "  "))


def _described(identifier: str) -> str:
    """What a shipped FMU is, in a line."""
    return description(identifier) or model(identifier).description


def _needed(identifier: str) -> str:
    """What an FMU needs that is not installed, behind what it is."""
    return '; needs the part "build"' if why_not_carried(identifier) and lacks("build") else ""


def list_ready(*, json: bool) -> None:
    """Print the names of the ready studies, each with what it is."""
    from orchestration.paper.studies.ready import READY_STUDIES

    found = {name: study.summary for name, study in READY_STUDIES.items()}
    output.data(formats.dumps(found, indent=2) if json else definitions(list(found.items()), width()))
