"""What can run a figure: the master, drivers of other platforms' FMUs, and the whole system as one program.

Each program gives the rows of a run as bytes: little-endian float64, row by row, row 0 first, in every row
all outputs in the order of the components and of their modelDescription.xml.
"""

import platform
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from adaptimp_fmu import host_platform
from adaptimp_fmu.toolchain import FLAGS
from orchestration import Component, System, simulate
from orchestration.containers.c_program import c_sources, compiled_files
from orchestration.containers.fmu import write_fmu
from orchestration.containers.plan import plan_of
from orchestration.fmi.description import read_description
from tests.conformance.platforms.machines import Machine, MachineUnavailableError, machine, streamed
from tests.conformance.platforms.plan import Plan

Rows = Callable[[System, int, Path], Iterator[bytes]]
"""Gives the rows of the first steps of a system; the folder is empty and for scratch."""

CONTAINER = Path(__file__).with_name("container.c")
PLATFORMS = ("linux64", "win64", "aarch64-linux")
"""Those whose binaries run on x86-64 Linux, by itself, in Wine and in qemu."""
PART = 4096  # rows that are turned into bytes at once
OLD_PROCESSOR = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F"}
"""Lets glibc choose the functions that it has for processors without fused multiplication and addition."""


@dataclass(frozen=True)
class Program:
    """Something that runs systems.

    Attributes
    ----------
    name
        As it is printed; docs/same-bits.md says what it is.
    opened
        Sets the program up and gives its rows; raises `MachineUnavailableError` if something is missing here.
    """

    name: str
    opened: Callable[[], AbstractContextManager[Rows]]


def plan(system: System, steps: int) -> Plan:
    """The first steps of a system for the C driver."""
    return Plan(system, np.full(steps, system.run_step()), passes=len(system.components))


@contextmanager
def _master() -> Iterator[Rows]:
    """The compiled master on this machine."""
    yield _master_rows


def _master_rows(system: System, steps: int, _folder: Path) -> Iterator[bytes]:
    result = simulate(system, stop_time=steps * system.run_step())
    columns = [result[name] for name in plan(system, steps).outputs]
    for first in range(0, steps + 1, PART):
        yield np.column_stack([column[first : first + PART] for column in columns]).astype("<f8").tobytes()


@contextmanager
def _driver(name: str) -> Iterator[Rows]:
    """The C driver with the FMUs of a platform."""
    with machine(name) as found:
        yield driven(found)


@contextmanager
def _old_processor() -> Iterator[Rows]:
    """The C driver on this machine, with the functions of glibc for old processors."""
    if not sys.platform.startswith("linux") or platform.machine() != "x86_64":
        raise MachineUnavailableError("only glibc on x86-64 has functions for several processors")
    yield driven(Machine(host_platform(), environment=OLD_PROCESSOR))


@contextmanager
def _one_fmu(name: str) -> Iterator[Rows]:
    """The C driver with one FMU, which is the whole system."""
    with machine(name) as found:
        yield driven(found, whole=True)


def driven(found: Machine, *, whole: bool = False) -> Rows:
    """What the C driver gives on a machine with a system's FMUs, or with the whole system as one FMU."""

    def rows(system: System, steps: int, folder: Path) -> Iterator[bytes]:
        if whole:
            fmu = write_fmu(system, folder / f"{system.name}.fmu", platforms=[found.platform.name])
            system = System(system.name, (Component("whole", read_description(fmu)),), step=system.run_step())
        return found.rows(plan(system, steps), folder)

    return rows


@contextmanager
def _c_form() -> Iterator[Rows]:
    """The system as one C program on this machine."""
    yield _c_rows


def _c_rows(system: System, steps: int, folder: Path) -> Iterator[bytes]:
    program = plan_of(system)
    for name, text in c_sources(program).items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    target = host_platform().target
    command = [
        *(sys.executable, "-m", "ziglang", "cc", "-target", target, *FLAGS, f"-DSYSTEM={program.identifier}"),
        *("-I", ".", str(CONTAINER), *compiled_files(program), "-o", "container.exe"),
    ]
    subprocess.run(command, cwd=folder, check=True)
    yield from streamed([str(folder / "container.exe"), str(steps)], folder)


PROGRAMS = (
    Program("master", _master),
    *(Program(name, partial(_driver, name)) for name in PLATFORMS),
    Program("linux64, old processor", _old_processor),
    *(Program(f"{name}, one FMU", partial(_one_fmu, name)) for name in PLATFORMS),
    Program("C", _c_form),
)
"""In the order in which they are shown; the first one is what the others are compared with."""
