"""Tests that a library is loaded only if it is a whole file of this machine, inside of its folder."""

import struct
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from orchestration import ArchiveError, Fmu
from orchestration.check import Severity, check
from orchestration.sandbox import native_library
from orchestration.sandbox.native_library import LibraryError, require_loadable
from tests.faults.cli import Command
from tests.strangers.hostile.archives import DESCRIPTION, LIBRARY, fmu
from tests.strangers.hostile.zips import Row, zipped

pytestmark = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the libraries are made for Linux")
MACHINE, TABLE, SECTIONS, SEGMENT_SIZE, SEGMENTS = 18, 32, 40, 54, 56  # offsets in the header of ELF


def changed(content: bytes, place: int, code: str, value: int) -> bytes:
    """The library with another number in its header."""
    new = bytearray(content)
    struct.pack_into(code, new, place, value)
    return bytes(new)


def pe(machine: int) -> bytes:
    """The header of a library of Windows."""
    return struct.pack("<2s58xL", b"MZ", 64) + struct.pack("<4s2H12xH2xH", b"PE\0\0", machine, 0, 240, 0x20B)


def mach_o(machine: int, size: int = 0) -> bytes:
    """The header of a library of macOS with one segment."""
    return struct.pack("<2L8xL12x", 0xFEEDFACF, machine, 1) + struct.pack("<2L32x2Q", 0x19, 72, 0, size)


LIBRARIES: dict[str, tuple[Callable[[bytes], bytes], str]] = {
    "half": (lambda whole: whole[: len(whole) // 2], "is cut off: its header describes"),
    "all but the last byte": (lambda whole: whole[:-1], "is cut off: its header describes"),
    "a header alone": (lambda whole: whole[:64], "its header is damaged"),
    "nothing": (lambda _: b"", "is not a 64-bit ELF library"),
    "text": (lambda _: b"no library", "is not a 64-bit ELF library"),
    "of 32 bits": (lambda whole: changed(whole, 4, "B", 1), "is not a 64-bit ELF library"),
    "big-endian": (lambda whole: changed(whole, 5, "B", 2), "is not a 64-bit ELF library"),
    "of another processor": (
        lambda whole: changed(whole, MACHINE, "<H", 243),
        "is for machine 243, but this machine is",
    ),
    "of Windows": (lambda _: pe(0x8664), "is not a 64-bit ELF library"),
    "of macOS": (lambda _: mach_o(0x01000007), "is not a 64-bit ELF library"),
    "segments of one byte": (lambda whole: changed(whole, SEGMENT_SIZE, "<H", 1), "its header is damaged"),
    "segments nowhere": (lambda whole: changed(whole, TABLE, "<Q", 2**64 - 1), "its header is damaged"),
    "65535 segments": (lambda whole: changed(whole, SEGMENTS, "<H", 65535), "is cut off|its header is damaged"),
    "sections nowhere": (lambda whole: changed(whole, SECTIONS, "<Q", 2**62), "is cut off: its header describes"),
}


@pytest.mark.parametrize("name", LIBRARIES)
def test_it_is_not_loaded(name: str, libraries, tmp_path: Path, adaptimp: Command, left_over) -> None:
    make, rule = LIBRARIES[name]
    path = tmp_path / "given" / "hostile.fmu"
    path.write_bytes(zipped([DESCRIPTION, Row(LIBRARY, make(libraries["whole"].read_bytes()))]))
    with pytest.raises(ArchiveError, match=rf"hostile\.fmu cannot be loaded: the library '{LIBRARY}' .*({rule})"):
        Fmu(path)
    findings = [f.message for f in check(path).findings if f.severity == Severity.ERROR]
    assert any(LIBRARY in message for message in findings), findings
    outcome = adaptimp("run", path, "--step", 0.1, "--stop", 1)
    assert outcome.code == 2
    assert LIBRARY in outcome.sentence
    assert not left_over()


def test_a_folder_in_its_place_is_not_loaded(tmp_path: Path, left_over) -> None:
    path = tmp_path / "given" / "hostile.fmu"
    path.write_bytes(zipped([DESCRIPTION, Row(f"{LIBRARY}/", b"")]))
    with pytest.raises(ArchiveError, match="has no binary for"):
        Fmu(path)
    assert not left_over()


def test_it_must_lie_inside(tmp_path: Path, libraries) -> None:
    folder = tmp_path / "unpacked"
    folder.mkdir()
    (folder / "library").symlink_to(libraries["whole"])
    with pytest.raises(LibraryError, match="leads outside of its archive"):
        require_loadable(folder / "library", folder)


@pytest.mark.parametrize(
    ("system", "content", "rule"),
    [
        ("win32", pe(0xAA64), "is for aarch64, but this machine is x86_64"),
        ("win32", b"MZ" + bytes(62), "is not a 64-bit PE library"),
        ("win32", pe(0x8664)[:70], "is not a 64-bit PE library"),
        ("darwin", mach_o(0x0100000C), "is for aarch64, but this machine is x86_64"),
        ("darwin", mach_o(0x01000007, 10_000), "is cut off: its header describes 10000 bytes, and the file has 88"),
        ("darwin", struct.pack(">7L", 0xCAFEBABE, 1, 0, 0, 2**31, 5, 0), "is not a 64-bit Mach-O library"),
    ],
)
def test_other_systems(system: str, content: bytes, rule: str, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(native_library.sys, "platform", system)
    monkeypatch.setattr(native_library.platform, "machine", lambda: "AMD64")
    (tmp_path / "library").write_bytes(content)
    with pytest.raises(LibraryError, match=rule):
        require_loadable(tmp_path / "library", tmp_path)


@pytest.mark.parametrize("system", ["win32", "darwin"])
def test_whole_libraries_of_other_systems_pass(system: str, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(native_library.sys, "platform", system)
    monkeypatch.setattr(native_library.platform, "machine", lambda: "x86_64")
    whole = (
        pe(0x8664) if system == "win32" else struct.pack(">7L", 0xCAFEBABE, 1, 0, 0, 28, 88, 0) + mach_o(0x01000007, 60)
    )
    (tmp_path / "library").write_bytes(whole)
    require_loadable(tmp_path / "library", tmp_path)


def test_an_fmu_of_text_is_refused_before_anything_is_loaded(tmp_path: Path, left_over) -> None:
    path = tmp_path / "given" / "text.fmu"
    path.write_bytes(fmu())
    with pytest.raises(ArchiveError, match="is not a 64-bit ELF library"):
        Fmu(path)
    assert not left_over()
