"""Tests that an FMU's library is found, loaded and unloaded, and that a failure leaves nothing behind."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from orchestration import ArchiveError, InitializationError, simulate
from orchestration.check import check
from orchestration.fmi import logging
from orchestration.fmi.description import read_description
from orchestration.fmi.instance import Instance
from orchestration.fmi.library import library_path, needed_to_run
from orchestration.sandbox.archive import unpacked
from tests.unit.orchestration.checked import edited, swap
from tests.unit.orchestration.fmi.test_description import rewritten
from tests.unit.orchestration.small_models import system

on_linux = pytest.mark.skipif(sys.platform != "linux", reason="/proc/self/maps tells which libraries are loaded")


def test_missing_binary_names_the_platforms(small: dict[str, Path], tmp_path: Path) -> None:
    bare = rewritten(small["Source"], tmp_path / "bare.fmu", str, drop="binaries/")
    with pytest.raises(ArchiveError, match=r"bare\.fmu has no binary for \S+, this machine; it has none"):
        simulate(system({"Source": bare}, {"source": "Source"}))
    with zipfile.ZipFile(bare, "a") as archive_:
        archive_.writestr("binaries/linux64/", b"")  # SimulationX writes empty folders for other platforms
        archive_.writestr("binaries/beos64/Source.so", b"")
    with pytest.raises(ArchiveError, match=r"bare\.fmu has no binary for \S+, this machine; it has beos64\."):
        simulate(system({"Source": bare}, {"source": "Source"}))


def test_a_binary_that_is_none_is_named(small: dict[str, Path], tmp_path: Path) -> None:
    with zipfile.ZipFile(small["Source"]) as old:
        (library,) = [name for name in old.namelist() if name.startswith("binaries/")]
    broken = rewritten(small["Source"], tmp_path / "broken.fmu", str, drop="binaries/")
    with zipfile.ZipFile(broken, "a") as new:
        new.writestr(library, b"not a library")
    with pytest.raises(ArchiveError, match=r"source: broken\.fmu cannot be loaded: the library '.*' is not a 64-bit"):
        simulate(system({"Source": broken}, {"source": "Source"}))


def test_a_missing_function_is_named(small: dict[str, Path], tmp_path: Path) -> None:
    """Before anything of it is called."""
    code = tmp_path / "empty.c"
    code.write_text("int nothing;\n")
    with zipfile.ZipFile(small["Source"]) as old:
        (library,) = [name for name in old.namelist() if name.startswith("binaries/")]
    hollow = rewritten(small["Source"], tmp_path / "hollow.fmu", str, drop="binaries/")
    with zipfile.ZipFile(hollow, "a") as new:
        new.write(_shared(code, tmp_path), library)
    with pytest.raises(ArchiveError, match=r"its library does not export fmi2Instantiate, .*fmi2DoStep, .* more\."):
        simulate(system({"Source": hollow}, {"source": "Source"}))


def _shared(code: Path, folder: Path) -> Path:
    library = folder / "empty.so"
    command = [sys.executable, "-m", "ziglang", "cc", "-shared", "-o", str(library), str(code)]
    subprocess.run(command, check=True, capture_output=True)
    return library


def test_the_working_directory_stays_while_a_library_loads(
    small: dict[str, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """All threads share it: one that opens a relative path meanwhile would miss."""

    def chdir(_: object) -> None:
        raise AssertionError("the working directory was changed")

    monkeypatch.setattr(os, "chdir", chdir)
    simulate(system(small, {"source": "Source"}))


@on_linux
def test_a_library_is_unloaded_if_it_does_not_instantiate(small: dict[str, Path], tmp_path: Path) -> None:
    """Else the folder could not be removed on Windows, and that error would hide the message."""
    path = edited(small["Source"], tmp_path, swap('guid="', 'guid="0'))
    description = read_description(path)
    with unpacked(path, needed_to_run) as folder:
        with pytest.raises(InitializationError, match=r'odd: fmi2Instantiate failed; its last message: ".*GUID'):
            Instance.open("odd", description, folder)
        assert str(library_path(folder, description)) not in Path("/proc/self/maps").read_text()


@on_linux
def test_closing_unloads_the_library(small: dict[str, Path]) -> None:
    description = read_description(small["Source"])
    with unpacked(small["Source"], needed_to_run) as folder:
        loaded = str(library_path(folder, description))
        instance = Instance.open("one", description, folder)
        assert loaded in Path("/proc/self/maps").read_text()
        instance.close()
        instance.close()
        assert loaded not in Path("/proc/self/maps").read_text()


def test_another_platform_is_named(small: dict[str, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "freebsd14")
    with pytest.raises(ArchiveError, match=r"platform freebsd14, this machine; FMUs run on linux, darwin, win32\."):
        library_path(Path(), read_description(small["Source"]))
    findings = check(small["Source"]).findings
    assert [f.rule for f in findings if "freebsd14" in f.message] == ["6"]


@pytest.mark.parametrize("content", [None, b"not a library"])
def test_messages_do_without_a_proxy_that_is_missing_or_does_not_load(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, content: bytes | None
) -> None:
    """Linux on ARM has only that for another processor."""
    proxy = tmp_path / "logging.so"
    if content is not None:
        proxy.write_bytes(content)
    monkeypatch.setattr(logging, "standard_file", lambda *_: proxy)
    assert logging._proxy.__wrapped__() is None
    monkeypatch.undo()
    assert logging._proxy.__wrapped__() is not None
