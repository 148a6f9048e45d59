"""A system as a module of WebAssembly that imports nothing, with a description and a host in JavaScript.

The module is made of the same C as the other forms of a system. `templates/exports.c.j2` says what it exports.
"""

import hashlib
import importlib.resources
import re
from collections.abc import Callable
from pathlib import Path

from adaptimp_fmu.binary import binary
from adaptimp_fmu.errors import ToolchainError
from adaptimp_fmu.files.whole_file import write_together
from adaptimp_fmu.toolchain import WASM, WASM_WITH_LIBRARY
from orchestration.containers.c.program import c_sources, compiled_files
from orchestration.containers.c_text import environment
from orchestration.containers.plan import GAUSS_SEIDEL, Plan, plan_of
from orchestration.containers.wasm.description import description
from orchestration.containers.wasm.imports import imported_names
from orchestration.errors import ContainerError
from orchestration.fmi.given import a_path
from orchestration.master.algorithm import Algorithm
from orchestration.system.system import System

SUFFIX, DESCRIPTION, SCRIPT = ".wasm", ".json", ".mjs"
EXPORTS, HOST = "exports.c", "system.mjs"
_UNDEFINED = re.compile(r"([^/\\\s]+)\.o(?:bj)?: undefined symbol: (\S+)")
"""What the linker says: the stem of the source that calls a function, and the function."""


def write_wasm(
    system: System,
    path: str | Path,
    algorithm: str | Algorithm = GAUSS_SEIDEL,
    *,
    variable_step: bool = False,
    known: Callable[[str], bytes | None] | None = None,
) -> Path:
    """Write a system as a module of WebAssembly.

    Beside the module ``NAME.wasm`` stand ``NAME.json``, which describes its variables, and ``NAME.mjs``, with which
    node and browsers run it. The three files are written together or not at all.

    Parameters
    ----------
    system
        System with a step. Its start values become those of the module.
    path
        File with the suffix ``.wasm``. The files of an earlier module are replaced.
    algorithm
        ``gauss-seidel`` or ``jacobi``.
    variable_step
        Whether a run may have another step than the system. The module then exports ``set_step``, too.
    known
        Gives the module of an identity, if it was compiled before and kept; an identity is a hash of all C sources.
        Default: the module is compiled, or taken from the cache.

    Returns
    -------
    Path
        The path of the module.

    Raises
    ------
    ContainerError
        If the suffix is another one, there is a ``NAME.json`` or ``NAME.mjs`` that is of no module, the system cannot
        be one program, an FMU calls what a module lacks, such as files, or a file cannot be written.
    SystemDescriptionError
        If the system has no step, or a sampling period is not a multiple of it.

    Examples
    --------
    >>> from orchestration import scenario
    >>> from orchestration.containers.wasm.module import write_wasm
    >>> module = write_wasm(scenario("fig2"), "fig2.wasm")
    >>> sorted(file.name for file in module.parent.glob("fig2.*"))
    ['fig2.json', 'fig2.mjs', 'fig2.wasm']
    """
    target = a_path("The file of a module", path)
    if target.suffix.lower() != SUFFIX:
        msg = f"{target}: the name of a module of WebAssembly ends in {SUFFIX}; write {target.stem}{SUFFIX}."
        raise ContainerError(msg)
    _require_own(target)
    plan = plan_of(system, algorithm)
    sources, identity = _sources(plan, variable_step=variable_step)
    kept = known(identity) if known else None
    module = kept or _module(plan, sources)
    stated = description(plan, identity, target.name, module, variable_step=variable_step)
    files = {
        target: module,
        target.with_suffix(DESCRIPTION): stated,
        target.with_suffix(SCRIPT): host(),
    }
    try:
        write_together(files)
    except OSError as error:
        msg = f"{target}: the module cannot be written: {error.strerror}; choose another place."
        raise ContainerError(msg) from error
    return target


def _require_own(target: Path) -> None:
    """Refuse to replace a file beside the module that is not of an earlier module."""
    others = [path.name for path in map(target.with_suffix, (DESCRIPTION, SCRIPT)) if path.exists()]
    if others and not target.exists():
        msg = (
            f"{target}: {others[0]} exists and is not of an earlier module, so it is not replaced; choose another name."
        )
        raise ContainerError(msg)


def host() -> bytes:
    """Return the program in JavaScript that runs a module in node and in browsers."""
    return (importlib.resources.files("orchestration.containers") / "templates" / HOST).read_bytes()


def _sources(plan: Plan, *, variable_step: bool = False) -> tuple[dict[str, str], str]:
    """All C sources of the module by name, and its identity: a hash of the sources, which the module tells."""
    template = environment().get_template(f"{EXPORTS}.j2")
    given = {
        "name": plan.identifier,
        "library": bool(plan.foreign),
        "variable_step": variable_step,
        "step": plan.step,
    }
    sources = c_sources(plan, variable_step=True) if variable_step else c_sources(plan)
    digest = hashlib.sha256(template.render(given, identity="").encode())
    for name, text in sorted(sources.items()):
        digest.update(f"\0{name}\0{text}".encode("utf-8", "surrogateescape"))
    identity = digest.hexdigest()[:32]
    return sources | {EXPORTS: template.render(given, identity=identity)}, identity


def _module(plan: Plan, sources: dict[str, str]) -> bytes:
    """Compile, or take from the cache."""
    platform = WASM_WITH_LIBRARY if plan.foreign else WASM
    try:
        module = binary(plan.identifier, sources, platform, compiled=[EXPORTS, *compiled_files(plan)])
    except ToolchainError as error:
        called = _called(plan, str(error))
        if not called:
            raise
        msg = f"{called}, which a module of WebAssembly lacks; export the system as an FMU or as C."
        raise ContainerError(msg) from error
    if names := imported_names(module):
        users = "; ".join(f"{m.name}: {m.fmu.path.name} calls {', '.join(m.fmu.needed)}" for m in plan.foreign)
        msg = (
            f"{users}: for one of these a module of WebAssembly would import {', '.join(names)} of an operating system;"
            " export the system as an FMU or as C."
        )
        raise ContainerError(msg)
    return module


def _called(plan: Plan, said: str) -> str:
    """Which FMUs call which functions that the linker does not find; empty if none of them does."""
    functions: dict[str, set[str]] = {}
    for unit, function in _UNDEFINED.findall(said):
        functions.setdefault(unit.partition(".")[0], set()).add(function)
    return "; ".join(
        f"{member.name}: {member.fmu.path.name} calls {', '.join(sorted(functions[member.fmu.name]))}"
        for member in plan.members
        if member.fmu.name in functions
    )
