"""Measures how much of the C runtime the tests execute: ``python -m tests.conformance.sanitizers.coverage``.

Runs the tests that call the binaries on FMUs with counters (see `instrument`) and prints lines and
branches of each file of ``adaptimp_fmu/runtime``, all FMUs together: a line counts if any FMU
executed it; a branch (one of the two outcomes of a condition) likewise. Generated ``equations.h``
and ``model.c`` are left out, nothing of the runtime is: failed allocations count as missed. Conditions
that are constant in every FMU (``INPUT_ORDER == 0`` and the like) are counted as missed, too.
"""

import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from adaptimp_fmu.runtime_files import runtime_sources
from tests.conformance.sanitizers.compiling import missing

ROOT = Path(__file__).parents[3]
PLUGIN = "tests.conformance.sanitizers.instrument"
TESTS = (
    *(f"tests/conformance/test_{name}.py" for name in ("instantiation_and_logging", "call_order", "events")),
    *(f"tests/conformance/test_{name}.py" for name in ("steps_and_experiment", "numbers", "settable")),
    *(f"tests/conformance/test_{name}.py" for name in ("state", "ticks", "derivatives")),
    "tests/conformance/sanitizers/test_refusals.py",
)
LINES, BRANCHES = 0.95, 0.85  # goals of issue 4

Line = int
Place = tuple[int, int, int, int, bool]  # of a condition: first line and column, last ones; outcome


@dataclass
class Counts:
    """Executions in one file."""

    lines: Counter[Line] = field(default_factory=Counter)
    branches: Counter[Place] = field(default_factory=Counter)


def measure(folder: Path, tests: tuple[str, ...] = TESTS) -> dict[str, Counts]:
    """Run the tests and add up what all FMUs executed, by file of the runtime.

    Raises
    ------
    RuntimeError
        If a test fails: its coverage would mean nothing.
    """
    profiles, cache = folder / "profiles", folder / "cache"
    environment = os.environ | {"ADAPTIMP_CACHE": str(cache), "LLVM_PROFILE_FILE": f"{profiles}/%m-%p.profraw"}
    command = [sys.executable, "-m", "pytest", "-q", "-p", PLUGIN, *tests]
    run = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise RuntimeError(f"The tests failed:\n{run.stdout[-6000:]}{run.stderr[-2000:]}")
    merged = folder / "all.profdata"
    llvm("llvm-profdata", "merge", "-o", str(merged), *map(str, sorted(profiles.glob("*.profraw"))))
    counts = {name: Counts() for name in runtime_sources() if name.endswith(".c") or name == "philox.h"}
    for library in sorted(cache.glob("binaries/*/*/*.so")):
        for name, lines in lines_of(library, merged):
            if name in counts:
                counts[name].lines.update(lines)
        for name, branches in branches_of(library, merged):
            if name in counts:
                counts[name].branches.update(branches)
    return counts


def lines_of(library: Path, profile: Path) -> Iterator[tuple[str, Counter[Line]]]:
    """Executions of each line, by file, of one library."""
    name, lines = "", Counter[Line]()
    for record in export(library, profile, "lcov").splitlines():
        kind, _, rest = record.partition(":")
        if kind == "SF":
            name, lines = Path(rest).name, Counter()
        elif kind == "DA":
            line, count = map(int, rest.split(","))
            lines[line] += count
        elif kind == "end_of_record":
            yield name, lines


def branches_of(library: Path, profile: Path) -> Iterator[tuple[str, Counter[Place]]]:
    """Outcomes of each condition, by file, of one library; macros where they are defined."""
    for file in json.loads(export(library, profile, "text"))["data"][0]["files"]:
        branches = Counter[Place]()
        for *place, true, false, _, _, _ in file["branches"]:
            branches[(*place, True)] += true
            branches[(*place, False)] += false
        yield Path(file["filename"]).name, branches


def export(library: Path, profile: Path, form: str) -> str:
    """llvm-cov's report in a machine's form."""
    return llvm("llvm-cov", "export", str(library), f"-instr-profile={profile}", f"-format={form}")


def llvm(tool: str, *arguments: str) -> str:
    """Output of a tool of clang's own LLVM; messages of each are left out."""
    found = subprocess.run(["clang", f"--print-prog-name={tool}"], capture_output=True, text=True, check=True)
    run = subprocess.run([found.stdout.strip(), *arguments], capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise RuntimeError(f"{tool} {arguments[0]} (Debian: llvm-14): {run.stderr}")
    return run.stdout


def share(counter: Counter) -> tuple[int, int]:
    """How many entries were executed, and how many there are."""
    return sum(count > 0 for count in counter.values()), len(counter)


def table(counts: dict[str, Counts]) -> tuple[str, float, float]:
    """A table with the missed lines and branches, and both shares of the total."""
    total = {"lines": [0, 0], "branches": [0, 0]}
    rows = [f"{'file':<14}{'lines':>12}{'':>8}{'branches':>12}{'':>8}  missed (lines; branches at line:column)"]
    for name, file in sorted(counts.items()):
        cells = ""
        for key, counter in (("lines", file.lines), ("branches", file.branches)):
            hit, n = share(counter)
            total[key][0] += hit
            total[key][1] += n
            cells += _cell(hit, n)
        lines = ", ".join(str(line) for line, count in sorted(file.lines.items()) if not count)
        missed = sorted(place for place, count in file.branches.items() if not count)
        branches = ", ".join(f"{place[0]}:{place[1]} {'true' if place[4] else 'false'}" for place in missed)
        rows.append(f"{name:<14}{cells}  {lines}; {branches}".rstrip("; "))
    rows.append(f"{'all':<14}{_cell(*total['lines'])}{_cell(*total['branches'])}")
    lines, branches = (hit / n for hit, n in total.values())
    return "\n".join(rows), lines, branches


def _cell(hit: int, n: int) -> str:
    """`hit/n` and percent, in 20 columns."""
    return f"{f'{hit}/{n}':>12}{f'{100 * hit / n:.1f} %' if n else '-':>8}"


def main() -> int:
    """Print the table; 1 if a goal is missed."""
    reason = missing()
    if reason:
        sys.stderr.write(f"{reason}\n")
        return 1
    with tempfile.TemporaryDirectory(prefix="adaptimp-coverage-") as folder:
        text, lines, branches = table(measure(Path(folder)))
    sys.stdout.write(f"{text}\n")
    return int(lines < LINES or branches < BRANCHES)


if __name__ == "__main__":
    sys.exit(main())
