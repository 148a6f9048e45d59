"""FMUs that are wrong in one way each: descriptions of ours edited, and small binaries that misbehave."""

import functools
import re
import subprocess
import sys
import time
import warnings
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path

from adaptimp_fmu.toolchain import fmi_headers, host_platform
from orchestration import check as general
from orchestration.check import Report, Severity
from orchestration.check.dynamic.supervision import TIMEOUT
from orchestration.paper.closed_loop import Loop, in_loop
from orchestration.paper.roles import ROLES, role_named

PATIENT = 600.0  # s that `check` waits for FMUs that do not hang; they need a fraction of a second
DESCRIPTION = "modelDescription.xml"
SOURCE = Path(__file__).with_name("misbehaving.c")
Edit = Callable[[str], str]
FLAGS = 'canGetAndSetFMUstate="true" canSerializeFMUstate="true" providesDirectionalDerivative="true"'
MISBEHAVING = f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Misbehaving" guid="{{misbehaving}}-FAULT">
  <CoSimulation modelIdentifier="Misbehaving" canHandleVariableCommunicationStepSize="true" {FLAGS}/>
  <DefaultExperiment startTime="0" stopTime="10" stepSize="0.5"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="0" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="1" causality="output" variability="discrete"><Real/></ScalarVariable>
    <ScalarVariable name="p" valueReference="2" causality="parameter" variability="fixed">
      <Real start="1.5"/>
    </ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="2" dependencies="1"/></Outputs>
    <InitialUnknowns><Unknown index="2" dependencies="1"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""


@functools.cache
def hasty() -> float:
    """Time that `check` may wait for an FMU that hangs, s: ten times what a worker needs to start here and now."""
    started = time.monotonic()
    subprocess.run([sys.executable, "-c", "import orchestration.check.dynamic.experiments"], check=True)
    return round(max(1.5, 10 * (time.monotonic() - started)), 1)


def check(
    path: Path,
    role: str | None = None,
    *,
    mapping: Mapping[str, str] | None = None,
    loop: Callable[[int, int], Loop | None] | None = None,
    timeout: float = TIMEOUT,
) -> Report:
    """A check with the paper's roles and, if it is given, a loop, as the command line makes it."""
    wanted = ROLES.values() if role is None else role_named(role)
    trial = None if loop is None else in_loop(loop)
    return general.check(path, wanted, mapping=mapping, trial=trial, timeout=timeout)


def compiled(folder: Path, name: str, *flags: str) -> Path:
    """The library of the misbehaving FMU."""
    host = host_platform()
    output = folder / f"{name}{host.extension}"
    includes = ("-I", str(fmi_headers()), "-DFMI2_FUNCTION_PREFIX=", "-fno-sanitize=all")
    command = [sys.executable, "-m", "ziglang", "cc", "-shared", "-fPIC", "-O1", *includes, *flags]
    subprocess.run([*command, str(SOURCE), "-o", str(output), "-lm"], check=True, capture_output=True, text=True)
    return output


def misbehaving(library: Path, path: Path, fault: str, edit: Edit = lambda xml: xml) -> Path:
    """An FMU whose binary does what `fault` says."""
    host = host_platform()
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(DESCRIPTION, edit(MISBEHAVING.replace("FAULT", fault)))
        archive.write(library, f"binaries/{host.name}/Misbehaving{host.extension}")
    return path


def edited(fmu: Path, folder: Path, edit: Edit) -> Path:
    """A copy of an FMU with its description changed."""
    with zipfile.ZipFile(fmu) as archive:
        before = archive.read(DESCRIPTION).decode()
    after = edit(before)
    assert after != before, "the edit changes nothing"
    return repacked(fmu, folder, {DESCRIPTION: after.encode()})


def repacked(fmu: Path, folder: Path, changes: Mapping[str, bytes | None]) -> Path:
    """A copy of an FMU with entries changed, added, or, for None, left out."""
    copy = folder / fmu.name
    with warnings.catch_warnings(), zipfile.ZipFile(fmu) as old, zipfile.ZipFile(copy, "w") as new:
        warnings.simplefilter("ignore")
        for entry in old.namelist():
            content = changes.get(entry, old.read(entry))
            if content is not None:
                new.writestr(entry, content)
        for entry, content in changes.items():
            if content is not None and entry not in old.namelist():
                new.writestr(entry, content)
    return copy


def swap(old: str, new: str) -> Edit:
    """An edit of the first match of a pattern."""
    return lambda xml: re.sub(old, new, xml, count=1, flags=re.DOTALL)


def assert_found(report: Report, rule: str, severity: Severity, pattern: str) -> None:
    """A report has a finding, and is JSON."""
    found = [f for f in report.findings if (f.rule, f.severity) == (rule, severity) and re.search(pattern, f.message)]
    assert found, [f"{f.rule} {f.severity} {f.message}" for f in report.findings]
    assert report.failed == (report.count(Severity.ERROR) > 0)
    assert f'"rule": "{rule}"' in report.json()
