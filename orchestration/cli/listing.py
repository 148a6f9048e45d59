"""Lists what the package brings: scenarios, FMUs and algorithms, each with one line: ``adaptimp list``."""

import json as formats

from fmus.catalog import MODELS
from orchestration.cli.output import output, width
from orchestration.cli.tables import definitions
from orchestration.master.algorithm import SUMMARIES
from orchestration.paper.scenarios import SCENARIOS, VARIANTS


def list_all(*, json: bool) -> None:
    """Print the names of all scenarios, shipped FMUs and algorithms, each with what it is."""
    found = {
        "scenarios": {name: scenario.caption for name, scenario in {**SCENARIOS, **VARIANTS}.items()},
        "fmus": {name: declare().description for name, declare in MODELS.items()},
        "algorithms": dict(SUMMARIES),
    }
    if json:
        output.data(formats.dumps(found, indent=2))
        return
    for title, use in (("scenarios", "run NAME"), ("fmus", "info NAME"), ("algorithms", "run fig2 --algorithm NAME")):
        if title != "scenarios":
            output.data("")
        output.data(f"{'FMUs' if title == 'fmus' else title.capitalize()}  (adaptimp {use})")
        output.data(definitions(list(found[title].items()), width(), "  "))
