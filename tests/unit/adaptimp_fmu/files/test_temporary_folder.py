"""Temporary folders that neither an error nor a killed process leaves behind."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from adaptimp_fmu.files import temporary_folder as module
from adaptimp_fmu.files.temporary_folder import remove_all, sweep, temporary_folder

PATIENCE = 120.0  # s that another process may take to start on a machine that is busy
WITH_LOCKS = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGKILL and no locks of this kind")
OWNER = """
import sys
from pathlib import Path
from adaptimp_fmu.files.temporary_folder import temporary_folder
with temporary_folder(Path(sys.argv[1])) as folder:
    (folder / "inside").mkdir()
    (folder / "inside" / "x").write_text("x")
    print(folder, flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def owner(tmp_path: Path):
    """A process that has a temporary folder, and the folder."""
    command = [sys.executable, "-c", OWNER, str(tmp_path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        yield process, Path(process.stdout.readline().strip())
        process.kill()


def test_nothing_is_left(tmp_path: Path) -> None:
    def fail() -> None:
        with temporary_folder(tmp_path) as folder:
            assert folder.is_dir()
            assert folder.parent == tmp_path
            raise ValueError("inside")

    with pytest.raises(ValueError, match="inside"):
        fail()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="only POSIX has modes of folders")
@pytest.mark.parametrize("mask", [0o000, 0o077, 0o777])
def test_nobody_else_can_read_it_under_any_mask(tmp_path: Path, mask: int) -> None:
    before = os.umask(mask)
    try:
        with temporary_folder(tmp_path) as folder:
            assert folder.stat().st_mode & 0o777 == 0o700
    finally:
        os.umask(before)
    assert list(tmp_path.iterdir()) == []


def test_folders_that_nobody_may_write_to_are_removed(tmp_path: Path) -> None:
    with temporary_folder(tmp_path) as folder:
        (folder / "inside").mkdir()
        (folder / "inside" / "x").write_text("x")
        (folder / "inside").chmod(0o500)
    assert list(tmp_path.iterdir()) == []


@WITH_LOCKS
def test_the_folder_of_a_living_process_stays_and_that_of_a_killed_one_goes(tmp_path: Path, owner) -> None:
    process, folder = owner
    sweep(tmp_path)
    assert (folder / "inside" / "x").is_file()
    process.kill()
    process.wait(PATIENCE)
    assert folder.is_dir()
    sweep(tmp_path)
    assert list(tmp_path.iterdir()) == []


@WITH_LOCKS
def test_the_first_folder_of_a_process_sweeps(tmp_path: Path, owner, monkeypatch: pytest.MonkeyPatch) -> None:
    process, left = owner
    process.kill()
    process.wait(PATIENCE)
    monkeypatch.setattr(module, "_swept", set())
    with temporary_folder(tmp_path) as folder:
        assert sorted(path.name for path in tmp_path.iterdir()) == [folder.name, f"{folder.name}.lock"]
    assert not left.exists()


def test_all_folders_of_a_process_can_be_removed_at_once(tmp_path: Path) -> None:
    with temporary_folder(tmp_path) as one, temporary_folder(tmp_path) as other:
        remove_all()
        assert not one.exists()
        assert not other.exists()
    assert list(tmp_path.iterdir()) == []


@WITH_LOCKS
def test_links_are_not_followed(tmp_path: Path) -> None:
    """Whoever can write to the folder for temporary files must not make us remove something elsewhere."""
    precious, place = tmp_path / "precious", tmp_path / "place"
    precious.mkdir()
    place.mkdir()
    (precious / "x").write_text("x")
    (place / "adaptimp-0123456789ab").symlink_to(precious)
    (place / "adaptimp-0123456789ab.lock").touch()
    (place / "adaptimp-ba9876543210.lock").symlink_to(precious / "x")
    sweep(place)
    assert (precious / "x").read_text() == "x"


@WITH_LOCKS
def test_a_process_that_was_forked_leaves_the_folder_of_its_parent(tmp_path: Path) -> None:
    program = """
import os, sys
from pathlib import Path
from adaptimp_fmu.files.temporary_folder import remove_all, temporary_folder
with temporary_folder(Path(sys.argv[1])) as folder:
    if os.fork() == 0:
        remove_all()
        os._exit(0)
    os.wait()
    print(folder.is_dir())
"""
    done = subprocess.run([sys.executable, "-c", program, str(tmp_path)], capture_output=True, text=True, check=True)
    assert done.stdout == "True\n"
