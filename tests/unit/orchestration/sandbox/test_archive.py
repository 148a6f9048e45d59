"""Tests that unsafe archives are refused, with the entry and the rule, and are not unpacked."""

import stat
import struct
import tempfile
import warnings
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path
from zipfile import ZIP_DEFLATED

import pytest

from orchestration import ArchiveError
from orchestration.sandbox import archive
from orchestration.sandbox.zip.rules import MAX_ENTRIES

CENTRAL, FLAGS, METHOD, SIZE = b"PK\x01\x02", 8, 10, 24  # a directory entry's signature, and offsets in it
NEEDED = 6  # offset of the version needed to extract
Make = Callable[[Path], object]


@pytest.fixture(autouse=True)
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Put temporary folders into the folder of the test, where the test can find them."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def packed(entries: Sequence[tuple[str | zipfile.ZipInfo, bytes]], method: int = ZIP_DEFLATED) -> Make:
    """Return a function that makes an archive of entries; an entry may occur twice."""

    def make(path: Path) -> None:
        with warnings.catch_warnings(), zipfile.ZipFile(path, "w", method) as new:
            warnings.simplefilter("ignore")  # zipfile warns of duplicate names
            for name, content in entries:
                new.writestr(name, content)

    return make


def named(name: str) -> Make:
    """Return a function that makes an archive with one good entry and one entry of a given name."""
    return packed([("good.txt", b"good"), (name, b"bad")])


def special(kind: int) -> Make:
    """Return a function that makes an archive with a link or device."""
    info = zipfile.ZipInfo("link")
    info.external_attr = (kind | 0o777) << 16
    return packed([(info, b"/etc/passwd")])


def patched(offset: int, code: str, value: int, content: bytes = b"good") -> Make:
    """Return a function that makes an archive whose directory has a wrong number for its only entry."""

    def make(path: Path) -> None:
        packed([("good.txt", content)])(path)
        data = bytearray(path.read_bytes())
        struct.pack_into(code, data, data.index(CENTRAL) + offset, value)
        path.write_bytes(data)

    return make


def packed_large(path: Path) -> None:
    """Write an archive of 1025 entries that claim 2 MiB each, from 3 kB."""
    with zipfile.ZipFile(path, "w") as new:
        for i in range(1025):
            new.writestr(f"{i}", b"x" * 3000)
    data, claimed = bytearray(path.read_bytes()), struct.pack("<I", 2**21)
    for signature, method, size in ((CENTRAL, METHOD, SIZE), (b"PK\x03\x04", 8, 22)):
        place = data.find(signature)
        while place >= 0:
            data[place + method] = ZIP_DEFLATED
            data[place + size : place + size + 4] = claimed
            place = data.find(signature, place + 4)
    path.write_bytes(data)


def cut(path: Path) -> None:
    """Write the first half of an archive."""
    packed([("good.txt", bytes(range(256)) * 40)])(path)
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def damaged(path: Path) -> None:
    """Write an archive with damaged compressed data."""
    packed([("good.txt", bytes(range(256)) * 40)])(path)
    data = bytearray(path.read_bytes())
    data[40:60] = b"\xff" * 20
    path.write_bytes(data)


REFUSED: dict[str, tuple[Make, str]] = {
    "parent": (named("../evil.txt"), r"entry '\.\./evil\.txt' leads outside the archive"),
    "parent inside": (named("a/../../evil.txt"), r"entry 'a/\.\./\.\./evil\.txt' leads outside"),
    "absolute": (named("/tmp/evil.txt"), r"entry '/tmp/evil\.txt' leads outside"),
    "backslash": (named("..\\evil.txt"), r"evil\.txt' has a character that a path in an archive must not"),
    "drive": (named("C:evil.txt"), r"entry 'C:evil\.txt' has a character"),
    "symlink": (special(stat.S_IFLNK), r"entry 'link' is a link or device"),
    "device": (special(stat.S_IFCHR), r"entry 'link' is a link or device"),
    "fifo": (special(stat.S_IFIFO), r"entry 'link' is a link or device"),
    "twice": (packed([("a.txt", b"1"), ("a.txt", b"2")]), r"entry 'a\.txt' occurs more than once"),
    "twice by case": (packed([("a.txt", b"1"), ("A.TXT", b"2")]), r"entry 'A\.TXT' occurs more than once"),
    "twice by dot": (packed([("a.txt", b"1"), ("./a.txt", b"2")]), r"'\./a\.txt' occurs more than once"),
    "twice by slash": (packed([("a/b", b"1"), ("a//b", b"2")]), r"entry 'a//b' occurs more than once"),
    "encrypted": (patched(FLAGS, "<H", 1), r"entry 'good\.txt' is encrypted"),
    "lzma": (packed([("good.txt", b"x" * 99)], zipfile.ZIP_LZMA), r"method 14; only store and deflate"),
    "bzip2": (packed([("good.txt", b"x" * 99)], zipfile.ZIP_BZIP2), r"compression method 12"),
    "unknown method": (patched(METHOD, "<H", 97), r"compression method 97"),
    "bomb": (packed([("zeros", bytes(4 * 2**20))]), r"unpacks from 4\d\d\d to 4194304 bytes, a zip bomb"),
    "too large": (packed_large, r"would unpack to 2149580800 bytes, more than 2147483648"),
    "too many": (
        packed([(f"{i}", b"") for i in range(MAX_ENTRIES + 1)]),
        r"has 20001 entries, more than 20000",
    ),
    "understated size": (patched(SIZE, "<I", 2, b"x" * 5000), r"'good\.txt' two values for its size: 5000 and 2"),
    "damaged": (damaged, r"cannot be unpacked"),
    "cut": (cut, r"is not a readable zip archive"),
    "future version": (patched(NEEDED, "<H", 99), r"not a readable .*: entry 'good\.txt' needs version 9\.9"),
    "text": (lambda path: path.write_text("no zip"), r"is not a readable zip archive"),
    "empty": (lambda path: path.write_bytes(b""), r"is not a readable zip archive"),
    "file and folder": (packed([("a", b"1"), ("a/b", b"2")]), r"entry 'a/b' lies in 'a', which is a file"),
    "folder": (Path.mkdir, r"is a folder; give the path of a \.zip file"),
    "missing": (lambda _: None, r"there is no such file"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_unsafe_archives_are_refused(tmp_path: Path, case: str) -> None:
    make, rule = REFUSED[case]
    path = tmp_path / "strange.zip"
    make(path)
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(ArchiveError, match=rf"strange\.zip.*{rule}"), archive.unpacked(path):
        pytest.fail("unpacked")
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("case", sorted(set(REFUSED) - {"damaged"}))
def test_screening_alone_finds_them(tmp_path: Path, case: str) -> None:
    """Screening does not unpack data, so the fault in the data itself is left out."""
    make, rule = REFUSED[case]
    make(tmp_path / "strange.zip")
    with pytest.raises(ArchiveError, match=rule):
        archive.screen(tmp_path / "strange.zip")


def test_a_good_archive_is_unpacked_and_removed(tmp_path: Path, temporary: Path) -> None:
    path = tmp_path / "good.zip"
    info = zipfile.ZipInfo("a/b/run.sh")
    info.external_attr = (stat.S_IFREG | 0o755) << 16
    packed([("a/", b""), (info, b"text"), ("zeros", bytes(2**20))])(path)  # the ratio of small files is not limited
    archive.screen(path)
    with archive.unpacked(path) as folder:
        assert folder.is_relative_to(temporary)
        assert (folder / "a/b/run.sh").read_bytes() == b"text"
        assert (folder / "zeros").stat().st_size == 2**20
    assert not list(temporary.iterdir())
