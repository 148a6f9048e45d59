"""Measures whether the conformance tests notice faults: plants each fault of `mutants` and runs the tests.

    python -m tests.conformance.mutations [--only NAME] [--json FILE]

Every fault gets a copy of the project that knows four FMUs, and a cache of its own that holds their
unchanged binaries. The tests run there until one fails, those that ought to notice first. The copy
without a fault, the control, has to pass all of them. Prints what noticed each fault, and the rate.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console
from rich.markup import escape
from rich.progress import track
from rich.table import Table

from tests.conformance.mutants import GROUPS

ROOT = Path(__file__).parents[2]
CONTROL = "none (the control)"
CAUGHT, SURVIVED, BROKEN = "caught", "survived", "broken"
AT_ONCE = 2
WIDTH = 180  # characters of the table
LONGEST = 600.0  # s; the control takes about 60
MODELS = ("ForceSensor", "CraigAdaptiveImpedance", "Actuator", "Plant")
COPIED = ("adaptimp_fmu", "fmus", "orchestration", "tests/conformance")
COPIED_FILES = (
    *("LICENSE", "pyproject.toml"),
    *(
        f"tests/{name}.py"
        for name in ("__init__", "bytecode", "closing_line", "conftest", "driver", "selection", "sharing", "untested")
    ),
)
NOT_COPIED = shutil.ignore_patterns("__pycache__", "platforms", "sanitizers", "mutations.py", "mutants.py")
# Slow modules last: only faults that the others do not notice get there.
MODULES = tuple(
    f"test_{subject}"
    for subject in (
        *("description", "instantiation_and_logging", "call_order", "steps_and_experiment", "numbers"),
        *("access", "settable", "derivatives", "state", "reference_data"),
        *("container", "documentation", "archive", "ticks", "rebuild"),
    )
)
# What names other units, or needs them all; and the processors, which these faults do not concern.
DESELECTED = (
    "3R",
    "SpongOrtega",
    "VirtualTrajectory",
    "test_every_unit_has_a_reference",
    "test_05_inputs_start_where_the_others_are",
    "test_the_trajectory_follows",
    "test_07_same_definition_on_another_processor",
)
WARM_UP = (
    "from pathlib import Path\nfrom adaptimp_fmu import build\nfrom fmus.catalog import MODELS\n"
    "from tests.conformance.container import write_container\nfolder = Path('warm')\n"
    "for declare in MODELS.values():\n    build(declare(), folder)\nwrite_container(folder, folder)"
)


class MutationError(Exception):
    """The table of faults does not fit the sources."""


@dataclass(frozen=True)
class Mutant:
    """One fault: the file, what is replaced by what, and modules to run first."""

    name: str
    kind: str = ""
    file: str = ""
    old: str = ""
    new: str = ""
    first: tuple[str, ...] = ()


@dataclass(frozen=True)
class Outcome:
    """What became of a fault; `by` is the test that failed, or the end of the output if it is broken."""

    name: str
    kind: str
    file: str
    result: str
    by: str
    seconds: float


def main(arguments: Sequence[str] | None = None) -> int:
    """Plant, run, print and write; returns the exit code, 0."""
    parser = argparse.ArgumentParser(description="Plants faults and counts those that the conformance tests notice.")
    parser.add_argument("--only", help="name of one fault, or a part of several")
    parser.add_argument("--json", type=Path, help="file to write")
    given = parser.parse_args(arguments)
    outcomes = run([mutant for mutant in mutants() if (given.only or "") in mutant.name])
    report(outcomes, Console(width=WIDTH))
    if given.json is not None:
        given.json.write_text(json.dumps([asdict(o) for o in outcomes], indent=2) + "\n", encoding="utf-8")
    return 0


def mutants() -> Iterator[Mutant]:
    """All faults, verified to fit.

    Raises
    ------
    MutationError
        If an old text does not occur exactly once, or two faults have one name.
    """
    seen: set[str] = set()
    for group in GROUPS:
        text = (ROOT / group.package / group.file).read_text(encoding="utf-8")
        for name, (old, new) in group.faults.items():
            if text.count(old) != 1 or name in seen:
                msg = (
                    f'"{name}": its text occurs {text.count(old)} times in {group.file}, or its name twice; once each.'
                )
                raise MutationError(msg)
            seen.add(name)
            yield Mutant(name, group.kind, f"{group.package}/{group.file}", old, new, group.first)


def run(planted: Sequence[Mutant]) -> list[Outcome]:
    """Outcomes of the control, which is the first, and of the faults."""
    with TemporaryDirectory(prefix="mutations-") as name:
        warm = Path(name) / "warm"
        cut_project(warm)
        jobs = [Mutant(CONTROL), *planted]
        with ThreadPoolExecutor(AT_ONCE) as pool:
            outcomes = pool.map(lambda job: outcome(job[1], Path(name) / str(job[0]), warm), enumerate(jobs))
            return list(track(outcomes, total=len(jobs), description="faults", console=Console(stderr=True)))


def outcome(mutant: Mutant, tree: Path, warm: Path) -> Outcome:
    """Plant one fault in a tree of its own, and run the tests until one fails."""
    started = time.monotonic()
    shutil.copytree(warm, tree)
    if mutant.file:
        path = tree / mutant.file
        path.write_text(path.read_text(encoding="utf-8").replace(mutant.old, mutant.new), encoding="utf-8")
    try:
        rest = [module for module in MODULES if module not in mutant.first]
        result, by = judged(pytest(tree, mutant.first)) if mutant.first else (SURVIVED, "")
        if result == SURVIVED:
            result, by = judged(pytest(tree, rest))
    except subprocess.TimeoutExpired:
        result, by = CAUGHT, f"no end within {LONGEST:g} s"
    shutil.rmtree(tree)
    return Outcome(mutant.name, mutant.kind, mutant.file, result, by, round(time.monotonic() - started, 1))


def cut_project(tree: Path) -> None:
    """What the conformance tests need, with the catalog cut to `MODELS`, and a cache of their binaries."""
    for folder in COPIED:
        shutil.copytree(ROOT / folder, tree / folder, ignore=NOT_COPIED)
    for file in COPIED_FILES:
        shutil.copy2(ROOT / file, tree / file)
    with (tree / "fmus" / "catalog.py").open("a", encoding="utf-8") as catalog:
        catalog.write(f"MODELS = {{name: MODELS[name] for name in {MODELS!r}}}\n")
    subprocess.run([sys.executable, "-c", WARM_UP], cwd=tree, env=environment(tree), check=True, capture_output=True)


def environment(tree: Path) -> dict[str, str]:
    """Imports and binaries of this tree only."""
    return os.environ | {"PYTHONPATH": str(tree), "ADAPTIMP_CACHE": str(tree / "cache")}


def pytest(tree: Path, modules: Sequence[str]) -> subprocess.CompletedProcess[str]:
    """Some of the conformance tests in a tree, in the order of their modules, up to the first failure."""
    command = [
        *(sys.executable, "-m", "pytest", "-n0", "-x", "-q", "-p", "no:cacheprovider", "--tb=short"),
        *("--basetemp", str(tree / "scratch"), "-k", f"not ({' or '.join(DESELECTED)})"),
        *(f"tests/conformance/{module}.py" for module in modules),
    ]
    return subprocess.run(
        command, cwd=tree, env=environment(tree), capture_output=True, text=True, timeout=LONGEST, check=False
    )


def judged(ended: subprocess.CompletedProcess[str]) -> tuple[str, str]:
    """The result, and by which test."""
    output = ended.stdout + ended.stderr
    if ended.returncode == 0:
        return SURVIVED, ""
    if ended.returncode < 0:
        crashed = re.search(r"(test_\w+\.py)\", line \d+ in (test_\w+)", output)
        return CAUGHT, f"{crashed[1]}::{crashed[2]} (signal {-ended.returncode})" if crashed else "a crash"
    failed = re.search(r"^(FAILED|ERROR) tests/conformance/(\S+)", ended.stdout, re.MULTILINE)
    # An ERROR in a fixture is a fault that no importer can load, unless `build` refused it: then there was no FMU.
    if ended.returncode != 1 or not failed or (failed[1] == "ERROR" and "in build\n" in output):
        return BROKEN, output[-2000:]
    return CAUGHT, failed[2]


def report(outcomes: Sequence[Outcome], console: Console) -> None:
    """A row for each fault, and the rate of those that were caught."""
    control, faults = outcomes[0], outcomes[1:]
    table = Table("fault", "kind", "file", "result", "by", "s")
    for o in outcomes:
        table.add_row(o.name, o.kind, o.file, o.result, "" if o.result == BROKEN else escape(o.by), f"{o.seconds:.0f}")
    console.print(table)
    for o in outcomes:
        if o.result == BROKEN:
            console.print(f"{o.name} could not be planted:", escape(o.by), sep="\n")
    passed = control.result == SURVIVED
    console.print("The control passes." if passed else "The control FAILS: the results mean nothing.")
    for kind in dict.fromkeys(o.kind for o in faults):
        console.print(f"{kind}: {rate([o for o in faults if o.kind == kind])}")
    console.print(f"all: {rate(faults)}")


def rate(faults: Sequence[Outcome]) -> str:
    """How many of the faults were caught."""
    counts = Counter(o.result for o in faults)
    broken = f", {counts[BROKEN]} broken" if counts[BROKEN] else ""
    return f"{counts[CAUGHT]} of {len(faults)} caught ({counts[CAUGHT] / max(1, len(faults)):.1%}){broken}"


if __name__ == "__main__":
    sys.exit(main())
