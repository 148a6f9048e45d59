"""Checks rules 1 and 7: an FMU's archive is safe, complete, and holds a description that FMI's schema accepts."""

import posixpath
import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from orchestration.check.findings import Finding, error, listed, note, shown, warning
from orchestration.errors import ArchiveError
from orchestration.fmi.document import MODEL_DESCRIPTION, Document, DocumentError, parsed, read_bytes, require_valid
from orchestration.sandbox.archive import entry_names, read_entries, screen

LARGEST_SOURCES = 8 * 1024**2  # bytes of all sources that are read; ours have 0.2 MB
LONGEST_MESSAGE = 400
_INCLUDE = re.compile(rb'^[ \t]*#[ \t]*include[ \t]*"([^"\n]{1,200})"', re.MULTILINE)


class UnreadableError(Exception):
    """An FMU cannot be examined any further; `finding` says why."""

    def __init__(self, finding: Finding) -> None:
        super().__init__(finding.message)
        self.finding = finding


@dataclass(frozen=True)
class Package:
    """An FMU file under check.

    Attributes
    ----------
    names
        Names of the entries in the archive.
    formalities
        Sentences on rules of form that the archive breaks.
    """

    path: Path
    names: frozenset[str]
    document: Document
    formalities: tuple[str, ...] = ()

    def read(self, name: str, most: int) -> bytes:
        """Return the first bytes of an entry of the archive; empty if the entry cannot be read."""
        return next((content for _, content in self.contents([name], most)), b"")

    def contents(self, names: Sequence[str], most: int) -> Iterator[tuple[str, bytes]]:
        """Iterate over entries of the archive with their first bytes, until `most` bytes are read or one is damaged."""
        with suppress(ArchiveError):
            yield from read_entries(self.path, names, most)


def open_package(path: Path) -> Package:
    """Screen an FMU's archive, read its description and validate it.

    Raises
    ------
    UnreadableError
        With the finding that ends the examination.
    """
    try:
        formalities = screen(path)
        names = frozenset(entry_names(path))
    except ArchiveError as failed:
        raise UnreadableError(error("7", shown(str(failed).replace(str(path), path.name), LONGEST_MESSAGE))) from failed
    if MODEL_DESCRIPTION not in names:
        raise UnreadableError(error("1", f"The archive has no {MODEL_DESCRIPTION}; it has {listed(sorted(names))}."))
    return Package(path, names, _document(path), formalities)


def entries_are_unique(package: Package) -> Iterator[Finding]:
    """Check rule 7: no two entries of the archive have one name."""
    for sentence in package.formalities:
        yield error("7", shown(sentence, LONGEST_MESSAGE))


def sources_are_complete(package: Package) -> Iterator[Finding]:
    """Check rule 7: the archive holds every declared source file, and every file that one includes with quotes."""
    names = package.names
    compiled_here = not any(name.startswith("binaries/") for name in names)
    for file in package.document.root.iterfind("CoSimulation/SourceFiles/File"):
        if f"sources/{file.get('name')}" not in names:
            message = f"The source file {shown(file.get('name'))} is declared, but not in the archive."
            yield error("7", message) if compiled_here else warning("7", message)
    sources = sorted(name for name in names if name.startswith("sources/") and name.endswith((".c", ".h")))
    for name, content in package.contents(sources, LARGEST_SOURCES):
        for found in _INCLUDE.finditer(content):
            included = found[1].decode(errors="replace")
            beside = posixpath.normpath(posixpath.join(posixpath.dirname(name), included))
            fmis = posixpath.basename(included).startswith("fmi2")
            if not fmis and beside not in names and f"sources/{included}" not in names:
                yield warning("7", f"{shown(name)} includes {shown(included)}, which is not in the archive.")


def tool_is_not_needed(package: Package) -> Iterator[Finding]:
    """Check rule 7: the FMU runs without the tool that exported it."""
    if package.document.flag("needsExecutionTool"):
        yield note("7", "needsExecutionTool: the FMU runs only where the tool that exported it is installed.")


def _document(path: Path) -> Document:
    """Return the description if it is valid."""
    try:
        root = parsed(read_bytes(path))
        version = root.get("fmiVersion")
        if root.tag != "fmiModelDescription" or version != "2.0":
            said = f"{MODEL_DESCRIPTION} has the root {shown(root.tag)} and fmiVersion {shown(version)}"
            raise UnreadableError(error("1", f"{said}; fmiModelDescription and 2.0 are needed."))
        require_valid(root)
    except DocumentError as failed:
        raise UnreadableError(error("1", shown(failed, LONGEST_MESSAGE))) from failed
    except ArchiveError as failed:
        raise UnreadableError(error("7", shown(failed, LONGEST_MESSAGE))) from failed
    if root.find("CoSimulation") is None:
        raise UnreadableError(error("1", "There is no CoSimulation element; the FMU is for model exchange only."))
    return Document(root)
