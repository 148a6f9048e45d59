"""Writes pages about runs: ``adaptimp report`` and ``adaptimp run --plot F.html``."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from adaptimp_fmu.files.parts import require
from orchestration.cli.output import output, watched
from orchestration.cli.places import require_folder, written
from orchestration.cli.systems import SystemRequest
from orchestration.errors import SystemDescriptionError
from orchestration.results.formats import READERS
from orchestration.results.result import Result
from orchestration.system.system import System

PAGE = ".html"
MOST_RUNS = 2


def is_page(path: Path | None) -> bool:
    """Whether a file is to be a page, by its suffix."""
    return path is not None and path.suffix.lower() == PAGE


def report_runs(words: Sequence[str], out: Path) -> None:
    """Write a page about results, or about runs of systems that are made first.

    Parameters
    ----------
    words
        One or two files of results, or names of systems.

    Raises
    ------
    OrchestrationError
        If there are more than two, a file cannot be read, a run fails, or the page cannot be written.
    MissingPartError
        If Bokeh is not installed.
    """
    if len(words) > MOST_RUNS:
        msg = f"{len(words)} runs were given; a report is about one run, or compares two."
        raise SystemDescriptionError(msg)
    if len(set(words)) < len(words):
        msg = f"{words[0]} is given twice; name each run once."
        raise SystemDescriptionError(msg)
    if not is_page(out):
        msg = f"{out}: a page has the suffix {PAGE}; 'adaptimp plot' draws pictures."
        raise SystemDescriptionError(msg)
    require("bokeh")
    require_folder(out.parent)
    systems: dict[str, System] = {}
    results: dict[str, Result] = {}
    with watched() as line:
        for word in words:
            label = _label(word, words)
            if Path(word).suffix.lower() in READERS:
                results[label] = Result.read(Path(word))
                continue
            line.begin(f"running {word}")
            systems[label] = SystemRequest(word).system()
            results[label] = _run(systems[label])
            line.end()
        line.begin("writing the page")
        write_page_of(results, systems, out)


def write_page_of(results: Mapping[str, Result], systems: Mapping[str, System], path: Path) -> None:
    """Write the page of runs, and say so.

    Parameters
    ----------
    systems
        Systems that were run, by the label of the run, as far as they are at hand.

    Raises
    ------
    OrchestrationError
        If a result has no rows, or the file cannot be written.
    """
    from orchestration.paper.page.report import report_page, write_page

    existed = path.exists()
    write_page(report_page(results, systems), path)
    output.say(f"{written(path, existed=existed)}, {path.stat().st_size / 1e6:.1f} MB")


def _run(system: System) -> Result:
    """Run a system as ``adaptimp run`` does without options."""
    from orchestration.master.simulate import simulate

    return simulate(system, verdict=True)


def _label(word: str, words: Sequence[str]) -> str:
    """A short name of a run: that of the file without its suffix, where no other run has it."""
    stems = [Path(other).stem for other in words]
    return Path(word).stem if stems.count(Path(word).stem) == 1 else word
