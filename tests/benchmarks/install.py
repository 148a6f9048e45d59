"""Measures what an installation from the wheel costs: download, disk, time, and the time to the first figure.

    python -m tests.benchmarks.install [--wheel FILE] [--part PART ...] [--paper] [--json FILE]

Each part is downloaded by pip into an empty folder, and installed from there into a fresh environment, byte code
included. Then ``adaptimp run fig2 --plot`` runs there with an empty cache. Nothing of the checkout is seen there.
"""

import argparse
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

from rich.console import Console
from rich.table import Table

from tests.benchmarks.report import Goal, machine, print_goals, write_json

ROOT = Path(__file__).parents[2]
CORE = "core"
PARTS = (
    CORE,
    "report",
    "files",
    "studies",
    "paper",
    "build",
    "build,cluster,files,paper,report,sensitivity,studies,tuning",
)
DOWNLOAD_LIMIT, DISK_LIMIT, FIGURE_LIMIT = 150.0, 550.0, 60.0  # MB, MB, s; of the core
MB = 1e6
FIGURE = ("run", "fig2", "--plot", "fig2.png")


@dataclass(frozen=True)
class Installation:
    """What an installation costs.

    Attributes
    ----------
    download, disk
        MB.
    download_time, install_time, figure_time
        s. The last is that of the first run, with its picture.
    paper_time
        Time of ``adaptimp paper`` after that, s; None where it was not asked for or is not installed.
    """

    part: str
    download: float
    disk: float
    download_time: float
    install_time: float
    figure_time: float
    paper_time: float | None = None

    @property
    def to_figure(self) -> float:
        """Time from ``pip install`` to the first picture, s."""
        return self.download_time + self.install_time + self.figure_time


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print and write; returns the exit code."""
    parser = argparse.ArgumentParser(description="Cost of an installation.")
    parser.add_argument("--wheel", type=Path, help="wheel to install; built from the checkout by default")
    parser.add_argument("--part", action="append", help=f"extras, or {CORE}; repeatable")
    parser.add_argument("--paper", action="store_true", help="also run adaptimp paper, where it is installed")
    parser.add_argument("--json", type=Path, help="file to write")
    given = parser.parse_args(arguments)
    console = Console()
    with TemporaryDirectory() as place:
        wheel = (given.wheel or built(Path(place))).resolve()
        found = [measured(wheel, part, paper=given.paper) for part in given.part or PARTS]
    result = {"wheel": wheel.stat().st_size / MB, "parts": [asdict(f) for f in found], "machine": machine()}
    result["goals"] = _goals(found)
    _print(result, found, console)
    write_json(given.json, result)
    return 0


def built(folder: Path) -> Path:
    """Build the wheel of the checkout."""
    subprocess.run([os.environ.get("UV", "uv"), "build", "--quiet", "--wheel", "-o", folder], cwd=ROOT, check=True)
    (path,) = folder.glob("*.whl")
    return path


def measured(wheel: Path, part: str, *, paper: bool = False) -> Installation:
    """Install a part in a temporary folder, and run there."""
    wanted = str(wheel) if part == CORE else f"{wheel}[{part}]"
    with TemporaryDirectory() as place:
        folder, packages = Path(place), Path(place) / "packages"
        plain = {name: v for name, v in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL", "UV"))}
        environment = {**plain, "ADAPTIMP_CACHE": f"{place}/cache", "MPLCONFIGDIR": f"{place}/matplotlib"}
        timed([sys.executable, "-m", "venv", "environment"], folder, environment)
        programs = folder / "environment" / ("Scripts" if os.name == "nt" else "bin")
        pip = [str(programs / "python"), "-m", "pip", "--disable-pip-version-check", "--quiet"]
        empty = size(folder / "environment")
        download_time = timed([*pip, "download", "--no-cache-dir", "-d", str(packages), wanted], folder, environment)
        offline = ["--no-index", "--find-links", str(packages)]
        install_time = timed([*pip, "install", *offline, wanted], folder, environment)
        disk = size(folder / "environment") - empty
        adaptimp = str(programs / "adaptimp")
        figure_time = timed([adaptimp, *FIGURE], folder, environment)
        run_paper = paper and "paper" in part
        paper_time = timed([adaptimp, "paper", "-o", "out"], folder, environment) if run_paper else None
        return Installation(part, size(packages) / MB, disk / MB, download_time, install_time, figure_time, paper_time)


def timed(command: Sequence[str], folder: Path, environment: Mapping[str, str]) -> float:
    """Elapsed time of a command that must succeed, s."""
    begun = perf_counter()
    subprocess.run(command, cwd=folder, env=environment, check=True, stdout=subprocess.DEVNULL)
    return perf_counter() - begun


def size(folder: Path) -> int:
    """Bytes of all files in a folder."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file() and not path.is_symlink())


def _goals(found: Sequence[Installation]) -> list[dict[str, Any]]:
    core = next((f for f in found if f.part == CORE), None)
    if core is None:
        return []
    goals = (
        Goal("download of the core, MB", core.download, DOWNLOAD_LIMIT),
        Goal("core on disk, MB", core.disk, DISK_LIMIT),
        Goal("first figure after pip install, s", core.to_figure, FIGURE_LIMIT),
    )
    return [goal.record() for goal in goals]


def _print(result: Mapping[str, Any], found: Sequence[Installation], console: Console) -> None:
    table = Table(title=f"Installations from the wheel, which has {result['wheel']:.1f} MB")
    for name in ("part", "download, MB", "disk, MB", "download, s", "install, s", "first figure, s", "paper, s"):
        table.add_column(name, justify="left" if name == "part" else "right", overflow="fold")
    for f in found:
        numbers = (f.download, f.disk, f.download_time, f.install_time, f.figure_time)
        last = "" if f.paper_time is None else f"{f.paper_time:.0f}"
        table.add_row(f.part, *(f"{number:.0f}" for number in numbers), last)
    console.print(table)
    print_goals(result, console)


if __name__ == "__main__":
    sys.exit(main())
