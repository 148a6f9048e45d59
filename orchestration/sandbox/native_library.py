"""Examines the shared library of a stranger before it is loaded: it must be a whole file, and of this machine.

The system maps a library into memory by the numbers in its header. If the file is shorter than they say, the process
dies of SIGBUS at the first access. The readers know 64-bit ELF (Linux), PE (Windows) and Mach-O (macOS), little-endian.
"""

import platform
import struct
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from orchestration.errors import ArchiveError
from orchestration.sandbox.elf import ElfError, read_header

_KINDS = {"linux": "ELF", "darwin": "Mach-O", "win32": "PE"}
_NAMES = {"amd64": "x86_64", "x64": "x86_64", "arm64": "aarch64"}
_PE_MACHINES = {0x8664: "x86_64", 0xAA64: "aarch64", 0x14C: "x86"}
_MACH_O_MACHINES = {0x01000007: "x86_64", 0x0100000C: "aarch64"}
_MACH_O, _FAT, _SEGMENT = 0xFEEDFACF, 0xCAFEBABE, 0x19
_MOST = 4096  # tables: more are a damaged header


class LibraryError(ArchiveError):
    """A file is not a shared library of this machine; the message is the end of a sentence about the file."""


@dataclass(frozen=True)
class _Image:
    """What a header says: the processor, and the stretches of the file that are mapped into memory."""

    machine: str
    stretches: tuple[tuple[int, int], ...]


def require_loadable(path: Path, folder: Path) -> None:
    """Refuse a library that is not a whole file of this machine, inside of a folder.

    Parameters
    ----------
    path
        Shared library.
    folder
        Folder into which its archive was unpacked.

    Raises
    ------
    LibraryError
        If the file leads out of the folder, is for another machine, or is cut off.
    """
    real = path.resolve()
    if not real.is_relative_to(folder.resolve()) or not real.is_file():
        msg = "leads outside of its archive"
        raise LibraryError(msg)
    kind = _KINDS.get(sys.platform)
    if kind is None:
        return
    with real.open("rb") as file:
        size = file.seek(0, 2)
        try:
            images = list(_READERS[kind](file))
        except (struct.error, ElfError) as failed:
            msg = f"is not a 64-bit {kind} library, or its header is damaged"
            raise LibraryError(msg) from failed
    here = host_machine()
    image = next((i for i in images if i.machine == here), images[0])
    if image.machine != here:
        msg = f"is for {image.machine}, but this machine is {here}"
        raise LibraryError(msg)
    end = max((start + length for start, length in image.stretches), default=0)
    if end > size:
        msg = f"is cut off: its header describes {end} bytes, and the file has {size}"
        raise LibraryError(msg)


def host_machine() -> str:
    """Name of this machine's processor, such as ``x86_64``."""
    name = platform.machine().lower()
    return _NAMES.get(name, name)


def _elf(file: BinaryIO) -> Iterator[_Image]:
    header = read_header(file)
    if not header.loaded:  # an object file, say
        raise struct.error
    yield _Image(header.machine, (*header.tables, *((s.offset, s.size_in_file) for s in header.loaded)))


def _pe(file: BinaryIO) -> Iterator[_Image]:
    """Read the header of a library of Windows (Microsoft PE format, sections 2 to 4)."""
    start = struct.unpack("<2s58xL", _read(file, 0, 64))
    place = start[1] if start[0] == b"MZ" else _MOST**4
    signature, machine, count, more = struct.unpack("<4s2H12xH2x", _read(file, place, 24))
    (magic,) = struct.unpack("<H", _read(file, place + 24, 2))
    if signature != b"PE\0\0" or magic != 0x20B:
        raise struct.error
    table = place + 24 + more
    sections = (struct.unpack("<2L", _read(file, table + 40 * i + 16, 8)) for i in range(min(count, _MOST)))
    stretches = tuple((offset, length) for length, offset in sections)
    yield _Image(_PE_MACHINES.get(machine, f"machine {machine}"), stretches)


def _mach_o(file: BinaryIO) -> Iterator[_Image]:
    """Read the header of a library of macOS, of one processor or of several (Apple, mach-o/loader.h and fat.h)."""
    magic, count = struct.unpack(">2L", _read(file, 0, 8))
    if magic != _FAT:
        yield _mach_o_of_one(file, 0)
        return
    if not 0 < count <= _MOST:
        raise struct.error
    for i in range(count):
        offset, length = struct.unpack(">8x2L", _read(file, 8 + 20 * i, 16))
        image = _mach_o_of_one(file, offset)
        yield _Image(image.machine, (*image.stretches, (offset, length)))


def _mach_o_of_one(file: BinaryIO, start: int) -> _Image:
    magic, machine, count = struct.unpack("<2L8xL", _read(file, start, 20))
    if magic != _MACH_O or count > _MOST:
        raise struct.error
    place, stretches = start + 32, []
    for _ in range(count):
        command, length = struct.unpack("<2L", _read(file, place, 8))
        if command == _SEGMENT:
            offset, size = struct.unpack("<2Q", _read(file, place + 40, 16))
            stretches.append((start + offset, size))
        place += length
    return _Image(_MACH_O_MACHINES.get(machine, f"machine {machine}"), tuple(stretches))


def _read(file: BinaryIO, place: int, length: int) -> bytes:
    """Bytes of a file; fewer at its end, which `struct.unpack` refuses."""
    file.seek(place)
    return file.read(length)


_READERS = {"ELF": _elf, "PE": _pe, "Mach-O": _mach_o}
