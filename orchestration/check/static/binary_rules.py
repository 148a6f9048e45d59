"""Checks rules 6 and 8: an FMU has a binary for this machine, named after the model, that exports FMI's functions."""

import re
from collections.abc import Iterator
from pathlib import PurePosixPath

from orchestration.check.findings import Finding, error, listed, note, shown, warning
from orchestration.check.static.archive_rules import Package
from orchestration.check.static.elf import ElfError, Library, read
from orchestration.errors import ArchiveError
from orchestration.fmi.library import host_folders, library_names
from orchestration.fmi.signatures import FUNCTIONS

LARGEST = 256 * 1024**2  # bytes of a library that are read
_ELF_FOLDERS = {
    "linux64": "x86_64",
    "x86_64-linux": "x86_64",
    "aarch64-linux": "aarch64",
}
_PYTHON = ("Py", "_Py")  # how the functions of its C interface begin
_SYSTEM = re.compile(r"(lib(c|m|dl|pthread|rt|gcc_s)|ld-linux[\w-]*)\.so(\.\d+)*")


def binary_is_for_this_machine(package: Package) -> Iterator[Finding]:
    """Check rule 6: a folder for this machine holds a library that is named after the modelIdentifier."""
    if host_library(package):
        return
    try:
        folders, extension = host_folders()
    except ArchiveError as unknown:
        yield error("6", str(unknown))
        return
    identifier = package.document.identifier
    present = sorted(_platforms(package))
    others = [n for n in sorted(package.names) for folder in folders if n.startswith(f"binaries/{folder}/")]
    others = [name for name in others if name.endswith(extension)]
    if others:
        yield error("6", f"{shown(others[0])} is not named after the modelIdentifier {shown(identifier)}.")
    else:
        has = listed(present) or "none"
        sources = package.document.root.find("CoSimulation/SourceFiles") is not None
        hint = "; fmpy compile builds one from its sources" if sources else ""
        yield error("6", f"There is no binary for {folders[0]}, this machine; there are: {has}{hint}.")


def binaries_are_named_after_the_model(package: Package) -> Iterator[Finding]:
    """Check rule 6: the folder of every platform has a file that is named after the modelIdentifier."""
    identifier = package.document.identifier
    here = {PurePosixPath(name).parts[1] for name in _host_names(identifier)}
    for folder in sorted(_platforms(package) - here):
        files = [PurePosixPath(name) for name in package.names if name.startswith(f"binaries/{folder}/")]
        if not any(file.stem == identifier for file in files):
            yield warning("6", f"binaries/{shown(folder)} has no file named after the model, {shown(identifier)}.")


def functions_are_exported(package: Package) -> Iterator[Finding]:
    """Check rule 8: the library exports the 34 functions, suits the processor, and needs nothing uncommon."""
    for folder, machine in _ELF_FOLDERS.items():
        name = f"binaries/{folder}/{package.document.identifier}.so"
        if name not in package.names:
            continue
        try:
            library = read(package.read(name, LARGEST))
        except ElfError as failed:
            yield error("8", f"{shown(name)} is not a shared library: {failed}.")
        else:
            yield from _judge(name, machine, library)
            yield from _interpreter(package, name, library)


def host_library(package: Package) -> str | None:
    """Return the name of the archive's entry that this machine loads; None if there is none."""
    return next((name for name in _host_names(package.document.identifier) if name in package.names), None)


def _host_names(identifier: str) -> list[str]:
    """Return the entries that this machine would load; none where FMI has no name for the platform."""
    try:
        return library_names(identifier)
    except ArchiveError:
        return []


def _interpreter(package: Package, name: str, library: Library) -> Iterator[Finding]:
    """Report a library that needs Python from its host: in a host without Python it does not load, or crashes."""
    calls = sorted(symbol for symbol in library.undefined if symbol.startswith(_PYTHON))
    if not calls or any(needed.startswith("libpython") for needed in library.needed):
        return
    declared = package.document.flag("needsExecutionTool")
    said = f"{shown(name)} calls {shown(calls[0])} of a Python interpreter that the importing process must have"
    if declared:
        yield note("8", f"{said}.")
    else:
        yield warning("8", f"{said}, without declaring needsExecutionTool.")


def _judge(name: str, machine: str, library: Library) -> Iterator[Finding]:
    short = shown(name)
    if library.machine != machine:
        yield error("8", f"{short} is for {library.machine}, not {machine}.")
    missing = [function for function in FUNCTIONS if function not in library.exported]
    if missing:
        yield error("8", f"{short} does not export {listed(missing)}; co-simulation needs all {len(FUNCTIONS)}.")
    more = sorted(library.exported - set(FUNCTIONS))
    if more:
        yield note(
            "8", f"{short} exports other names than FMI's, {len(more)} in all, such as {shown(min(more, key=len))}."
        )
    foreign = [needed for needed in library.needed if not _SYSTEM.fullmatch(needed)]
    if foreign:
        yield note("8", f"{short} needs {listed(foreign)}, which the importing machine must have.")
    if library.search_paths:
        yield note("8", f"{short} looks for libraries in {listed(library.search_paths)}.")


def _platforms(package: Package) -> set[str]:
    """Return the folders below ``binaries/`` that hold files."""
    paths = (PurePosixPath(name).parts for name in package.names if not name.endswith("/"))
    return {parts[1] for parts in paths if len(parts) > 2 and parts[0] == "binaries"}
