"""What a process leaves is removed, however deep it is, and links out of it are not followed."""

import os
import sys
from pathlib import Path

import pytest

from orchestration.sandbox import leftovers
from orchestration.sandbox.leftovers import empty, files_in

DEPTH = 1500  # folders, more than Python recurses into, and four times what a path may hold


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An empty folder."""
    found = tmp_path / "left"
    found.mkdir()
    return found


@pytest.mark.skipif(sys.platform == "win32", reason="paths of Windows are shorter")
def test_folders_in_folders(folder: Path) -> None:
    here = Path.cwd()
    os.chdir(folder)
    try:
        for _ in range(DEPTH):
            os.mkdir("deep-folder")
            os.chdir("deep-folder")
        Path("file").write_text("x")
    finally:
        os.chdir(here)
    assert len(list(files_in(folder))) == 0, "it is deeper than a path can say"
    empty(folder)
    assert list(folder.iterdir()) == []


def test_files_are_counted_and_links_are_left_alone(folder: Path, tmp_path: Path) -> None:
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept" / "file").write_text("abc")
    (folder / "sub").mkdir()
    (folder / "sub" / "one").write_text("ab")
    (folder / "two").write_text("abcd")
    if sys.platform != "win32":
        (folder / "link").symlink_to(tmp_path / "kept", target_is_directory=True)
        (folder / "loop").symlink_to(folder, target_is_directory=True)
    sizes = {path.name: size for path, size in files_in(folder)}
    assert (sizes["one"], sizes["two"]) == (2, 4)
    assert "file" not in sizes
    empty(folder)
    assert list(folder.iterdir()) == []
    assert (tmp_path / "kept" / "file").read_text() == "abc"


def test_a_locked_folder(folder: Path) -> None:
    (folder / "locked").mkdir()
    (folder / "locked" / "file").write_text("x")
    (folder / "locked").chmod(0)
    empty(folder)
    assert list(folder.iterdir()) == []


def test_more_files_than_are_looked_at(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(leftovers, "MOST_FILES", 5)
    for i in range(23):
        (folder / str(i)).write_text("x")
    assert len(list(files_in(folder))) == 5
    empty(folder)
    assert list(folder.iterdir()) == []
