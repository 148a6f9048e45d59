"""Measures the public FMUs and writes docs/interop.md; see the package's docstring."""

import argparse
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console

from tests.interop.matrix.outcomes import Outcomes
from tests.interop.matrix.render import render
from tests.interop.public.outcomes import Entry, measure, read, write
from tests.interop.public.packages import PACKAGES, PackageError
from tests.interop.public.render import cell


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, keep, render; returns the exit code."""
    parser = argparse.ArgumentParser(description="FMUs that packages of PyPI ship.")
    known = {package.name: package for package in PACKAGES}
    parser.add_argument("--package", action="append", choices=list(known), help="a package; may be repeated")
    parser.add_argument("--folder", type=Path, help="a folder that keeps the packages and the FMUs")
    parser.add_argument("--render", action="store_true", help="measure nothing, render what was kept")
    parser.add_argument("--write", type=Path, help="the document; outcomes.json is written with it")
    given = parser.parse_args(arguments)
    console = Console(width=200)

    def tell(entry: Entry) -> None:
        console.print(f"{entry.fmu:32} {entry.interface:10} {entry.check:40} {cell(entry.run)}", highlight=False)

    chosen = [known[name] for name in given.package or known]
    kept = read()
    if not given.render:
        with ExitStack() as stack:
            folder = given.folder or Path(stack.enter_context(TemporaryDirectory(prefix="adaptimp-public-")))
            try:
                found = measure(chosen, folder.resolve(), tell)
            except PackageError as error:
                sys.stderr.write(f"Error: {error}\n")
                return 1
        measured = {package.requirement for package in chosen}
        kept = [entry for entry in kept if entry.package not in measured] + found
    if given.write:
        write(kept)
        given.write.write_text(render(Outcomes.read()), encoding="utf-8", newline="\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
