"""Linux's Landlock: from a call on, a process can write below chosen folders only, and reach no other process.

Reading stays as it was: a process needs its own program, and the libraries of the system. The kernel takes the
rules from an unprivileged process (Linux 5.13); later kernels know more rights. See landlock(7).
"""

import ctypes
import os
import struct
from collections.abc import Sequence
from pathlib import Path

_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446  # numbers of the calls, the same on all processors
_VERSION, _PATH_BENEATH = 1, 1
_WRITE_FILE, _REMOVE_DIR, _REMOVE_FILE, _MAKE_CHAR, _MAKE_BLOCK = 1 << 1, 1 << 4, 1 << 5, 1 << 6, 1 << 11
_MAKE_DIR, _MAKE_REGULAR, _MAKE_SOCKET, _MAKE_FIFO, _MAKE_LINK = 1 << 7, 1 << 8, 1 << 9, 1 << 10, 1 << 12
_REFER, _TRUNCATE = 1 << 13, 1 << 14  # since versions 2 and 3
_TCP = 0b11  # bind and connect; since version 4
_SCOPES = 0b11  # abstract sockets and signals; since version 6
_MAKE = _MAKE_DIR | _MAKE_REGULAR | _MAKE_SOCKET | _MAKE_FIFO | _MAKE_LINK
_WRITABLE_DEVICES = ("/dev/null", "/dev/zero", "/dev/full")


def write_only_below(folders: Sequence[Path], libc: ctypes.CDLL) -> bool:
    """Forbid this thread, and all that it starts, to change files elsewhere; returns whether the kernel does so.

    The process must have given up new privileges before (``PR_SET_NO_NEW_PRIVS``).

    Parameters
    ----------
    folders
        Existing folders below which files may be made, changed and removed.
    libc
        The C library, loaded with ``use_errno``.
    """
    version = libc.syscall(_CREATE_RULESET, None, 0, _VERSION)
    if version < 1:
        return False
    handled = _WRITE_FILE | _REMOVE_DIR | _REMOVE_FILE | _MAKE | _MAKE_CHAR | _MAKE_BLOCK
    handled |= (_REFER if version >= 2 else 0) | (_TRUNCATE if version >= 3 else 0)
    numbers = [handled, *([_TCP] if version >= 4 else []), *([_SCOPES] if version >= 6 else [])]
    attributes = struct.pack(f"={len(numbers)}Q", *numbers)
    rules = libc.syscall(_CREATE_RULESET, attributes, ctypes.c_size_t(len(attributes)), 0)
    if rules < 0:
        return False
    try:
        below = handled & ~(_MAKE_CHAR | _MAKE_BLOCK)
        allowed = all([_allow(libc, rules, folder, below) for folder in folders])
        for device in _WRITABLE_DEVICES:
            _allow(libc, rules, Path(device), handled & (_WRITE_FILE | _TRUNCATE))
        return allowed and libc.syscall(_RESTRICT_SELF, rules, 0) == 0
    finally:
        os.close(rules)


def _allow(libc: ctypes.CDLL, rules: int, path: Path, rights: int) -> bool:
    """Add a rule that gives rights below a path; returns whether the kernel took it."""
    try:
        place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except OSError:
        return False
    try:
        return libc.syscall(_ADD_RULE, rules, _PATH_BENEATH, struct.pack("=Qi", rights, place), 0) == 0
    finally:
        os.close(place)
