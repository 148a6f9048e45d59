"""Builds FMUs and reproduces the paper: ``adaptimp build`` and ``adaptimp paper``."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.table import Column, Table
from rich.text import Text

from adaptimp_fmu.files.cache_folder import let_matplotlib_write
from adaptimp_fmu.files.parts import imported
from orchestration.cli.output import output, watched
from orchestration.cli.places import require_folder, written
from orchestration.errors import SystemDescriptionError
from orchestration.fmi.names import suggestion
from orchestration.master.progress import RUNNING

if TYPE_CHECKING:
    from adaptimp_fmu import Model, Platform
    from orchestration.master.progress import ProgressLine
    from orchestration.paper.claims.claim import Claim
    from orchestration.paper.report import Report
    from orchestration.paper.spatial_report import SpatialReport

IMAGES = ("png", "svg")
PLANAR, PUMA = "planar", "puma"
ROBOTS = (PLANAR, PUMA)
Tell = Callable[[str], None]


def build_fmus(files: Sequence[Path], out: Path, platforms: Sequence[str], *, reals: bool = False) -> None:
    """Build models of the catalog by name and those of Python files into a folder; without any, the whole catalog.

    Variants in the catalog are built by name only.
    """
    from fmus.catalog import MODELS
    from orchestration.cli.models import models_of

    chosen = chosen_platforms(platforms)
    models = models_of(files) if files else [declare() for declare in MODELS.values()]
    require_folder(out)
    with watched() as line:
        build_models(models, out, chosen, line, reals=reals)


def require_no_robot(options: Mapping[str, object]) -> None:
    """Refuse options of a robot where none is given.

    Raises
    ------
    SystemDescriptionError
        If one of these options has a value.
    """
    for option, value in options.items():
        if value:
            msg = f"{option} is of a robot, and no robot is given; give its file: --robot arm.urdf."
            raise SystemDescriptionError(msg)


def chosen_platforms(names: Sequence[str]) -> "list[Platform]":
    """The platforms of some names; ``all`` is every one.

    Raises
    ------
    SystemDescriptionError
        If there is no such platform.
    """
    from adaptimp_fmu import PLATFORMS

    for name in names:
        if name not in PLATFORMS and name != "all":
            msg = f"There is no platform {name}; {suggestion(name, [*PLATFORMS, 'all'])}"
            raise SystemDescriptionError(msg)
    return list(PLATFORMS.values()) if "all" in names else [PLATFORMS[name] for name in names]


def build_models(
    models: "Iterable[Model]", out: Path, platforms: "Sequence[Platform]", line: "ProgressLine", *, reals: bool = False
) -> dict[str, Path]:
    """Build models into a folder, and say of each file that it is there; returns the files by the models' names."""
    from orchestration.paper.built_fmus import built_model

    files = {}
    for model in models:
        before = _stamp(out / f"{model.name}.fmu")
        line.begin(f"building {model.name}")
        files[model.name] = path = built_model(model, out, platforms, reals=reals)
        line.end()
        replaced = ", replaced" if before is not None and _stamp(path) != before else ""
        output.say(f"{path}  {path.stat().st_size / 1024:.0f} kB{replaced}")
    return files


def _stamp(path: Path) -> tuple[int, int] | None:
    """What changes when a file is written anew; None if there is no such file."""
    if not path.exists():
        return None
    status = path.stat()
    return status.st_ino, status.st_mtime_ns


def reproduce_paper(out: Path, image: str, robot: str, *, fresh: bool) -> None:
    """Reproduce the figures and claims of the paper with an arm, and print the table of claims."""
    if robot not in ROBOTS:
        msg = f"--robot: there is no arm {robot}; {suggestion(robot, ROBOTS)}"
        raise SystemDescriptionError(msg)
    if image not in IMAGES:
        msg = f"There is no image format {image}; {suggestion(image, IMAGES)}"
        raise SystemDescriptionError(msg)
    let_matplotlib_write()
    for package in ("bokeh", "casadi", "scipy"):
        imported(package, "paper")
    require_folder(out)
    present = set(out.iterdir())
    with watched() as line:

        def tell(sentence: str) -> None:
            output.say(f"{sentence} ...")
            line.begin(RUNNING)

        title, words, report, files = (_in_space if robot == PUMA else _in_the_plane)(out, image, tell, fresh=fresh)
    _show_claims(title, report.claims, words)
    if report.kept:
        output.say("The claims were measured by an earlier run on the same FMUs, numbers and code; --fresh repeats it.")
    for path in (*report.figures, report.claims_file, report.claims_file.with_suffix(".md"), *files):
        output.say(written(path, existed=path in present))


def _in_the_plane(
    out: Path, image: str, tell: Tell, *, fresh: bool
) -> "tuple[str, Mapping[str, str], Report, list[Path]]":
    """Reproduce the paper: a title, how strongly claims hold, the report, and further files."""
    from orchestration.paper.report import reproduce

    report = reproduce(out, tell, image, fresh=fresh)
    return "Claims of the paper", report.words, report, [report.page]


def _in_space(
    out: Path, image: str, tell: Tell, *, fresh: bool
) -> "tuple[str, Mapping[str, str], SpatialReport, list[Path]]":
    """Reproduce the paper with the PUMA 560; what is returned is that of `_in_the_plane`."""
    from orchestration.paper.spatial_report import reproduce_in_space

    report = reproduce_in_space(out, tell, image, fresh=fresh)
    return "Claims of the paper, PUMA 560", {one.id: one.verdict for one in report.claims}, report, []


def _show_claims(title: str, claims: "Sequence[Claim]", words: Mapping[str, str]) -> None:
    from orchestration.paper.claims.claim import HOLDS

    columns = [Column(name, overflow="fold") for name in ("id", "claim", "in words")]  # nothing is cut
    table = Table(*columns, title=title)
    for claim in claims:
        colour = "green" if claim.verdict == HOLDS else "red"
        table.add_row(claim.id, claim.claim, Text(words[claim.id], colour))
    output.show(table)
