"""Loads the library of an unpacked FMU, in this process or in another, and says why it does not load."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from adaptimp_fmu.files.temporary_folder import runs_nothing
from orchestration.errors import ArchiveError, InitializationError
from orchestration.fmi.codes import NEEDS_TOOL
from orchestration.fmi.description import Description
from orchestration.fmi.display import listed
from orchestration.fmi.library import Library, library_path, needed_functions
from orchestration.sandbox.native_library import LibraryError

if TYPE_CHECKING:
    from orchestration.sandbox.remote import RemoteProcess

MOST_FUNCTIONS = 6
"""How many missing functions a message names."""


@contextmanager
def told_of_tool(description: Description) -> Iterator[None]:
    """Say in errors that an FMU needs the tool that exported it, if it declares so."""
    try:
        yield
    except (ArchiveError, InitializationError) as error:
        if not description.can(NEEDS_TOOL):
            raise
        msg = f"{error} {description.path.name} declares {NEEDS_TOOL}: the tool that exported it must be installed."
        raise type(error)(msg) from error


def loaded(name: str, description: Description, folder: Path, process: "RemoteProcess | None") -> Library:
    """Load the library for this machine in an unpacked FMU; it has all functions that a run may call."""
    try:
        path = library_path(folder, description)
        library = Library(path) if process is None else _remote(path, process)
    except (OSError, LibraryError) as error:
        said = str(error).replace(f"{folder}/", "").rstrip(".")  # the folder is a temporary one
        msg = f"{name}: {description.path.name} cannot be loaded: {said}."
        if runs_nothing(folder):
            msg += f" Nothing can be run from {folder.parent} (noexec), so set TMPDIR to another folder."
        raise ArchiveError(msg) from error
    if missing := library.lacks(needed_functions(description)):
        library.close()
        functions = listed(missing, MOST_FUNCTIONS)
        msg = f"{name}: {description.path.name} cannot be loaded: its library does not export {functions}."
        raise ArchiveError(msg)
    return library


def _remote(path: Path, process: "RemoteProcess") -> Library:
    from orchestration.fmi.remote_library import RemoteLibrary

    return RemoteLibrary(path, process)
