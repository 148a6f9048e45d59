"""Measures and writes ``docs/interop.md``; see the package's docstring."""

import argparse
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console

from tests.interop.matrix.compare import Verdict
from tests.interop.matrix.jobs import SYSTEMS, UNITS, built
from tests.interop.matrix.outcomes import Outcomes, measure
from tests.interop.matrix.render import render
from tests.interop.matrix.tools import KEYS


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, keep, render; returns the exit code."""
    parser = argparse.ArgumentParser(description="Our FMUs and packages in other tools.")
    parser.add_argument("--only", action="append", choices=KEYS, help="a tool; may be repeated")
    parser.add_argument(
        "--job", action="append", choices=(*UNITS, *SYSTEMS), help="an FMU or a figure; may be repeated"
    )
    parser.add_argument("--steps", type=int, help="steps of a figure, if not all")
    parser.add_argument("--render", action="store_true", help="measure nothing, render what was kept")
    parser.add_argument("--write", type=Path, help="the document; outcomes.json is written with it")
    given = parser.parse_args(arguments)
    console = Console()

    def tell(tool: str, job: str, verdict: Verdict) -> None:
        console.print(f"{tool:16} {job:28} {verdict.kind} {verdict.distance:.0e} {verdict.detail}", highlight=False)

    kept = Outcomes.read()
    if not given.render:
        with TemporaryDirectory() as folder:
            jobs = given.job or (*UNITS, *SYSTEMS)
            files = built(Path(folder))
            found = measure(given.only or KEYS, jobs, files, Path(folder), n_steps=given.steps, tell=tell)
        kept = kept.updated(found)
    if given.write:
        kept.write()
        given.write.write_text(render(kept), encoding="utf-8", newline="\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
