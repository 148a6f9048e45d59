"""Builds FMUs, reproduces the paper, exports scenarios: ``adaptimp build``, ``paper`` and ``export``."""

import re
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from orchestration.errors import OrchestrationError, SystemDescriptionError
from orchestration.fmi.names import suggestion
from orchestration.sandbox.cache_folder import let_matplotlib_write

PROGRESS_AFTER = 1.0  # s
IMAGES = ("png", "svg")
_SETTING = re.compile(r"([^=\s]+)=(.*)", re.DOTALL)

console = Console(markup=False, highlight=False)  # names such as x[i] are no markup
errors = Console(stderr=True, markup=False, highlight=False)


def build_fmus(files: Sequence[Path], out: Path, platforms: Sequence[str]) -> None:
    """Build the models of Python files into a folder, or every model of the catalog if no file is given."""
    from adaptimp_fmu import PLATFORMS
    from fmus.catalog import MODELS
    from orchestration.cli.models import models_of
    from orchestration.paper.built_fmus import built_model

    for name in platforms:
        if name not in PLATFORMS and name != "all":
            msg = f"There is no platform {name}; {suggestion(name, [*PLATFORMS, 'all'])}"
            raise SystemDescriptionError(msg)
    chosen = list(PLATFORMS.values()) if "all" in platforms else [PLATFORMS[n] for n in platforms]
    models = models_of(files) if files else [declare() for declare in MODELS.values()]
    require_folder(out)
    for model in models:
        path = built_model(model, out, chosen)
        typer.echo(f"{path}  {path.stat().st_size / 1024:.0f} kB")


def reproduce_paper(out: Path, image: str, *, fresh: bool) -> None:
    """Reproduce the figures and claims of the paper, and print the table of claims."""
    let_matplotlib_write()
    from orchestration.paper.report import reproduce

    if image not in IMAGES:
        msg = f"There is no image format {image}; {suggestion(image, IMAGES)}"
        raise SystemDescriptionError(msg)
    require_folder(out)
    report = reproduce(out, lambda sentence: typer.echo(f"{sentence} ..."), image, fresh=fresh)
    table = Table("id", "claim", "measured", "verdict", title="Claims of the paper")
    colours = {"holds": "green", "not reproduced": "red"}
    for claim in report.claims:
        colour = colours.get(claim.verdict, "dim")
        table.add_row(claim.id, claim.claim, claim.measured, Text(claim.verdict, colour))
    console.print(table)
    if report.kept:
        typer.echo("The claims were measured by an earlier run on the same FMUs, numbers and code; --fresh repeats it.")
    for path in (*report.figures, report.claims_file):
        typer.echo(f"wrote {path}")


def require_folder(folder: Path) -> None:
    """Make a folder for results; a folder that nothing can be written to is refused before any work is done."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        msg = f"--out: nothing can be written to {folder}: {error.strerror}; choose another place."
        raise OrchestrationError(msg) from error


def export_scenario(name: str, out: Path) -> None:
    """Write a scenario as an SSP package."""
    from orchestration.paper.built_fmus import fmus, scenario

    if out.suffix != ".ssp":
        msg = f"{out}: a scenario is written as .ssp."
        raise SystemDescriptionError(msg)
    chosen = scenario(name)
    require_folder(out.parent)
    system = chosen.system(fmus(chosen.units.values()))
    system.write(out)
    counts = f"{len(system.components)} components, {len(system.connections)} connections"
    typer.echo(f"wrote {out}: {counts}, {len(system.assumptions)} assumed values with their reasons")


def setting_of(option: str) -> Callable[[str], tuple[str, str]]:
    """Return a function that splits a text NAME=VALUE of an option."""

    def split(text: str) -> tuple[str, str]:
        match = _SETTING.fullmatch(text)
        if match is None:
            msg = f"{option} {text}: NAME=VALUE is needed."
            raise SystemDescriptionError(msg)
        return match[1], match[2]

    return split
