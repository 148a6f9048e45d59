"""Adapter for ecos through its program, which the wheel of ecospy holds."""

import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory
from zipfile import ZipFile

import numpy as np

from tests.interop.matrix.protocol import FMU, SYSTEM, Job, Record, Tool, ToolError

TOOL = Tool("ecos_cli", "ecos CLI", "ecospy", (FMU, SYSTEM), "a scenario file with an action per step")
_NAMESPACE = "http://github.com/Ecos-platform/libecos/resources/schema/ScenarioConfig"
_KINDS = {"Real": "real", "Integer": "integer", "Boolean": "boolean"}
RESOLUTION = 5e-7  # its files have six decimals


def run(job: Job) -> Record:
    """``ecos simulate`` on an SSP package, one parameter set named."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        command = [str(_program(folder)), "simulate", "--path", job.ssp, "--stepSize", repr(job.step), "--noParallel"]
        command += ["--stopTime", repr((job.n_steps + 0.5) * job.step), "--logLevel", "warn"]
        if sets := _parameter_sets(Path(job.ssp)):
            command += ["--parameterSet", sets.pop()]
        if job.stimulus:
            command += ["--scenarioConfig", str(_scenario(job, folder))]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        files = sorted(folder.glob("*.csv"))
        if done.returncode != 0 or not files:
            raise ToolError(done.stderr.strip() or done.stdout.strip() or f"exit code {done.returncode}")
        return _read(job, files[0])


def _program(folder: Path) -> Path:
    """A copy that may be executed: the wheel's own may not."""
    import ecospy

    program = folder / "ecos"
    shutil.copy(Path(ecospy.__file__).parent / "binaries" / "ecos", program)
    program.chmod(0o755)
    return program


def _parameter_sets(ssp: Path) -> set[str]:
    """Names of the package's parameter sets."""
    import xml.etree.ElementTree as ET

    with ZipFile(ssp) as package:
        return {
            ET.fromstring(package.read(name)).attrib["name"] for name in package.namelist() if name.endswith(".ssv")
        }


def _scenario(job: Job, folder: Path) -> Path:
    """The stimulus from step 1 on; an action acts at the step whose summed time is its own to some 1e-6 s."""
    lines = [f'<ecos:Scenario xmlns:ecos="{_NAMESPACE}">']
    for k in range(1, job.n_steps + 1):
        lines.append(f'<ecos:action t="{k * job.step!r}">')
        for path, values in job.stimulus.items():
            part, name = job.split(path)
            kind, text = _KINDS[part.types[name]], str(part.value(name, values[k])).lower()
            lines.append(f'<ecos:variable id="{part.name}::{name}"><ecos:{kind} value="{text}"/></ecos:variable>')
        lines.append("</ecos:action>")
    file = folder / "scenario.xml"
    file.write_text("\n".join([*lines, "</ecos:Scenario>"]), encoding="utf-8")
    return file


def _read(job: Job, file: Path) -> Record:
    """The columns of its file, such as ``plant::q[1][REAL]``."""
    with file.open(encoding="utf-8") as lines:
        head = [name.strip().rpartition("[")[0].replace("::", ".", 1) for name in next(lines).split(",")]
    columns = tuple(name for name in job.columns if name in head)
    where = [head.index(name) for name in columns]
    values = np.loadtxt(file, delimiter=",", skiprows=1, usecols=where, converters=_number, ndmin=2, encoding="utf-8")
    return Record(values[: job.n_steps + 1], columns, resolution=RESOLUTION)


def _number(text: str) -> float:
    """A number, or 1 and 0 for true and false."""
    return float({"true": "1", "false": "0"}.get(text.strip(), text))
