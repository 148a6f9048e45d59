"""Tests that ``adaptimp build --platform all`` builds FMUs for all platforms, and the same bytes again."""

import zipfile
from collections.abc import Callable
from pathlib import Path, PurePosixPath

import pytest

from adaptimp_fmu import ToolchainError, build, host_platform
from adaptimp_fmu.toolchain import PLATFORMS, compile_library
from fmus.catalog import MODELS
from tests.conformance.container import CONTAINER
from tests.conformance.platforms.conftest import build_all

SIZE_LIMIT = 150_000  # bytes; Linux has 25 to 58 kB, Windows up to 124 kB with the C runtime of MinGW
CONTAINER_LIMIT = 400_000  # bytes
# Bytes differ by what the linker adds, not by the equations: the smallest and the largest FMU show it.
COMPILED_AGAIN = ("VirtualTrajectory", "SpongOrtegaAdaptiveImpedance")


def test_07_every_platform_is_in_every_fmu(portable: Path) -> None:
    assert {path.name for path in portable.iterdir()} == {f"{identifier}.fmu" for identifier in MODELS}
    for identifier in MODELS:
        with zipfile.ZipFile(portable / f"{identifier}.fmu") as archive:
            binaries = {name for name in archive.namelist() if name.startswith("binaries/")}
        assert binaries == {f"binaries/{p.name}/{identifier}{p.extension}" for p in PLATFORMS.values()}


def test_07_description_and_sources_are_those_of_one_platform(
    portable_file: Callable[[str], Path], identifier: str, fmu: Path
) -> None:
    """The GUID is that of the definition, whatever the platforms."""
    with zipfile.ZipFile(portable_file(identifier)) as all_of_them, zipfile.ZipFile(fmu) as one:
        for name in one.namelist():
            assert all_of_them.read(name) == one.read(name), name


@pytest.mark.parametrize("platform", PLATFORMS)
def test_07_binaries_are_small(content: Callable[[str, str], bytes], identifier: str, platform: str) -> None:
    assert len(content(identifier, platform)) < (CONTAINER_LIMIT if identifier == CONTAINER else SIZE_LIMIT)


def test_07_every_platform_is_in_the_container(portable_file: Callable[[str], Path]) -> None:
    with zipfile.ZipFile(portable_file(CONTAINER)) as archive:
        binaries = {name for name in archive.namelist() if name.startswith("binaries/")}
    assert binaries == {f"binaries/{p.name}/{CONTAINER}{p.extension}" for p in PLATFORMS.values()}


def test_07_second_build_compiles_and_writes_nothing(
    portable: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It succeeds although the compiler cannot work: its cache folders are files."""
    broken = tmp_path / "file"
    broken.touch()
    without_compiler = {"ZIG_GLOBAL_CACHE_DIR": str(broken), "ZIG_LOCAL_CACHE_DIR": str(broken)}
    before = {path.name: path.stat() for path in portable.iterdir()}
    run = build_all(portable, without_compiler)
    assert run.returncode == 0, run.stderr
    after = {path.name: path.stat() for path in portable.iterdir()}
    assert {n: (s.st_ino, s.st_mtime_ns) for n, s in after.items()} == {
        n: (s.st_ino, s.st_mtime_ns) for n, s in before.items()
    }
    for name, value in without_compiler.items():
        monkeypatch.setenv(name, value)
    with pytest.raises(ToolchainError):  # else the above shows nothing
        build(MODELS["ForceSensor"](), tmp_path, cache=tmp_path / "cache")


@pytest.mark.parametrize("platform", [name for name in PLATFORMS if name != host_platform().name])
@pytest.mark.parametrize("identifier", COMPILED_AGAIN)
def test_07_compiler_gives_the_same_bytes(
    portable: Path,
    content: Callable[[str, str], bytes],
    identifier: str,
    platform: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The archive's sources, compiled elsewhere with empty caches, give the archive's binary.

    This machine's platform is in ``tests/conformance/test_archive.py``, for every FMU.
    """
    monkeypatch.setenv("ZIG_LOCAL_CACHE_DIR", str(tmp_path / "zig"))
    sources = tmp_path / "sources"
    sources.mkdir()
    with zipfile.ZipFile(portable / f"{identifier}.fmu") as archive:
        for name in archive.namelist():
            if name.startswith("sources/"):
                (sources / PurePosixPath(name).name).write_bytes(archive.read(name))
    output = tmp_path / f"{identifier}{PLATFORMS[platform].extension}"
    compile_library(sources / "model.c", output, PLATFORMS[platform])
    assert any((tmp_path / "zig").rglob("*.o*")), "nothing was compiled"
    assert output.read_bytes() == content(identifier, platform)
