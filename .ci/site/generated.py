"""Writes the pages of the reference that follow from the code: names, commands, variables of the FMUs, scenarios."""

import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))

import typer

import adaptimp_fmu
import orchestration
from adaptimp_fmu import Model, Variable
from fmus.catalog import MODELS, VARIANTS
from orchestration.cli.app import app
from orchestration.paper.scenarios import ALL_SCENARIOS, Scenario

FAILURES = "Error", "Warning", "Interrupted"
TITLES = {
    "system": "Systems",
    "paper": "Systems",
    "master": "Runs and algorithms",
    "results": "Results",
    "campaigns": "Studies",
    "analysis": "Judging a run",
    "fmi": "One FMU",
}
"""Titles of pages by the room of `orchestration` that holds a name."""
ERRORS, TOOLCHAIN = "Errors and warnings", "Making FMUs (adaptimp_fmu)"


def reference_pages() -> dict[str, str]:
    """All generated pages, by their paths in the site."""
    return {
        **api_pages(),
        "reference/all-options.md": commands(),
        "reference/variables.md": variables(MODELS | VARIANTS),
        "reference/scenarios.md": scenarios(ALL_SCENARIOS),
    }


def api_pages() -> dict[str, str]:
    """One page for the public names of each room of `orchestration`, one for errors, one for `adaptimp_fmu`."""
    names: dict[str, list[str]] = defaultdict(list)
    for name in orchestration.__all__:
        room = getattr(orchestration, name).__module__.split(".")[1]
        title = ERRORS if name.endswith(FAILURES) else TITLES[room]
        names[title].append(f"orchestration.{name}")
    names[TOOLCHAIN] = [f"adaptimp_fmu.{name}" for name in adaptimp_fmu.__all__]
    return {f"reference/api/{_file(title)}": _api(title, found) for title, found in names.items()}


def _file(title: str) -> str:
    """Name of the file of a page."""
    return "".join(c for c in title.partition(" (")[0].lower().replace(" ", "-") if c.isalnum() or c == "-") + ".md"


def _api(title: str, names: list[str]) -> str:
    """A page that mkdocstrings fills from docstrings."""
    package = names[0].partition(".")[0]
    head = f"# {title}\n\nEach name can be imported from `{package}`.\n\n"
    return head + "".join(f"::: {name}\n\n" for name in names)


def commands() -> str:
    """The help of all commands."""
    program = typer.main.get_command(app)
    said = "# All commands and options\n\nThis is what `adaptimp COMMAND --help` prints.\n"
    with program.make_context("adaptimp", [], resilient_parsing=True) as above:
        said += f"\n## adaptimp\n\n```text\n{program.get_help(above).rstrip()}\n```\n"
        for name in program.list_commands(above):  # type: ignore[attr-defined] - a group has them
            command = program.get_command(above, name)  # type: ignore[attr-defined]
            with command.make_context(name, [], parent=above, resilient_parsing=True) as context:
                said += f"\n## adaptimp {name}\n\n```text\n{command.get_help(context).rstrip()}\n```\n"
    return said


def variables(models: Mapping[str, object]) -> str:
    """Tables of the variables of all FMUs."""
    said = (
        "# Units and variables of the FMUs\n\nThe tables follow from the definitions in `fmus/`, as the FMUs do. An"
        " array stands in one row; where its elements differ, their numbers or texts stand one after the other.\n"
    )
    for name, declare in models.items():
        model: Model = declare()  # type: ignore[operator]
        said += f"\n## {name}\n\n{model.description}.\n\n{_table(model)}\n"
    return said


def _table(model: Model) -> str:
    """The variables of a model, arrays in one row each."""
    rows = ["| variable | role | unit | start | range | meaning |", "|---|---|---|---|---|---|"]
    for name, elements in _arrays(model.ordered_variables()):
        role = elements[0].role.name.lower().replace("_", " ")
        texts = [_joined(e.unit if e.type.value == "Real" else e.type.value for e in elements)]
        texts += [_joined("" if e.start is None else f"{e.start:.6g}" for e in elements)]
        texts += [_joined(e.range for e in elements), _joined(e.description for e in elements)]
        rows.append(" | ".join([f"| `{name}`", role, *texts]).replace("<", "&lt;") + " |")
    return "\n".join(rows) + "\n"


def _arrays(found: list[Variable]) -> Iterator[tuple[str, list[Variable]]]:
    """Variables by the name of their array, with its size."""
    by_name: dict[str, list[Variable]] = defaultdict(list)
    for variable in found:
        by_name[variable.name.partition("[")[0]].append(variable)
    for name, elements in by_name.items():
        index = elements[-1].name.removeprefix(name)
        yield name + index, elements


def _joined(texts: Iterator[str]) -> str:
    """One text if all are equal, else all of them."""
    each = list(texts)
    return each[0] if len(set(each)) == 1 else ", ".join(text or "1" for text in each)


def scenarios(found: Mapping[str, Scenario]) -> str:
    """A table of the scenarios, and the start values of those of the figures with their origins."""
    said = (
        "# Scenarios\n\n`adaptimp run NAME` runs a scenario, `adaptimp run NAME --assumptions` says what was assumed"
        " and why, and `scenario(NAME)` gives it to a script.\n\n"
        "| name | what it is | controller | step, s | until, s |\n"
        "|---|---|---|---|---|\n"
    )
    for name, s in found.items():
        said += f"| `{name}` | {s.caption} | `{s.models['controller']}` | {s.step:g} | {s.stop_time:g} |\n"
    said += "\nAn origin of *V* is Section V of the paper.\n"
    for name, s in found.items():
        said += f"\n## {name}\n\n{s.caption}.\n\n| start value | number | origin |\n|---|---|---|\n"
        said += "".join(f"| `{path}` | {v.number:.6g} | {v.origin} |\n" for path, v in s.values.items())
    return said
