"""Writes a system as one FMU for co-simulation (FMI 2.0), which any tool runs and which holds its sources.

    NAME.fmu
      modelDescription.xml   model.png   documentation/   terminalsAndIcons/
      binaries/PLATFORM/     one library, compiled from the sources
      sources/step.c ...     the system in C, as `orchestration.containers.c.program` writes it
      sources/fmi/           the FMI functions: the layer of the runtime that all FMUs of this project have

Same system, same bytes: the GUID is a hash of the description and the sources.
"""

import hashlib
import re
import uuid
from collections.abc import Iterable, Mapping
from pathlib import Path

from adaptimp_fmu.binary import binary
from adaptimp_fmu.codegen import GUID_PLACEHOLDER
from adaptimp_fmu.errors import ToolchainError
from adaptimp_fmu.files.whole_file import write_whole
from adaptimp_fmu.package import archive
from adaptimp_fmu.runtime_files import RUNTIME_LICENSE, runtime_license, runtime_sources
from adaptimp_fmu.terminals import TERMINALS_FILE, Terminal, terminals_and_icons
from adaptimp_fmu.toolchain import PLATFORMS, Platform, host_platform
from orchestration.containers.c.program import c_sources, compiled_files
from orchestration.containers.c_text import environment
from orchestration.containers.contained.contained_fmu import document_of
from orchestration.containers.fmu.description import container_description
from orchestration.containers.fmu.documentation import container_documentation
from orchestration.containers.fmu.icon import container_icon
from orchestration.containers.plan import FIXED, GAUSS_SEIDEL, INPUT, OUTPUT, TUNABLE, Plan, ProgramVariable, plan_of
from orchestration.errors import ContainerError
from orchestration.fmi.given import a_path
from orchestration.fmi.names import suggestion
from orchestration.master.algorithm import Algorithm
from orchestration.system.system import System

LAYER = "fmi"
"""Folder below ``sources/`` of the files that implement FMI's functions."""
MAIN = f"{LAYER}/model.c"
ALL_PLATFORMS = "all"
_RUNTIME = "runtime_container.c"
"""File of the runtime that includes all that a container needs."""
_INCLUDED = re.compile(r'^#include "([^"]+)"', re.MULTILINE)


def write_fmu(
    system: System,
    path: str | Path,
    *,
    platforms: Iterable[str] | None = None,
    algorithm: str | Algorithm = GAUSS_SEIDEL,
) -> Path:
    """Write a system as one FMU for co-simulation.

    Parameters
    ----------
    system
        System of FMUs that bring their sources, with its step.
    path
        File to write, ``NAME.fmu``.
    platforms
        Names of the platforms with a binary in the FMU, or ``"all"`` among them. Default: this machine's.
    algorithm
        ``"gauss-seidel"`` or ``"jacobi"``; see `orchestration.simulate`.

    Returns
    -------
    Path
        The file. It is only written when its content changes.

    Raises
    ------
    ContainerError
        If the system cannot be a program, a platform is unknown, or the compiler refuses the sources.
    ArchiveError
        If an FMU cannot be read.
    """
    file = a_path("A container's file", path)
    chosen = _platforms(platforms)
    plan = plan_of(system, algorithm)
    entries = _entries(plan)
    sources = {name.removeprefix("sources/"): text for name, text in entries.items() if name.startswith("sources/")}
    compiled = [*compiled_files(plan), MAIN]
    texts = {name: content.decode("utf-8", "surrogateescape") for name, content in sources.items()}
    for platform in chosen:
        library = f"binaries/{platform.name}/{plan.identifier}{platform.extension}"
        entries[library] = _compiled(plan, texts, platform, compiled)
    content = archive(entries)
    try:
        if not file.exists() or file.read_bytes() != content:
            write_whole(file, content)
    except OSError as error:
        msg = f"{file}: the FMU cannot be written: {error.strerror}; choose another place."
        raise ContainerError(msg) from error
    return file


def _platforms(names: Iterable[str] | None) -> list[Platform]:
    try:
        asked = [host_platform().name] if names is None else list(dict.fromkeys(names))
    except ToolchainError as error:
        raise ContainerError(str(error)) from error
    for name in asked:
        if name not in (*PLATFORMS, ALL_PLATFORMS):
            msg = f"There is no platform {name}; {suggestion(name, [*PLATFORMS, ALL_PLATFORMS])}"
            raise ContainerError(msg)
    chosen = PLATFORMS if ALL_PLATFORMS in asked else asked
    return [PLATFORMS[name] for name in sorted(chosen)]


def _compiled(plan: Plan, sources: Mapping[str, str], platform: Platform, compiled: list[str]) -> bytes:
    libraries = ["m"] if any(fmu.needed for fmu in plan.fmus) else []
    try:
        return binary(plan.identifier, sources, platform, compiled=compiled, libraries=libraries)
    except (ToolchainError, OSError) as error:
        msg = f"System {plan.system.name} cannot be compiled: {error}"
        raise ContainerError(msg) from error


def _entries(plan: Plan) -> dict[str, bytes]:
    """All files of the FMU but the binaries."""
    documents = {member.name: document_of(member.fmu.path) for member in plan.members}
    files = [*compiled_files(plan), MAIN]
    entries = {"modelDescription.xml": container_description(plan, documents, files, GUID_PLACEHOLDER)}
    for name, text in {**c_sources(plan), **_layer(plan)}.items():
        entries[f"sources/{name}"] = text.encode("utf-8", "surrogateescape")
    guid = _guid(entries)
    for name in ("modelDescription.xml", f"sources/{MAIN}"):
        entries[name] = entries[name].replace(GUID_PLACEHOLDER.encode(), guid.encode())
    entries |= {"model.png": container_icon(), TERMINALS_FILE: _terminals(plan)}
    for name, content in container_documentation(plan, documents, files).items():
        entries[f"documentation/{name}"] = content
    return entries


def _guid(entries: Mapping[str, bytes]) -> str:
    """A hash of files as a GUID."""
    digest = hashlib.sha256()
    for name, content in sorted(entries.items()):
        digest.update(f"{len(name)} {len(content)} {name}\0".encode("utf-8", "surrogateescape") + content)
    return "{" + str(uuid.UUID(bytes=digest.digest()[:16])) + "}"


def _layer(plan: Plan) -> dict[str, str]:
    """The sources of the FMI functions, by name."""
    templates = environment()
    numbers = {"PARAMETERS": (FIXED, TUNABLE), "INPUTS": (INPUT,), "OUTPUTS": (OUTPUT,)}
    values = {
        "plan": plan,
        "guid": GUID_PLACEHOLDER,
        "sizes": {name: len(plan.with_role(*roles)) for name, roles in numbers.items()},
        "runs": _runs(plan),
        "whole": [bool(variable.variable.stands_for) for variable in plan.variables],
    }
    generated = {
        f"{LAYER}/{name}": templates.get_template(template).render(values)
        for name, template in (("model.c", "fmu_model.c.j2"), ("sizes.h", "fmu_sizes.h.j2"))
    }
    shared = {f"{LAYER}/{name}": text for name, text in _included(_RUNTIME, runtime_sources()).items()}
    return {**generated, **shared, f"{LAYER}/{RUNTIME_LICENSE}": runtime_license()}


def _included(name: str, runtime: Mapping[str, str]) -> dict[str, str]:
    """A file of the runtime, and those that it includes, by name; the model and FMI's headers are no part of it."""
    found: dict[str, str] = {}
    waiting = [name]
    while waiting:
        name = waiting.pop()
        if name in runtime and name not in found:
            found[name] = runtime[name]
            waiting += _INCLUDED.findall(runtime[name])
    return dict(sorted(found.items()))


def _runs(plan: Plan) -> list[tuple[ProgramVariable, int]]:
    """Count, for each variable, the neighbours in memory from it on that have its type and role, itself included."""
    lengths: list[int] = []
    following: ProgramVariable | None = None
    for variable in reversed(plan.variables):
        alike = following is not None and _kind(variable, 1) == _kind(following, 0)
        lengths.append(lengths[-1] + 1 if alike else 1)
        following = variable
    return list(zip(plan.variables, reversed(lengths), strict=True))


def _kind(variable: ProgramVariable, ahead: int) -> tuple[object, ...]:
    """What neighbours have in common: component, type and role; and the place that comes `ahead` of the variable's."""
    return variable.member, variable.declared.type, variable.role, variable.place + ahead


def _terminals(plan: Plan) -> bytes:
    """One terminal for each component, whose members have the names that the component gives them."""
    terminals = []
    for i, member in enumerate(plan.members):
        members = {v.variable.name: v.path for v in plan.variables if v.member == i}
        terminals.append(Terminal(member.name, members, member.component.description.model_name))
    return terminals_and_icons(plan.system.name, terminals, [v.path for v in plan.variables])
