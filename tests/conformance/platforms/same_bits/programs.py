"""What can run a figure: the master, drivers of other platforms' FMUs, and the whole system as one program.

Each program gives the SHA-256 of the rows of a run: little-endian float64, row by row, row 0 first, in every row
all outputs in the order of the components and of their modelDescription.xml.
"""

import hashlib
import platform
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from adaptimp_fmu import host_platform
from orchestration import Component, System, simulate
from orchestration.containers.c.form import write_c
from orchestration.containers.c.program import compiled_files
from orchestration.containers.fmu.write import write_fmu
from orchestration.containers.plan import plan_of
from orchestration.containers.wasm.module import write_wasm
from orchestration.fmi.description import read_description
from tests.conformance.platforms.machines import Machine, MachineUnavailableError, machine, streamed
from tests.conformance.platforms.plan import Plan
from tests.untested import needs

Digest = Callable[[System, int, Path], str]
"""Gives the SHA-256 of the rows of the first steps of a system; the folder is empty and for scratch."""

PLATFORMS = ("linux64", "win64", "aarch64-linux")
"""Those whose binaries run on x86-64 Linux, by itself, in Wine and in qemu."""
PART = 4096  # rows that are turned into bytes at once
OLD_PROCESSOR = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F"}
"""Lets glibc choose the functions that it has for processors without fused multiplication and addition."""
ZIG = (sys.executable, "-m", "ziglang", "cc", "-O2")
GCC = ("gcc", "-O3", "-march=native")
"""Another compiler, which may use all that this processor has, such as fused multiplication and addition."""
NEEDED = ("-std=c11", "-ffp-contract=off")  # as in the Makefile of the C form
MODULE = Path(__file__).with_name("module.mjs")


@dataclass(frozen=True)
class Program:
    """Something that runs systems.

    Attributes
    ----------
    name
        As it is printed; docs/same-bits.md says what it is.
    opened
        Sets the program up and gives its hashes; raises `MachineUnavailableError` if something is missing here.
    """

    name: str
    opened: Callable[[], AbstractContextManager[Digest]]


def plan(system: System, steps: int) -> Plan:
    """The first steps of a system for the C driver."""
    return Plan(system, np.full(steps, system.run_step()), passes=len(system.components))


def sha256(parts: Iterable[bytes]) -> str:
    """Hash of rows that come in parts."""
    found = hashlib.sha256()
    for part in parts:
        found.update(part)
    return found.hexdigest()


@contextmanager
def _master() -> Iterator[Digest]:
    """The compiled master on this machine."""
    yield lambda system, steps, _folder: sha256(_master_rows(system, steps))


def _master_rows(system: System, steps: int) -> Iterator[bytes]:
    result = simulate(system, stop_time=steps * system.run_step())
    columns = [result[name] for name in plan(system, steps).outputs]
    for first in range(0, steps + 1, PART):
        yield np.column_stack([column[first : first + PART] for column in columns]).astype("<f8").tobytes()


@contextmanager
def _driver(name: str, *, whole: bool = False) -> Iterator[Digest]:
    """The C driver with the FMUs of a platform, or with one FMU that is the whole system."""
    with machine(name) as found:
        yield driven(found, whole=whole)


@contextmanager
def _old_processor() -> Iterator[Digest]:
    """The C driver on this machine, with the functions of glibc for old processors."""
    if not sys.platform.startswith("linux") or platform.machine() != "x86_64":
        raise MachineUnavailableError("only glibc on x86-64 has functions for several processors")
    yield driven(Machine(host_platform(), environment=OLD_PROCESSOR))


def driven(found: Machine, *, whole: bool = False) -> Digest:
    """What the C driver gives on a machine with a system's FMUs, or with the whole system as one FMU."""

    def digest(system: System, steps: int, folder: Path) -> str:
        if whole:
            fmu = write_fmu(system, folder / f"{system.name}.fmu", platforms=[found.platform.name])
            system = System(system.name, (Component("whole", read_description(fmu)),), step=system.run_step())
        return sha256(found.rows(plan(system, steps), folder))

    return digest


@contextmanager
def _c_form(compiler: Sequence[str]) -> Iterator[Digest]:
    """The system as a C program of its own, which prints the hash itself."""
    if shutil.which(compiler[0]) is None:
        raise MachineUnavailableError(needs(f"{compiler[0]} is not installed", compiler[0]))
    yield partial(_c_digest, compiler)


def _c_digest(compiler: Sequence[str], system: System, steps: int, folder: Path) -> str:
    written = write_c(system, folder / "c")
    files = ("main.c", *compiled_files(plan_of(system)))
    subprocess.run([*compiler, *NEEDED, *files, "-o", "program.exe"], cwd=written, check=True)
    return _printed([str(written / "program.exe"), "--hash", "--steps", str(steps)], folder)


@contextmanager
def _module() -> Iterator[Digest]:
    """The system as WebAssembly in node."""
    if shutil.which("node") is None:
        raise MachineUnavailableError(needs("node is not installed", "nodejs"))
    yield _module_digest


def _module_digest(system: System, steps: int, folder: Path) -> str:
    written = write_wasm(system, folder / f"{system.name}.wasm")
    return _printed(["node", str(MODULE), str(written), str(steps)], folder)


def _printed(command: Sequence[str], folder: Path) -> str:
    """The hash that a command prints."""
    return b"".join(streamed(command, folder)).decode().strip()


PROGRAMS = (
    Program("master", _master),
    *(Program(name, partial(_driver, name)) for name in PLATFORMS),
    Program("linux64, old processor", _old_processor),
    *(Program(f"{name}, one FMU", partial(_driver, name, whole=True)) for name in PLATFORMS),
    Program("C, zig cc", partial(_c_form, ZIG)),
    Program("C, gcc", partial(_c_form, GCC)),
    Program("wasm", _module),
)
"""In the order in which they are shown; the first one is what the others are compared with."""
