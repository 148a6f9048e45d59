"""Writes a controller to begin with, and a test of it: ``adaptimp new controller NAME``."""

import importlib.util
import keyword
import shlex
from dataclasses import dataclass
from pathlib import Path

import jinja2

from adaptimp_fmu.files.whole_file import write_together
from fmus.catalog import MODELS, VARIANTS
from orchestration.cli.output import output
from orchestration.cli.places import require_folder, written
from orchestration.containers.c_text import identifier
from orchestration.errors import SystemDescriptionError
from orchestration.fmi.names import suggestion

CONTROLLER = "controller"


@dataclass(frozen=True)
class Beginning:
    """A law that a new controller begins with.

    Attributes
    ----------
    template
        Name of the file in ``templates`` that declares the law, without its suffixes.
    scenario
        The scenario whose controller has this law; for a law that no scenario has, one in which to try it.
    shipped
        Name of the shipped model with this law; empty if none has it.
    """

    template: str
    scenario: str = "fig5"
    shipped: str = ""


PLAIN = Beginning("plain")
"""What a controller begins with that is made from nothing."""
BEGINNINGS = {
    "craig": Beginning("craig", "fig5", "CraigAdaptiveImpedance"),
    "hogan": Beginning("hogan", "fig2", "HoganImpedance"),
    "slotine-li": Beginning("slotine_li", "fig7", "SlotineLiAdaptiveImpedance"),
    "spong-ortega": Beginning("spong_ortega", "spong-ortega", "SpongOrtegaAdaptiveImpedance"),
}
"""Laws of shipped controllers by the names that ``--from`` takes."""


def create(kind: str, name: str, source: str | None, out: Path, *, force: bool = False) -> None:
    """Write ``NAME.py``, which declares a controller, and ``test_NAME.py``, and say what to do next.

    Parameters
    ----------
    kind
        ``controller``.
    source
        One of `BEGINNINGS`; None begins with a spring and a damper.
    out
        Folder for both files.
    force
        Whether files that are there already are replaced.

    Raises
    ------
    SystemDescriptionError
        If there is no such kind or law, the name cannot be used, or a file is there already.
    OrchestrationError
        If nothing can be written to the folder.
    """
    if kind != CONTROLLER:
        msg = f"There is no {kind} to begin with; 'adaptimp new {CONTROLLER} NAME' begins a {CONTROLLER}."
        raise SystemDescriptionError(msg)
    if source is not None and source not in BEGINNINGS:
        msg = f"--from: there is no law {source}; {suggestion(source, BEGINNINGS)}"
        raise SystemDescriptionError(msg)
    beginning = PLAIN if source is None else BEGINNINGS[source]
    model, test = out / f"{name}.py", out / f"test_{name}.py"
    _require_name(name, model)
    present = [path for path in (model, test) if path.exists()]
    if present and not force:
        msg = f"{' and '.join(map(str, present))}: there already; choose another name, or replace with --force."
        raise SystemDescriptionError(msg)
    require_folder(out)
    write_together({model: _text(beginning.template, name, beginning), test: _text("test", name, beginning)})
    for path in (model, test):
        output.say(written(path, existed=path in present))
    output.say("Next:")
    for command in _next(model, test, beginning):
        output.say(f"  {shlex.join(command)}")


def _require_name(name: str, path: Path) -> None:
    """Refuse a name that a model, a module of Python or a file cannot have, or that another one has."""
    shipped = {known.lower(): known for known in (*MODELS, *VARIANTS)}
    usable = identifier(name, shipped.values(), "Mine")
    usable = f"{usable}_1" if keyword.iskeyword(usable) else usable
    if name.lower() in shipped:
        msg = f"{name}: a shipped model is called {shipped[name.lower()]}, so choose another name, such as {usable}."
        raise SystemDescriptionError(msg)
    if usable != name:
        msg = (
            f"{name!r} cannot be the name of a model, which is an identifier in Python and in C, and names a file;"
            f" {usable} could."
        )
        raise SystemDescriptionError(msg)
    module = importlib.util.find_spec(name)
    if module is not None and (module.origin is None or Path(module.origin).resolve() != path.resolve()):
        msg = f"{name} is the name of a module of Python, which {path} would hide; choose another name."
        raise SystemDescriptionError(msg)


def _text(template: str, name: str, beginning: Beginning) -> bytes:
    """The text of a file."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("orchestration.cli"),
        undefined=jinja2.StrictUndefined,
        # The text is Python, not HTML, and the name is an identifier.
        autoescape=False,  # noqa: S701  # nosec B701
        keep_trailing_newline=True,
        trim_blocks=True,
    )
    text = environment.get_template(f"{template}.py.jinja").render(name=name, **vars(beginning))
    return text.encode()


def _next(model: Path, test: Path, beginning: Beginning) -> list[list[str]]:
    """Commands that test the controller, build it, and run it in a scenario."""
    folder, fmu = model.parent, model.with_suffix(".fmu")
    build = ["adaptimp", "build", str(model), "-o", str(folder)]
    run = ["adaptimp", "run", beginning.scenario, "--controller", str(fmu)]
    return [["pytest", str(test)], build, run]
