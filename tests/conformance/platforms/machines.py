"""Runs the programs of a platform on this machine: by the processor itself, Wine, or qemu's user mode."""

import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from adaptimp_fmu import host_platform
from adaptimp_fmu.toolchain import PLATFORMS, Platform, fmi_headers
from tests.conformance.platforms.plan import Plan
from tests.untested import needs

DRIVER = Path(__file__).with_name("driver.c")
PART = 2**16  # bytes of output that are read at once
# Where Debian's packages put them: wine64 (not on the search path), libc6-arm64-cross.
WINE_FOLDER = Path("/usr/lib/wine")
ARM_LIBRARIES = Path("/usr/aarch64-linux-gnu")
# No messages of its own, no window, nothing installed besides, no entries in the desktop's menu.
_QUIET = {"WINEDEBUG": "-all", "DISPLAY": "", "WINEDLLOVERRIDES": "mscoree,mshtml,winemenubuilder.exe="}


class MachineUnavailableError(Exception):
    """Nothing here runs a platform's programs; the text says what is missing."""


@dataclass(frozen=True)
class Machine:
    """Runs programs of one platform.

    Attributes
    ----------
    launcher
        Command to put before the program's name.
    environment
        Environment variables that it needs.
    """

    platform: Platform
    launcher: tuple[str, ...] = ()
    environment: Mapping[str, str] = field(default_factory=dict)

    def run(self, plan: Plan, folder: Path) -> dict[str, np.ndarray]:
        """Run the plan in an empty folder, and return its outputs; the errors are those of `rows`."""
        return plan.outputs_in(b"".join(self.rows(plan, folder)))

    def rows(self, plan: Plan, folder: Path) -> Iterator[bytes]:
        """Compile the driver, run the plan in an empty folder, and yield its rows as they are made, cut anywhere.

        Raises
        ------
        RuntimeError
            With what the driver said, if it fails.
        """
        windows = self.platform.extension == ".dll"
        program = compile_driver(self.platform, folder)
        plan.numbers().tofile(folder / "plan")
        arguments = []
        for component in plan.system.components:
            unit = component.description
            library = f"{unit.identifier}{self.platform.extension}"
            with zipfile.ZipFile(unit.path) as archive:
                (folder / library).write_bytes(archive.read(f"binaries/{self.platform.name}/{library}"))
            arguments += [component.name, library if windows else f"./{library}", unit.guid]
        name = program.name if windows else f"./{program.name}"
        yield from streamed([*self.launcher, name, "plan", *arguments], folder, self.environment)


def streamed(command: Sequence[str], folder: Path, environment: Mapping[str, str] | None = None) -> Iterator[bytes]:
    """Run a command in a folder; yield its standard output as it comes.

    Parameters
    ----------
    environment
        Environment variables besides those of this process.

    Raises
    ------
    RuntimeError
        If the command fails or says something, with what is in its standard error.
    """
    log, variables = folder / "log", os.environ | (environment or {})
    with log.open("wb") as errors:
        process = subprocess.Popen(command, cwd=folder, env=variables, stdout=subprocess.PIPE, stderr=errors)
        with process:
            assert process.stdout is not None
            while part := process.stdout.read(PART):
                yield part
    said = log.read_text(encoding="utf-8", errors="replace")
    if process.returncode != 0 or said:
        raise RuntimeError(f"{command[0]}: exit code {process.returncode}: {said[-2000:]}")


def compile_driver(platform: Platform, folder: Path) -> Path:
    """Compile driver.c for a platform."""
    program = folder / ("driver.exe" if platform.extension == ".dll" else "driver")
    command = (sys.executable, "-m", "ziglang", "cc", "-target", platform.target)
    flags = ("-std=c11", "-O1", "-fno-sanitize=all", "-s", "-Wall", "-Wextra", "-Werror")
    files = ("-I", str(fmi_headers()), str(DRIVER), "-o", str(program))
    subprocess.run([*command, *flags, *files], check=True, cwd=folder)
    return program


@contextmanager
def machine(name: str) -> Iterator[Machine]:
    """What runs programs of a platform here.

    Raises
    ------
    MachineUnavailableError
    """
    platform = PLATFORMS[name]
    if platform == host_platform():
        yield Machine(platform)
    elif name == "win64":
        with _wine() as found:
            yield found
    elif name == "aarch64-linux":
        qemu = shutil.which("qemu-aarch64")
        if qemu is None or not ARM_LIBRARIES.is_dir():
            raise MachineUnavailableError(
                needs("qemu and ARM libraries are not here", "qemu-user", "libc6-arm64-cross")
            )
        yield Machine(platform, (qemu, "-L", str(ARM_LIBRARIES)))
    else:
        raise MachineUnavailableError(f"nothing runs programs of {name} here")


@contextmanager
def _wine() -> Iterator[Machine]:
    """Wine with a folder of its own, some 700 MB that are removed at the end; needs 10 s to fill it."""
    search = os.pathsep.join([os.environ.get("PATH", ""), str(WINE_FOLDER)])
    wine, server = (shutil.which(f"{n}64", path=search) or shutil.which(n) for n in ("wine", "wineserver"))
    if not sys.platform.startswith("linux") or wine is None or server is None:
        raise MachineUnavailableError(needs("Wine for 64-bit programs is not here", "wine64"))
    with tempfile.TemporaryDirectory(prefix="adaptimp-wine-") as folder:
        environment = {name: folder for name in ("WINEPREFIX", "TMPDIR", "HOME")} | _QUIET
        start = [wine, "wineboot", "--init"]
        try:
            subprocess.run(start, env=os.environ | environment, check=True, capture_output=True)
            yield Machine(PLATFORMS["win64"], (wine,), environment)
        finally:  # only the server of this folder
            subprocess.run([server, "-k", "-w"], env=os.environ | environment, check=False)
