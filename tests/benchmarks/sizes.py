"""Sizes of a system as one program: module, binaries, state and stack, in bytes."""

import re
import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path
from zipfile import ZipFile

from orchestration.containers.c.form import write_c
from orchestration.containers.fmu.write import write_fmu
from orchestration.containers.wasm.module import write_wasm
from orchestration.system.system import System

MODULE_LIMIT, BINARY_LIMIT = 150_000, 400_000
_SAID = re.compile(r"^(\d+) bytes (in \w+_System|of stack at the most)$", re.MULTILINE)


def sizes(system: System, folder: Path, platforms: Iterable[str]) -> dict[str, int]:
    """Bytes of each form of a system by what they are; writes the forms into a folder.

    Parameters
    ----------
    platforms
        Platforms whose binary of the FMU is measured, unpacked.

    Returns
    -------
    dict
        ``wasm``, each platform, and ``state`` and ``stack`` as the C form's Makefile tells with gcc; these two are
        missing where there is no gcc or no make.
    """
    found = {"wasm": write_wasm(system, folder / "size.wasm").stat().st_size}
    with ZipFile(write_fmu(system, folder / "size.fmu", platforms=platforms)) as archive:
        for entry in archive.infolist():
            if entry.filename.startswith("binaries/"):
                found[entry.filename.split("/")[1]] = entry.file_size
    return found | _memory(write_c(system, folder / "size"))


def _memory(folder: Path) -> dict[str, int]:
    """What the Makefile of a C form says of its memory."""
    if not shutil.which("make") or not shutil.which("gcc"):
        return {}
    run = subprocess.run(["make", "CC=gcc"], cwd=folder, capture_output=True, text=True, check=True)
    said = {what: int(count) for count, what in _SAID.findall(run.stdout)}
    return {("stack" if what.startswith("of stack") else "state"): count for what, count in said.items()}
