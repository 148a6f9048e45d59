"""Cost of the FMUs of the PUMA 560: a step of 1e-4 s, a cold build for all platforms, and the size of the binaries.

    uv run python -m tests.benchmarks.spatial_units

A step's time is that of `tests.benchmarks.spatial_controllers`. A plant's step has four derivatives of Runge-Kutta's
method, besides events and outputs; so a derivative costs less than a quarter of it. A build is one into an empty cache,
and its time that of the processors, which other programs do not change.
"""

import resource
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from zipfile import ZipFile

from adaptimp_fmu import build
from adaptimp_fmu.toolchain import PLATFORMS
from fmus.catalog import VARIANTS, model
from tests.benchmarks.spatial_controllers import microseconds

UNITS = tuple(name for name in VARIANTS if name.endswith("Puma560"))
TICK_LIMIT, DERIVATIVE_LIMIT, BUILD_LIMIT, BINARY_LIMIT = 10.0, 3.0, 90.0, 1e6  # us, us, s and bytes, for six joints
STAGES = 4  # derivatives in a step of the plant


@dataclass(frozen=True)
class Cost:
    """Cost of an FMU.

    Attributes
    ----------
    step
        Time of a step of 1e-4 s, us.
    building
        Processor time of a cold build for all platforms, s.
    largest
        Size of the largest binary, bytes.
    """

    step: float
    building: float
    largest: int

    def exceeded(self, name: str) -> list[str]:
        """Limits that the cost of an FMU of this name exceeds."""
        allowed = STAGES * DERIVATIVE_LIMIT if name.startswith("Plant") else TICK_LIMIT
        checks = (
            ("step", self.step, allowed, "us"),
            ("build", self.building, BUILD_LIMIT, "s"),
            ("binary", self.largest, BINARY_LIMIT, "bytes"),
        )
        return [f"{what} {found:.4g} {unit}, above {most:.4g}" for what, found, most, unit in checks if found > most]


def cost(name: str) -> Cost:
    """Measure an FMU of the catalog by its name."""
    with TemporaryDirectory(prefix="benchmark-", ignore_cleanup_errors=True) as folder:
        begin = _seconds()
        fmu = build(model(name), Path(folder), PLATFORMS.values(), cache=Path(folder) / "cache")
        building = _seconds() - begin
        with ZipFile(fmu) as archive:
            sizes = [entry.file_size for entry in archive.infolist() if entry.filename.startswith("binaries/")]
    return Cost(microseconds(model(name)), building, max(sizes))


def _seconds() -> float:
    """Processor time of this process and of those that it waited for, s."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return process_time() + children.ru_utime + children.ru_stime


def main(names: list[str]) -> int:
    """Print a table of FMUs and what exceeds a limit; returns 1 if anything does."""
    sys.stdout.write("| FMU | step of 1e-4 s | cold build, five platforms | largest binary |\n|---|---|---|---|\n")
    wrong = []
    for name in names:
        found = cost(name)
        row = f"{found.step:.2f} us | {found.building:.0f} s | {found.largest / 1000:.0f} kB"
        sys.stdout.write(f"| {name} | {row} |\n")
        sys.stdout.flush()
        wrong += [f"{name}: {text}\n" for text in found.exceeded(name)]
    sys.stdout.writelines(wrong)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:] or list(UNITS)))
