"""What a run of the tests left out is said in one line at its end, with what would bring it."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.untested import needs, sentence

MODULE = """
import pytest
from tests.untested import PROPERTY, needs

@pytest.mark.skip(reason=needs("wine is not here", "wine64"))
def test_windows():
    pass

@pytest.fixture
def emulator():
    pytest.skip(needs("qemu is not here", "qemu-user", "libc6-arm64-cross"))

@pytest.mark.usefixtures("emulator")
@pytest.mark.parametrize("n", range(3))
def test_arm(n):
    pass

@pytest.mark.skip(reason="reads the files of macOS")
def test_mac():
    pass

def test_peers(record_property):
    record_property(PROPERTY, needs("a peer does not load", "libtbb12"))
"""
PLUGIN = "from tests.closing_line import pytest_terminal_summary\n"


def test_nothing_is_said_when_nothing_was_left_out() -> None:
    assert sentence([]) == ""


def test_packages_are_named_once_and_in_order() -> None:
    reasons = [needs("a", "wine64"), needs("b", "qemu-user", "clang"), needs("c", "wine64")]
    assert sentence(reasons) == "Not tested here: 3 tests that Debian's packages clang qemu-user wine64 bring."


def test_another_platform_is_told_apart() -> None:
    assert sentence(["reads ELF files"]) == "Not tested here: 1 test for another platform."
    both = sentence(["reads ELF files", needs("a", "gcc")])
    assert both == "Not tested here: 1 test that Debian's packages gcc bring; 1 test for another platform."


@pytest.mark.parametrize("workers", ["0", "2"])
def test_the_end_of_a_run_says_it(tmp_path: Path, workers: str) -> None:
    """Whether a test is skipped by a mark or by a fixture, in this process or in a worker."""
    (tmp_path / "conftest.py").write_text(PLUGIN, encoding="utf-8")
    (tmp_path / "test_some.py").write_text(MODULE, encoding="utf-8")
    command = [sys.executable, "-m", "pytest", "-n", workers, "-p", "no:cacheprovider", "--rootdir", str(tmp_path)]
    root = Path(__file__).parents[2]
    run = subprocess.run([*command, str(tmp_path)], cwd=root, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout
    packages = "libc6-arm64-cross libtbb12 qemu-user wine64"
    said = f"Not tested here: 5 tests that Debian's packages {packages} bring; 1 test for another platform."
    assert run.stdout.splitlines()[-2] == said
