"""Finds and loads the shared library of an FMU for this machine, and gives its functions and their addresses."""

import ctypes
import platform
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, cast

from orchestration.errors import ArchiveError
from orchestration.fmi import signatures
from orchestration.fmi.codes import DIFFERENTIATES, INTERPOLATES, SAVES_STATE, SERIALIZES_STATE
from orchestration.fmi.description import Description
from orchestration.sandbox.native_library import LibraryError, require_loadable
from orchestration.sandbox.zip.rules import shown

# Folders below ``binaries/``, the usual one first, by sys.platform: of x86-64, of ARM; and the extension.
_PLATFORMS: dict[str, tuple[tuple[str, ...], tuple[str, ...], str]] = {
    "linux": (("linux64", "x86_64-linux"), ("aarch64-linux",), ".so"),
    "darwin": (("darwin64", "x86_64-darwin"), ("aarch64-darwin", "darwin64"), ".dylib"),
    "win32": (("win64", "x86_64-windows"), ("win64", "x86_64-windows"), ".dll"),
}


_ALWAYS = (
    *("fmi2Instantiate", "fmi2FreeInstance", "fmi2SetupExperiment", "fmi2EnterInitializationMode"),
    *("fmi2ExitInitializationMode", "fmi2DoStep", "fmi2Terminate"),
)
_BY_CAPABILITY = {
    SAVES_STATE: ("fmi2GetFMUstate", "fmi2SetFMUstate", "fmi2FreeFMUstate"),
    SERIALIZES_STATE: ("fmi2SerializedFMUstateSize", "fmi2SerializeFMUstate", "fmi2DeSerializeFMUstate"),
    INTERPOLATES: ("fmi2SetRealInputDerivatives",),
    DIFFERENTIATES: ("fmi2GetDirectionalDerivative",),
}


def needed_functions(description: Description) -> list[str]:
    """Return the functions that a run of an FMU may call: by its variables and its capability flags."""
    types = dict.fromkeys(variable.type for variable in description.variables.values())
    access = [f"fmi2{verb}{kind}" for kind in types for verb in ("Get", "Set")]
    optional = [name for flag, names in _BY_CAPABILITY.items() if description.can(flag) for name in names]
    return [*_ALWAYS, *access, *optional]


def needed_to_run(entry: str) -> bool:
    """Whether a running FMU uses an entry of its archive; sources and documentation are not used."""
    return not entry.startswith(("sources/", "documentation/"))


def host_folders() -> tuple[tuple[str, ...], str]:
    """Return the folders below ``binaries/`` for this machine, the usual one first, and the extension of libraries.

    Raises
    ------
    ArchiveError
        If FMI 2.0 has no name for this platform.
    """
    if sys.platform not in _PLATFORMS:
        known = ", ".join(_PLATFORMS)
        msg = f"No FMU has a library for the platform {sys.platform}, this machine; FMUs run on {known}."
        raise ArchiveError(msg)
    intel, arm, extension = _PLATFORMS[sys.platform]
    return (arm if platform.machine().lower() in ("arm64", "aarch64") else intel), extension


def library_names(identifier: str) -> list[str]:
    """Return the libraries in an archive that this machine would load, the usual one first.

    Raises
    ------
    ArchiveError
        If FMI 2.0 has no name for this platform.
    """
    folders, extension = host_folders()
    return [f"binaries/{folder}/{identifier}{extension}" for folder in folders]


def library_path(folder: Path, description: Description) -> Path:
    """Return the path of the shared library for this machine in an unpacked FMU.

    Raises
    ------
    ArchiveError
        If the FMU has none; the message names the platforms that the FMU has.
    LibraryError
        If the library is not a whole file for this machine.
    """
    for name in library_names(description.identifier):
        if (folder / name).is_file():
            require_whole(folder, name)
            return folder / name
    binaries = folder / "binaries"
    # A folder without a library says nothing; some tools write empty folders for all platforms.
    present = sorted({p.parent.name for p in binaries.glob("*/*") if p.is_file()})
    has = ", ".join(present) or "none"
    msg = f"{description.path} has no binary for {host_folders()[0][0]}, this machine; it has {has}."
    raise ArchiveError(msg)


def require_whole(folder: Path, name: str) -> None:
    """Refuse a library of an unpacked FMU that leads out of the folder, is cut off, or is of another machine.

    Raises
    ------
    LibraryError
        Naming the library and its fault.
    """
    try:
        require_loadable(folder / name, folder)
    except LibraryError as error:
        msg = f"the library {shown(name)} {error}."
        raise LibraryError(msg) from error


class Library:
    """A loaded shared library of an FMU.

    On Windows, the libraries that it needs are found next to it, since its path is absolute. On other systems the
    library itself tells where they are. So the working directory, which all threads share, is not changed.

    Parameters
    ----------
    path
        Absolute path of the file.

    Raises
    ------
    OSError
        If the library, or one that it needs, cannot be loaded.
    """

    isolated = False
    ending = ""
    """How the process of the library ended, such as ``died of SIGSEGV``; empty if it is this process."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._dll: ctypes.CDLL | None = ctypes.CDLL(str(path))
        self._functions: dict[str, Any] = {}

    def lacks(self, functions: Sequence[str] = signatures.FUNCTIONS) -> list[str]:
        """Functions that are not exported; by default of all functions of FMI 2.0 for co-simulation."""
        return [name for name in functions if not hasattr(self._dll, name)]

    def function(self, name: str) -> Callable[..., Any]:
        """An FMI function with its C types.

        Raises
        ------
        AttributeError
            If the library does not export it.
        """
        found = self._functions.get(name)
        if found is None:
            if not hasattr(self._dll, name):
                msg = f"{self.path.name} does not export {name}."
                raise AttributeError(msg, name=name)
            found = getattr(self._dll, name)
            found.restype, found.argtypes = signatures.prototype(name)
            self._functions[name] = found
        return found

    def address(self, name: str) -> int:
        """Address of an FMI function; 0 if the library does not export it, and so nobody may call it."""
        if not hasattr(self._dll, name):
            return 0
        function = cast("Any", self.function(name))  # ctypes does not name the type of its functions
        return int(ctypes.cast(function, ctypes.c_void_p).value or 0)

    def close(self) -> None:
        """Unload the library, so that its file can be removed; a second call does nothing."""
        if self._dll is not None:
            handle, self._dll = self._dll._handle, None
            self._functions.clear()
            _unload(handle)


def _unload(handle: int) -> None:
    import _ctypes

    if sys.platform == "win32":
        _ctypes.FreeLibrary(handle)
    else:
        _ctypes.dlclose(handle)
