"""Big systems of one FMU with many variables, wired as chains, rings, stars or at random, to see how costs grow.

A system is given by its number of components, the number of inputs and of outputs of each, and the number of
parameters of each. The FMU (`wide.c`) computes next to nothing, so what is measured is the work of the master.
"""

import random
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from adaptimp_fmu.toolchain import fmi_headers, host_platform
from orchestration.system.system import Component, Connection, System

SOURCE = Path(__file__).with_name("wide.c")
SEED = 7
STEP = 2.0**-10  # s: a power of two, so that k STEP is exact
_FLAGS = 'canGetAndSetFMUstate="true" canHandleVariableCommunicationStepSize="true"'


@dataclass(frozen=True)
class Size:
    """How big a system is: components, inputs (and outputs) of each, parameters of each."""

    components: int
    width: int
    parameters: int = 0

    @property
    def variables(self) -> int:
        """Number of variables of all components."""
        return self.components * (2 * self.width + self.parameters)


def wide_fmu(folder: Path, width: int, parameters: int = 0, *, direct: bool = False) -> Path:
    """Write the FMU with a number of inputs and outputs, and a number of parameters, into a folder.

    Parameters
    ----------
    direct
        Whether outputs depend on inputs at the same instant.
    """
    host = host_platform()
    path = folder / f"Wide{width}x{parameters}{'direct' if direct else ''}.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", description(width, parameters, direct=direct))
        archive.writestr(f"binaries/{host.name}/Wide{host.extension}", _library())
    return path


def description(width: int, parameters: int, *, direct: bool) -> str:
    """The modelDescription.xml; a ring is an algebraic loop if outputs depend on inputs at the same instant."""
    rows = [_variable(f"u[{i + 1}]", i, "input", "continuous", ' start="0"') for i in range(width)]
    rows += [_variable(f"y[{i + 1}]", width + i, "output", "continuous", "") for i in range(width)]
    rows += [_variable(f"p[{i + 1}]", 2 * width + i, "parameter", "fixed", ' start="1"') for i in range(parameters)]
    unknowns = "".join(
        f'<Unknown index="{width + i + 1}" dependencies="{i + 1 if direct else ""}"/>' for i in range(width)
    )
    guid = f"{'direct' if direct else 'wide'}-{width}-{parameters}"
    return (
        '<?xml version="1.0" encoding="UTF-8"?>'
        f'<fmiModelDescription fmiVersion="2.0" modelName="Wide" guid="{guid}">'
        f'<CoSimulation modelIdentifier="Wide" {_FLAGS}/><ModelVariables>{"".join(rows)}</ModelVariables>'
        f"<ModelStructure><Outputs>{unknowns}</Outputs><InitialUnknowns>{unknowns}</InitialUnknowns></ModelStructure>"
        "</fmiModelDescription>"
    )


def _variable(name: str, reference: int, causality: str, variability: str, start: str) -> str:
    kind = f'causality="{causality}" variability="{variability}"'
    return f'<ScalarVariable name="{name}" valueReference="{reference}" {kind}><Real{start}/></ScalarVariable>'


@cache
def _library() -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        output = Path(folder) / f"Wide{host_platform().extension}"
        command = [sys.executable, "-m", "ziglang", "cc", "-shared", "-fPIC", "-O2", "-I", str(fmi_headers())]
        command += ["-DFMI2_FUNCTION_PREFIX=", "-fno-sanitize=all", str(SOURCE), "-o", str(output)]
        subprocess.run(command, check=True, capture_output=True, text=True)
        return output.read_bytes()


def chain(size: Size) -> Iterator[tuple[int, int, int, int]]:
    """Each component drives the next one; the first has no sources."""
    for i in range(1, size.components):
        yield from ((i - 1, j, i, j) for j in range(size.width))


def ring(size: Size) -> Iterator[tuple[int, int, int, int]]:
    """Each component drives the next one, and the last drives the first."""
    for i in range(size.components):
        yield from (((i - 1) % size.components, j, i, j) for j in range(size.width))


def star(size: Size) -> Iterator[tuple[int, int, int, int]]:
    """The first component drives all others."""
    for i in range(1, size.components):
        yield from ((0, j, i, j) for j in range(size.width))


def scattered(size: Size) -> Iterator[tuple[int, int, int, int]]:
    """Every input has a source that is drawn at random."""
    draw = random.Random(SEED)
    for i in range(size.components):
        for j in range(size.width):
            yield draw.randrange(size.components), draw.randrange(size.width), i, j


WIRINGS: dict[str, Callable[[Size], Iterator[tuple[int, int, int, int]]]] = {
    "chain": chain,
    "ring": ring,
    "star": star,
    "scattered": scattered,
}
"""Functions that give source, output, target and input of each connection, as numbers from 0, by name."""


def connections(wiring: str, size: Size) -> tuple[Connection, ...]:
    """The connections of a wiring."""
    return tuple(
        Connection(f"c{source}", f"y[{output + 1}]", f"c{target}", f"u[{input_ + 1}]")
        for source, output, target, input_ in WIRINGS[wiring](size)
    )


def wide_system(fmu: Path, wiring: str, size: Size) -> System:
    """The system of an FMU of `wide_fmu` in a wiring."""
    members = tuple(Component.read(fmu, f"c{i}") for i in range(size.components))
    return System(wiring, members, connections(wiring, size), step=STEP, stop_time=100 * STEP)
