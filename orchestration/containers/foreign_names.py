"""Gives the C sources of a stranger names of their own, so that several strangers share one program without a clash.

Each source file is compiled by a small file that includes it after ``#define`` lines for every name that the linker
would see: FMI's functions become ``NAME_fmi2DoStep``, and ``helper`` becomes ``NAME_helper``. One such file for each
source file keeps static functions and macros of two files apart, as the stranger's own compiler does. The names come
from a first compilation; a second one shows that no other name is left.
"""

import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from adaptimp_fmu.files.temporary_folder import temporary_folder
from adaptimp_fmu.toolchain import fmi_headers
from orchestration.containers.c_text import environment
from orchestration.containers.foreign_sources import ForeignSources
from orchestration.errors import ContainerError, printable
from orchestration.fmi.display import listed
from orchestration.sandbox.limited import run_limited
from orchestration.sandbox.object_file import Names, read_names
from orchestration.system.component import Component

HEADER = "fmi2Functions.h"
MOST_NAMES = 4
LONGEST_LINE = 300  # characters of a compiler's message
_TARGET = "x86_64-linux-gnu"  # its objects are ELF files on every machine
_FLAGS = ("-std=c11", "-O1", "-w", "-fno-sanitize=all", "-fno-stack-protector", "-ffp-contract=off", "-g0")
_FMI_FUNCTION = re.compile(r"(?:\w*_)?(fmi2[A-Z]\w*)")
_OF_COMPILER = frozenset({"memcpy", "memset", "memmove", "memcmp", "_GLOBAL_OFFSET_TABLE_"})


@dataclass(frozen=True)
class RenamedSources:
    """Files that compile a stranger's sources under names of their own.

    Attributes
    ----------
    wrappers
        Texts of these files by name; they lie beside the folder of the sources.
    functions
        FMI's functions that the sources define, without the prefix.
    needed
        Functions of the C library that the sources call.
    own_headers
        Whether the sources bring FMI's headers themselves, or use none.
    """

    wrappers: Mapping[str, str]
    functions: frozenset[str]
    needed: frozenset[str]
    own_headers: bool


def rename(component: Component, name: str, sources: ForeignSources) -> RenamedSources:
    """Find the names that a stranger's sources define, and write the files that change them.

    The compiler runs with limits, in a temporary folder, on these files only.

    Parameters
    ----------
    component
        Component that messages name.
    name
        C identifier that begins all names, and is the folder of the sources.

    Raises
    ------
    ContainerError
        If the sources do not compile by themselves, or keep names of other files.
    """
    with temporary_folder() as home:
        folder = home / "program"
        write_below(folder / name, sources.files)
        compiler = _Compiler(component, name, folder, home)
        found = {file: compiler.compile(file, None, {}) for file in sources.compiled}
        defined = set().union(*(names.defined for names, _ in found.values()))
        new_names = {old: f"{name}_{_fmi_name(old) or old}" for old in sorted(defined)}
        plain = {_fmi_name(old) for old in defined} - {None}
        new_names |= {function: f"{name}_{function}" for function in sorted(filter(None, plain))}
        renamed = {file: compiler.compile(file, header, new_names) for file, (_, header) in found.items()}
    _require_renamed(component, name, {file: names for file, (names, _) in renamed.items()}, new_names)
    called = set().union(*(names.undefined for names, _ in renamed.values()))
    return RenamedSources(
        wrappers={
            f"{name}.source{i}.c": _wrapper(component, name, file, header, new_names)
            for i, (file, (_, header)) in enumerate(found.items(), start=1)
        },
        functions=frozenset(filter(None, plain)),
        needed=frozenset(called - set(new_names.values()) - _OF_COMPILER),
        own_headers=all(header != HEADER for _, header in found.values()),
    )


def write_below(folder: Path, files: Mapping[str, str]) -> None:
    """Write texts to files below a new folder, by their paths; surrogates become the bytes that they stand for."""
    for path, text in files.items():
        target = folder.joinpath(PurePosixPath(path))
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(text.encode("utf-8", "surrogateescape"))


def _fmi_name(symbol: str) -> str | None:
    """Return the name of FMI's function in a name with or without a prefix; None if it is another name."""
    found = _FMI_FUNCTION.fullmatch(symbol)
    return found[1] if found else None


def _wrapper(component: Component, name: str, file: str, header: str | None, new_names: Mapping[str, str]) -> str:
    template = environment().get_template("foreign_source.c.j2")
    model = component.description.model_name
    return template.render(name=name, file=file, model=model, header=header, renames=list(new_names.items()))


@dataclass(frozen=True)
class _Compiler:
    """Compiles single files of a stranger in a temporary folder."""

    component: Component
    name: str
    folder: Path
    home: Path

    def compile(self, file: str, header: str | None, new_names: Mapping[str, str]) -> tuple[Names, str | None]:
        """Return the names of a file's object, and where its FMI header is; None if it includes none.

        Raises
        ------
        ContainerError
        """
        wrapper = self.folder / "wrapper.c"
        wrapper.write_text(_wrapper(self.component, self.name, file, header, new_names), encoding="utf-8")
        program = [sys.executable, "-m", "ziglang", "cc", "-target", _TARGET, *_FLAGS, "-I", str(fmi_headers())]
        output = ("-MD", "-MF", "wrapper.d", "-c", "wrapper.c", "-o", "wrapper.o")
        outcome = run_limited([*program, *output], self.folder, self.home)
        if outcome.code != 0:
            said = _first_error(outcome.errors)
            raise self._refused(f"{file} does not compile by itself: {said}")
        included = _included(self.folder / "wrapper.d", self.folder)
        self._require_own(file, included)
        headers = [self._path(path) for path in included if path.name == HEADER]
        return read_names((self.folder / "wrapper.o").read_bytes()), (headers or [None])[0]

    def _path(self, path: Path) -> str:
        """How the file that changes names includes a header: the stranger's own, or that of the C compiler's user."""
        own = self.folder.resolve()
        return path.relative_to(own).as_posix() if path.is_relative_to(own) else path.name

    def _require_own(self, file: str, included: Iterable[Path]) -> None:
        """Refuse sources that include files of this machine, which the program would carry to others."""
        roots = [self.folder.resolve(), fmi_headers().resolve(), _compiler_folder()]
        for path in included:
            if not any(path.is_relative_to(root) for root in roots):
                raise self._refused(f"{file} includes {path}, a file outside of the FMU and of the C library")

    def _refused(self, why: str) -> ContainerError:
        msg = f"{self.component.name}: the sources of {self.component.path.name} cannot be used: {why}."
        return ContainerError(msg)


def _compiler_folder() -> Path:
    """Folder of the compiler with its headers."""
    import ziglang

    return Path(ziglang.__file__).parent.resolve()


def _first_error(errors: str) -> str:
    """The first line of a compiler's output that tells an error."""
    lines = [line for line in errors.splitlines() if line.strip()]
    found = next((line for line in lines if "error:" in line), (lines or ["the compiler says nothing"])[0])
    return printable(found.strip().rstrip("."), LONGEST_LINE)


def _included(listing: Path, folder: Path) -> list[Path]:
    """Files that a compilation read, from the listing that the compiler wrote for make."""
    text = listing.read_text(encoding="utf-8", errors="surrogateescape").partition(":")[2].replace("\\\n", " ")
    names = [name.replace("\\ ", " ").replace("$$", "$") for name in re.split(r"(?<!\\)\s+", text) if name]
    return [(folder / name).resolve() for name in names]


def _require_renamed(
    component: Component, name: str, objects: Mapping[str, Names], new_names: Mapping[str, str]
) -> None:
    """Refuse sources that define a name which the ``#define`` lines did not reach, or a name twice."""
    own = set(new_names.values())
    for file, names in objects.items():
        if left := sorted(names.defined - own):
            others = listed(left, MOST_NAMES)
            msg = (
                f"{component.name}: {file} of {component.path.name} defines {others} by means that a macro does not"
                f" reach, so it could clash with other components; give such names the prefix {name}_ in the sources."
            )
            raise ContainerError(msg)


def missing_functions(functions: Iterable[str], needed: Sequence[str]) -> list[str]:
    """Return FMI's functions of a list that the sources do not define."""
    defined = set(functions)
    return [name for name in needed if name not in defined]
