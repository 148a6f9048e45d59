"""Compiles the C sources of a stranger, to learn which names they define and which headers they use.

The compiler runs with limits in a temporary folder that holds these sources only. The sources choose none of its
options, and may include nothing but their own files, FMI's headers and those of the C library.
"""

import re
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from adaptimp_fmu.toolchain import fmi_headers
from orchestration.containers.contained.foreign.sources import INCLUDABLE
from orchestration.errors import printable
from orchestration.sandbox.limited import run_limited
from orchestration.sandbox.object_file import ElfError, Names, read_names

HEADER = "fmi2Functions.h"
LONGEST_LINE = 300  # characters of a compiler's message
_TARGET = "x86_64-linux-gnu"  # its objects are ELF files on every machine
_FLAGS = ("-std=c11", "-O1", "-w", "-fno-sanitize=all", "-fno-stack-protector", "-ffp-contract=off", "-g0")


class UnfitSourcesError(Exception):
    """Sources that no program can contain; the text is a part of a sentence whose subject is the sources."""


@dataclass(frozen=True)
class Compiled:
    """What was learned of a source file.

    Attributes
    ----------
    names
        Names that its object defines and needs.
    header
        Where the file finds FMI's functions: a path below the working folder, or the name alone if the compiler's user
        brings the header; None if it includes no such header.
    """

    names: Names
    header: str | None


def compiled(text: str, folder: Path, home: Path) -> Compiled:
    """Compile a text with ``#include`` lines of a stranger's files.

    Parameters
    ----------
    text
        Text of the file that is compiled.
    folder
        Working folder, which holds the stranger's files below it.
    home
        Folder above it, for files of the compiler.

    Raises
    ------
    UnfitSourcesError
        If the text does not compile, or includes files of this machine.
    """
    (folder / "wrapper.c").write_text(text, encoding="utf-8")
    program = [sys.executable, "-m", "ziglang", "cc", "-target", _TARGET, *_FLAGS, "-I", str(fmi_headers())]
    output = ("-MD", "-MF", "wrapper.d", "-c", "wrapper.c", "-o", "wrapper.o")
    outcome = run_limited([*program, *output], folder, home)
    if outcome.how:
        msg = f"do not compile by themselves: {_first_error(outcome.errors) or f'the compiler {outcome.how}'}"
        raise UnfitSourcesError(msg)
    included = _included(folder / "wrapper.d", folder)
    _require_own(included, folder)
    headers = [_place(path, folder) for path in included if path.name == HEADER]
    if headers and not INCLUDABLE.fullmatch(headers[0]):
        msg = f"have FMI's header in {printable(headers[0], LONGEST_LINE)!r}, a name that a program cannot include"
        raise UnfitSourcesError(msg)
    try:
        names = read_names((folder / "wrapper.o").read_bytes())
    except ElfError as error:
        msg = f"become an object that cannot be read: {error}"
        raise UnfitSourcesError(msg) from error
    return Compiled(names, headers[0] if headers else None)


def write_below(folder: Path, files: Mapping[str, str]) -> None:
    """Write texts to files below a folder, by their paths; surrogates become the bytes that they stand for."""
    for path, text in files.items():
        target = folder.joinpath(PurePosixPath(path))
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(text.encode("utf-8", "surrogateescape"))


def _place(path: Path, folder: Path) -> str:
    own = folder.resolve()
    return path.relative_to(own).as_posix() if path.is_relative_to(own) else path.name


def _require_own(included: Iterable[Path], folder: Path) -> None:
    """Refuse files of this machine, which the program would carry to others."""
    roots = [folder.resolve(), fmi_headers().resolve(), _compiler_folder()]
    for path in included:
        if not any(path.is_relative_to(root) for root in roots):
            msg = f"include {printable(path, LONGEST_LINE)}, a file outside of the FMU and of the C library"
            raise UnfitSourcesError(msg)


def _compiler_folder() -> Path:
    """Folder of the compiler with its headers."""
    import ziglang

    return Path(ziglang.__file__).parent.resolve()


def _first_error(errors: str) -> str:
    """The first line of a compiler's output that tells an error; empty if there is none."""
    found = next((line for line in errors.splitlines() if "error:" in line), "")
    return printable(found.strip().rstrip("."), LONGEST_LINE)


def _included(listing: Path, folder: Path) -> list[Path]:
    """Files that a compilation read, from the listing that the compiler wrote for make."""
    text = listing.read_text(encoding="utf-8", errors="surrogateescape").partition(":")[2].replace("\\\n", " ")
    names = [name.replace("\\ ", " ").replace("$$", "$") for name in re.split(r"(?<!\\)\s+", text) if name]
    return [(folder / name).resolve() for name in names]
