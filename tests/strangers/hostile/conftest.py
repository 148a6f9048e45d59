"""Fixtures: folders for temporary files and caches that a test can look into, and the command line."""

import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.faults.cli import Command, runner


@pytest.fixture
def left_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[], list[str]]:
    """Files and folders outside of ``given`` that a test has left, but for our compiled code and the cache's users."""
    for name in ("given", "temporary", "cache", "work"):
        (tmp_path / name).mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path / "work")
    allowed = {tmp_path / name for name in ("given", "temporary", "cache", "cache/ssp", "work")}

    def found() -> list[str]:
        given, ours = tmp_path / "given", [tmp_path / "cache" / name for name in ("kernel", "users")]
        paths = (p for p in tmp_path.rglob("*") if p not in allowed and not any(map(p.is_relative_to, ours)))
        return sorted(str(p.relative_to(tmp_path)) for p in paths if not (p.is_relative_to(given) and p.is_file()))

    return found


@pytest.fixture
def adaptimp(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """The command line."""
    return runner(monkeypatch, capsys)
