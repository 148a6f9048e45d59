"""Compiles and loads native libraries: each once in a process, from the cache."""

import ctypes
import hashlib
import threading
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from adaptimp_fmu.binary import binary
from adaptimp_fmu.errors import ToolchainError
from adaptimp_fmu.files.cache_folder import cache_folder, is_trusted, writable_cache
from adaptimp_fmu.files.cache_use import use
from adaptimp_fmu.files.parts import MissingPartError
from adaptimp_fmu.files.whole_file import write_whole
from adaptimp_fmu.toolchain import Platform, host_platform
from adaptimp_fmu.toolchain import identity as toolchain_identity
from orchestration.errors import ContainerError

NAME = "native"
"""Name of each library's file, and of the folder in the cache."""
COMPLETE, AT_A_VALUE, AT_THE_START, AT_A_STEP = range(4)
"""Where a run has ended."""
_MAX_ARGUMENTS = 6  # of a failure, as in failure.h
_LOADED: dict[str, ctypes.CDLL] = {}
_LOCK = threading.Lock()


class Argument(ctypes.Structure):
    """An argument of a sentence."""

    _fields_ = (("kind", ctypes.c_char), ("number", ctypes.c_double), ("text", ctypes.c_char_p))


class Failure(ctypes.Structure):
    """Why something was refused: a component, a sentence with conversions as of printf, and their arguments."""

    _fields_ = (
        ("component", ctypes.c_char_p),
        ("sentence", ctypes.c_char_p),
        ("n", ctypes.c_int),
        ("arguments", Argument * _MAX_ARGUMENTS),
    )


class Outcome(ctypes.Structure):
    """How a run has ended, as ``runs.c`` has it."""

    _fields_ = (
        ("failure", Failure),
        ("where", ctypes.c_int32),
        ("variable", ctypes.c_int32),
        ("steps", ctypes.c_int64),
    )


class Request(ctypes.Structure):
    """What a call is given, as ``runs.c`` has it."""

    _fields_ = (
        ("n", ctypes.c_int64),
        ("n_common", ctypes.c_int64),
        *((name, ctypes.c_void_p) for name in ("common", "common_values", "values", "steps", "counts")),
        ("start_time", ctypes.c_double),
        *((name, ctypes.c_void_p) for name in ("stop", "memory", "reduced", "outcomes", "rows")),
        ("room", ctypes.c_int64),
    )


def identity_of(files: Mapping[str, str], compiled: Sequence[str]) -> str:
    """Return a hash of sources, and of all that decides what a compiler makes of them.

    Raises
    ------
    ContainerError
        If nothing can be compiled on this machine.
    """
    try:
        toolchain = toolchain_identity()
    except MissingPartError as error:
        raise ContainerError(str(error)) from error
    digest = hashlib.sha256(f"{toolchain} {_platform()} {' '.join(compiled)}".encode())
    for name, text in sorted(files.items()):
        digest.update(f"\0{name}\0{text}".encode("utf-8", "surrogateescape"))
    return digest.hexdigest()


def loaded(identity: str, files: Mapping[str, str], compiled: Sequence[str]) -> ctypes.CDLL:
    """Return the library of some sources, which is compiled and loaded unless it was before.

    Raises
    ------
    ContainerError
        If the compiler refuses the sources, or the library cannot be loaded.
    """
    with _LOCK:
        if identity not in _LOADED:
            try:
                content = binary(NAME, files, _platform(), compiled=compiled)
                library = ctypes.CDLL(str(_file(identity, content)))
            except (ToolchainError, OSError) as error:
                msg = f"The native library of the system cannot be made: {error}"
                raise ContainerError(msg) from error
            library.native_size.restype = ctypes.c_uint64
            library.native_runs.restype = ctypes.c_int64
            _LOADED[identity] = library
        return _LOADED[identity]


def _platform() -> Platform:
    """The platform of this machine, with one register more: nobody looks at the frames of a native library."""
    try:
        host = host_platform()
    except ToolchainError as error:
        raise ContainerError(str(error)) from error
    return replace(host, flags=(*host.flags, "-fomit-frame-pointer"))


def _file(identity: str, content: bytes) -> Path:
    """The library as a file in the cache, where nobody but this user can change it."""
    folder = writable_cache(NAME, identity[:32])
    use(cache_folder(), NAME, folder.name)
    path = folder / f"{NAME}{_platform().extension}"
    if not (is_trusted(path) and path.read_bytes() == content):
        write_whole(path, content)
    return path
