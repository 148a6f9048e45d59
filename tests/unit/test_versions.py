"""The record of versions in .ci/versions.txt is whole and names no place; differences are told, one phrase each."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

SCRIPT = Path(__file__).parents[2] / ".ci" / "versions.py"


@pytest.fixture
def versions() -> ModuleType:
    """The script as a module."""
    spec = importlib.util.spec_from_file_location("versions", SCRIPT)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_record_is_names_and_versions_only(versions: ModuleType) -> None:
    text = versions.RECORD.read_text(encoding="utf-8")
    assert all(re.fullmatch(r"[a-z0-9.-]+==[A-Za-z0-9.+!]+", line) for line in text.splitlines())
    recorded = versions.read(text)
    assert {"numpy", "casadi", "ziglang", "pytest"} <= set(recorded)
    assert versions.text_of(recorded) == text


def test_differences_are_told(versions: ModuleType) -> None:
    recorded = {"casadi": "3.7.0", "lxml": "5.3", "numpy": "2.0.1"}
    now = {"casadi": "3.8.2", "numpy": "2.0.1", "rich": "14.0"}
    assert versions.differences(recorded, now) == [
        "casadi is 3.8.2, was 3.7.0",
        "lxml 5.3 is not installed",
        "rich 14.0 is new",
    ]
    assert versions.differences(now, now) == []


def test_a_line_of_another_form_is_refused(versions: ModuleType) -> None:
    with pytest.raises(ValueError, match=r"'numpy>=2' is not of the form name==version"):
        versions.read("numpy>=2\n")


def test_a_difference_is_a_notice_and_no_failure(tmp_path: Path) -> None:
    copy = tmp_path / "versions.py"
    copy.write_text(SCRIPT.read_text(encoding="utf-8"), encoding="utf-8")
    write = subprocess.run([sys.executable, copy, "--write"], capture_output=True, text=True, check=True)
    same = subprocess.run([sys.executable, copy], capture_output=True, text=True, check=True)
    assert (write.stdout, same.stdout) == ("", "")
    record = tmp_path / "versions.txt"
    record.write_text(re.sub(r"numpy==.*", "numpy==0.1", record.read_text(encoding="utf-8")), encoding="utf-8")
    other = subprocess.run([sys.executable, copy], capture_output=True, text=True, check=True)
    assert re.fullmatch(r"Notice: versions differ from \.ci/versions\.txt: numpy is \S+, was 0\.1\.\n", other.stdout)
