"""Confines a child process before the library of a stranger is loaded into it.

A parent starts the child with `starting` and `environment`. The child calls `limit`, which bounds what the process
uses up, and `seal`, which bounds what the process reaches. Each returns the names of the measures that are in force.
What a system does not offer is left out: the caller decides what to say about it.

| measure | what it does | where |
|---|---|---|
| session | the parent can end all that the child started | not on Windows |
| parent | the child ends when its parent does | Linux |
| memory, file size, files, time | limits of addresses, a file's bytes, open files, processor time | not on Windows |
| privileges | no capabilities of root, and none by starting a program | Linux |
| folders | files are made, changed and removed below chosen folders only (Landlock) | Linux 5.13 |
| calls | no sockets, programs, signals to others, mounts; modes of files stay (seccomp) | Linux on x86-64 and ARM |
| told | the parent learns which of these calls were tried | Linux 5.7 |
"""

import ctypes
import os
import signal
import site
import socket
import struct
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from orchestration.sandbox.landlock import write_only_below
from orchestration.sandbox.system_calls import deny_and_tell, deny_reaching_out

MOST_WRITTEN = 64 * 1024**2  # bytes that a file may grow to: a binary that prints for ever fills no disk
MOST_FILES = 256  # open at a time; an interpreter with the packages of this project has about 20
_KEPT = frozenset(
    {
        *("PATH", "LANG", "LANGUAGE", "TZ", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "DYLD_FALLBACK_LIBRARY_PATH"),
        *("SYSTEMROOT", "WINDIR", "SYSTEMDRIVE", "PATHEXT", "NUMBER_OF_PROCESSORS", "PROCESSOR_ARCHITECTURE"),
    }
)
_KEPT_BEGINNINGS = ("LC_", "PYTHON", "NUMBA_")
_HOMES = ("HOME", "USERPROFILE", "TMPDIR", "TEMP", "TMP", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "XDG_RUNTIME_DIR")
_THREADS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")
_SET_PARENT_DEATH_SIGNAL, _SET_NO_NEW_PRIVILEGES = 1, 38
_READ_ALL_FILES = 1 << 2  # CAP_DAC_READ_SEARCH: the program's own files may be another user's
_CAPABILITIES = 0x20080522  # version 3 of the structures


@dataclass(frozen=True)
class Limits:
    """What a confined process may use up; None sets no limit.

    Attributes
    ----------
    memory
        Bytes of addresses. Threads count with the size of their stacks, so this bounds their number, too.
    file_size
        Bytes that a file may grow to.
    files
        Number of descriptors.
    time
        Time of all processors together, s.
    """

    memory: int | None = None
    file_size: int | None = MOST_WRITTEN
    files: int | None = MOST_FILES
    time: float | None = None


def starting() -> dict[str, Any]:
    """Return the options with which `subprocess.Popen` starts a child in a session of its own."""
    return {"start_new_session": True} if os.name == "posix" else {}


def environment(folder: Path, also: Mapping[str, str]) -> dict[str, str]:
    """Return the environment variables of a confined child.

    Parameters
    ----------
    folder
        Folder that is the child's home, and takes its temporary files.
    also
        Further variables.
    """
    kept = {k: v for k, v in os.environ.items() if k.upper() in _KEPT or k.upper().startswith(_KEPT_BEGINNINGS)}
    with suppress(OSError, RuntimeError):  # without a home there is no such folder
        kept.setdefault("PYTHONUSERBASE", site.getuserbase())
    homes = dict.fromkeys(_HOMES, str(folder))
    return {**kept, **homes, **dict.fromkeys(_THREADS, "1"), "PYTHONDONTWRITEBYTECODE": "1", **also}


def limit(limits: Limits, parent: int | None = None) -> list[str]:
    """Bound what this process uses up; returns the measures that are in force.

    Parameters
    ----------
    parent
        Id of the parent process. The child then ends with the thread of the parent that started the child; None
        lets the child live on.
    """
    os.umask(0o077)
    found = _resources(limits)
    if hasattr(os, "getsid") and os.getsid(0) == os.getpid():
        found.insert(0, "session")
    if parent is not None and (libc := _libc()) is not None:
        if libc.prctl(_SET_PARENT_DEATH_SIGNAL, signal.SIGKILL, 0, 0, 0) == 0:
            found.append("parent")
        if os.getppid() != parent:  # the parent has ended before the call
            os._exit(1)
    return found


def seal(folders: Sequence[Path], teller: socket.socket | None = None) -> list[str]:
    """Bound what this process reaches, for ever; returns the measures that are in force.

    No thread but the caller's may run: Landlock bounds the thread that asks for it, and what that thread starts.

    Parameters
    ----------
    folders
        Existing folders below which files may be made, changed and removed.
    teller
        Socket of a pair, to whose other end `orchestration.sandbox.denials.Denials` listens: it is told of every
        system call that is denied, where the kernel offers that.
    """
    libc = _libc()
    if libc is None or libc.prctl(_SET_NO_NEW_PRIVILEGES, 1, 0, 0, 0) != 0:
        return []
    found = ["privileges"] if _drop_capabilities(libc) else []
    if _threads() == 1 and write_only_below(folders, libc):
        found.append("folders")
    if (listener := None if teller is None else deny_and_tell(libc)) is not None and teller is not None:
        socket.send_fds(teller, [b"."], [listener])
        os.close(listener)
        found += ["calls", "told"]
    elif deny_reaching_out(libc):
        found.append("calls")
    return found


def end(process: int) -> None:
    """End a child that `starting` started, by its id, and all processes in its session's first group."""
    if os.name == "posix":
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process, signal.SIGKILL)


def _libc() -> ctypes.CDLL | None:
    """The C library on Linux; None elsewhere."""
    return ctypes.CDLL(None, use_errno=True) if sys.platform.startswith("linux") else None


def _resources(limits: Limits) -> list[str]:
    """Set the limits that the system knows."""
    try:
        import resource
    except ImportError:  # Windows
        return []
    wanted = {
        "memory": (resource.RLIMIT_AS, limits.memory),
        "file size": (resource.RLIMIT_FSIZE, limits.file_size),
        "files": (resource.RLIMIT_NOFILE, limits.files),
        "time": (resource.RLIMIT_CPU, None if limits.time is None else max(1, round(limits.time))),
    }
    found = []
    with suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for name, (kind, most) in wanted.items():
        with suppress(ValueError, OSError):
            if most is not None:
                hard = resource.getrlimit(kind)[1]
                bound = most if hard == resource.RLIM_INFINITY else min(most, hard)
                resource.setrlimit(kind, (bound, bound))
                found.append(name)
    return found


def _drop_capabilities(libc: ctypes.CDLL) -> bool:
    """Give up what root may do more than others, except reading; returns whether the kernel took it."""
    header = ctypes.create_string_buffer(struct.pack("=Ii", _CAPABILITIES, 0))
    data = ctypes.create_string_buffer(24)
    if libc.capget(header, data) != 0:
        return False
    permitted = struct.unpack("=6I", data.raw[:24])[1] & _READ_ALL_FILES
    return libc.capset(header, struct.pack("=6I", permitted, permitted, 0, 0, 0, 0)) == 0


def _threads() -> int:
    """Number of threads of this process."""
    return len(os.listdir("/proc/self/task"))
