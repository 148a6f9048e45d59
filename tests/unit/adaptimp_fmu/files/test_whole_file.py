"""Files that are whole or absent, and sealed files of a cache."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from adaptimp_fmu.files import cache_folder
from adaptimp_fmu.files.sealed_file import SEAL_BYTES, read_sealed, write_sealed
from adaptimp_fmu.files.whole_file import LONGEST_NAME, Draft, whole_file, write_together, write_whole

WITH_LOCKS = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL and no locks of this kind")
WITH_OWNERS = pytest.mark.skipif(not hasattr(os, "getuid"), reason="only POSIX has owners and modes of files")


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_failure_leaves_the_old_file(tmp_path: Path) -> None:
    (tmp_path / "x").write_text("old")

    def fail() -> None:
        with whole_file(tmp_path / "x") as file:
            file.write(b"half")
            raise ValueError("half-way")

    with pytest.raises(ValueError, match="half-way"):
        fail()
    assert names(tmp_path) == ["x"]
    assert (tmp_path / "x").read_text() == "old"


def test_files_that_belong_together_are_written_together(tmp_path: Path) -> None:
    write_together({tmp_path / "x": b"1", tmp_path / "new" / "y": b"2"})
    assert [(tmp_path / "x").read_bytes(), (tmp_path / "new" / "y").read_bytes()] == [b"1", b"2"]


@pytest.mark.parametrize("last", ["folder", "n" * (LONGEST_NAME + 1)])
def test_of_files_that_belong_together_none_is_written_if_one_cannot_be(tmp_path: Path, last: str) -> None:
    (tmp_path / "x").write_text("old")
    (tmp_path / "folder").mkdir()
    with pytest.raises(OSError, match=r"directory|too long"):
        write_together({tmp_path / "x": b"new", tmp_path / last: b"new"})
    assert names(tmp_path) == ["folder", "x"]
    assert (tmp_path / "x").read_text() == "old"


def test_two_writers_give_the_later_one_whole(tmp_path: Path) -> None:
    first, second = Draft(tmp_path / "x"), Draft(tmp_path / "x")
    first.file.write(b"one")
    second.file.write(b"two")
    second.publish()
    assert (tmp_path / "x").read_bytes() == b"two"
    first.publish()
    assert (tmp_path / "x").read_bytes() == b"one"
    assert names(tmp_path) == ["x"]


@WITH_LOCKS
def test_the_draft_of_a_killed_process_goes_with_the_next_write(tmp_path: Path) -> None:
    program = (
        "import os, signal, sys; from pathlib import Path; from adaptimp_fmu.files.whole_file import Draft;"
        " Draft(Path(sys.argv[1])); os.kill(os.getpid(), signal.SIGKILL)"
    )
    subprocess.run([sys.executable, "-c", program, str(tmp_path / "x")], check=False)
    assert [name for name in names(tmp_path) if name.startswith("x.") and name.endswith(".part")]
    living = Draft(tmp_path / "x")
    write_whole(tmp_path / "x", b"new")
    assert names(tmp_path) == sorted(["x", living.place.name])
    living.abandon()
    assert names(tmp_path) == ["x"]


def test_a_draft_of_another_file_stays(tmp_path: Path) -> None:
    (tmp_path / "x.y.0123456789ab.part").write_text("of x.y")
    (tmp_path / "x.part").write_text("of the user")
    write_whole(tmp_path / "x", b"new")
    assert names(tmp_path) == ["x", "x.part", "x.y.0123456789ab.part"]


@pytest.mark.parametrize("letter", ["a", "ü"])
def test_the_longest_name_can_be_written(tmp_path: Path, letter: str) -> None:
    path = tmp_path / (letter * (LONGEST_NAME // len(letter.encode())))
    write_whole(path, b"content")
    assert names(tmp_path) == [path.name]


@WITH_OWNERS
def test_the_mask_of_the_process_holds(tmp_path: Path) -> None:
    before = os.umask(0o077)
    try:
        write_whole(tmp_path / "x", b"content")
    finally:
        os.umask(before)
    assert (tmp_path / "x").stat().st_mode & 0o777 == 0o600


@pytest.mark.parametrize("damage", ["emptied", "cut off", "altered"])
def test_a_damaged_file_of_a_cache_counts_as_missing(tmp_path: Path, damage: str) -> None:
    assert read_sealed(tmp_path / "kept") is None
    write_sealed(tmp_path / "kept", b"machine code")
    whole = (tmp_path / "kept").read_bytes()
    assert len(whole) == len(b"machine code") + SEAL_BYTES
    assert read_sealed(tmp_path / "kept") == b"machine code"
    (tmp_path / "kept").write_bytes({"emptied": b"", "cut off": whole[:-1], "altered": b"X" + whole[1:]}[damage])
    assert read_sealed(tmp_path / "kept") is None


@WITH_OWNERS
def test_a_file_of_another_user_counts_as_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_sealed(tmp_path / "kept", b"machine code")
    owner = (tmp_path / "kept").stat().st_uid
    if owner == 0:
        os.chown(tmp_path / "kept", 12345, -1)
    else:
        monkeypatch.setattr(cache_folder.os, "getuid", lambda: owner + 1)
    assert read_sealed(tmp_path / "kept") is None
