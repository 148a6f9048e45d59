"""Commands in odd surroundings: closed or full output, readers that go away, folders that allow nothing, long names."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from orchestration import Result
from orchestration.results.places import partial_path

if sys.platform == "win32":
    pytest.skip("the shell and the devices of POSIX are needed", allow_module_level=True)

PROGRAM = f"'{sys.executable}' -c 'from orchestration.cli import main; main()'"
SHORT = "run fig2 --stop 0.01 --no-verdict --record plant.x"


def shell(command: str, folder: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Run a shell command in which ADAPTIMP stands for the program; the exit code is that of the program."""
    return subprocess.run(
        ["bash", "-c", f"set -o pipefail; {command.replace('ADAPTIMP', PROGRAM)}"],
        cwd=folder,
        env=os.environ | variables,
        capture_output=True,
        text=True,
        check=False,
    )


def said(done: subprocess.CompletedProcess[str]) -> str:
    """Standard error without the lines on what takes long."""
    return "".join(line for line in done.stderr.splitlines(keepends=True) if not line.endswith(" ...\n"))


@pytest.mark.parametrize("command", ["list", SHORT])
def test_a_closed_output_is_one_sentence(tmp_path: Path, command: str) -> None:
    done = shell(f"ADAPTIMP {command} >&-", tmp_path)
    assert done.returncode == 1
    assert said(done) == "Error: Standard output is closed; redirect it to a file, or to /dev/null.\n"


def test_a_closed_standard_error_changes_nothing(tmp_path: Path) -> None:
    """The file of the rows must not get the number 2, on which an FMU may print."""
    done = shell(f"ADAPTIMP {SHORT} -o x.csv 2>&-", tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(Result.read(tmp_path / "x.csv").time) == 101


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full")
@pytest.mark.parametrize("command", ["list", "--help"])
def test_a_full_output_is_one_sentence(tmp_path: Path, command: str) -> None:
    done = shell(f"ADAPTIMP {command} > /dev/full", tmp_path)
    assert done.returncode == 1
    assert said(done) in (
        "Error: Standard output cannot be written: No space left on device; choose another place for it.\n",
        "Error: No space left on device.\n",
    )


@pytest.mark.parametrize("command", [f"{SHORT} -o x.csv", "info fig5", "list"])
def test_a_reader_that_goes_away_is_no_failure(tmp_path: Path, command: str) -> None:
    done = shell(f"ADAPTIMP {command} | head -1", tmp_path)
    assert (done.returncode, said(done)) == (0, "")
    assert done.stdout.count("\n") == 1
    assert ("x.csv" in command) == (tmp_path / "x.csv").is_file()


@pytest.mark.parametrize("locale", ["C", "tr_TR.UTF-8", "no_such_locale"])
def test_any_locale_will_do(tmp_path: Path, locale: str) -> None:
    done = shell(f"ADAPTIMP {SHORT} -o 'größe.csv'", tmp_path, LC_ALL=locale, PYTHONUTF8="0", PYTHONCOERCECLOCALE="0")
    assert done.returncode == 0, done.stderr
    assert len(list(tmp_path.glob("gr*.csv"))) == 1


def test_names_of_files_may_be_as_long_as_the_system_allows(tmp_path: Path) -> None:
    name = "n" * 251 + ".csv"
    assert shell(f"ADAPTIMP {SHORT} -o {name}", tmp_path).returncode == 0
    assert (tmp_path / name).is_file()
    assert len(partial_path(tmp_path / name).name) == 255
    for suffix in ("csv", "parquet"):
        done = shell(f"ADAPTIMP {SHORT} -o {'n' * 260}.{suffix}", tmp_path)
        assert done.returncode == 1
        assert said(done) == f"Error: {'n' * 260}.{suffix}: File name too long.\n"


def test_long_paths_will_do(tmp_path: Path) -> None:
    folder = tmp_path / ("d" * 120) / ("e" * 120)
    (folder / "temporary").mkdir(parents=True)
    variables = {"ADAPTIMP_CACHE": str(folder / "cache"), "TMPDIR": str(folder / "temporary")}
    shell("ADAPTIMP export fig2 -o x.ssp", folder)
    done = shell("ADAPTIMP run x.ssp --stop 0.01 --no-verdict -o x.parquet", folder, **variables)
    assert done.returncode == 0, done.stderr
    assert len(Result.read(folder / "x.parquet").time) == 101
    assert list((folder / "temporary").iterdir()) == []


@pytest.fixture
def noexec(tmp_path: Path):
    """A file system from which nothing can be run."""
    place = tmp_path / "noexec"
    place.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "noexec", "tmpfs", str(place)]
    if shutil.which("mount") is None or subprocess.run(command, capture_output=True, check=False).returncode != 0:
        pytest.skip("only an administrator can mount a file system")
    yield place
    subprocess.run(["umount", str(place)], check=True)


def test_a_folder_from_which_nothing_runs_is_named(tmp_path: Path, noexec: Path) -> None:
    done = shell(f"ADAPTIMP {SHORT}", tmp_path, TMPDIR=str(noexec))
    assert done.returncode == 2
    assert f"Nothing can be run from {noexec} (noexec), so set TMPDIR to another folder." in said(done)
    assert list(noexec.iterdir()) == []
