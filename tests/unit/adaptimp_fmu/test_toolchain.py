"""Tests of the compiler of FMUs, and of its cache."""

import os
import sys
import zipfile
from pathlib import Path

import pytest

from adaptimp_fmu import (
    PLATFORMS,
    SampledModel,
    ToolchainError,
    binary,
    build,
    default_cache,
    host_platform,
    toolchain,
)
from adaptimp_fmu.toolchain import compile_library


def gain(factor: float = 2.0) -> SampledModel:
    """A model that multiplies: y = factor u."""
    model = SampledModel("Gain", "Multiplies")
    model.output("y", factor * model.input("u", 1.0, description="Input"), description="Output")
    return model


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Platforms the compiler is called for; it writes a file that only looks like a binary."""
    calls: list[str] = []

    def compile_nothing(sources: list[Path], output: Path, target: toolchain.Platform, _libraries: object) -> None:
        calls.append(target.name)
        output.write_bytes(f"{target.name} {sources[0].read_text()}".encode())

    monkeypatch.setattr(binary, "compile_library", compile_nothing)
    return calls


def test_broken_c_is_reported_with_the_compilers_words(tmp_path: Path) -> None:
    source = tmp_path / "broken.c"
    source.write_text("int f(void) { return undeclared_thing; }\n")
    with pytest.raises(ToolchainError) as caught:
        compile_library(source, tmp_path / "broken.so", host_platform())
    message = str(caught.value)
    assert message.startswith(f"broken.c does not compile for {host_platform().name}:")
    assert "undeclared_thing" in message
    assert "broken.c:1" in message
    assert not (tmp_path / "broken.so").exists()


def test_several_files_become_one_library(tmp_path: Path) -> None:
    (tmp_path / "units").mkdir()
    (tmp_path / "one.c").write_text("int two(void); int one(void); int one(void) { return two() - 1; }\n")
    (tmp_path / "units" / "two.c").write_text("int two(void); int two(void) { return 2; }\n")
    compile_library([tmp_path / "one.c", tmp_path / "units" / "two.c"], tmp_path / "both.so", host_platform())
    assert (tmp_path / "both.so").exists()


@pytest.mark.parametrize("warning", ["int f(int x) { if (x = 1) return 2; return 3; }", "int f(void) { }"])
def test_warnings_are_errors(tmp_path: Path, warning: str) -> None:
    source = tmp_path / "sloppy.c"
    source.write_text(warning + "\n")
    with pytest.raises(ToolchainError, match=r"sloppy\.c"):
        compile_library(source, tmp_path / "sloppy.so", host_platform())


def test_a_missing_compiler_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    source = tmp_path / "good.c"
    source.write_text("int f(void);\nint f(void) { return 0; }\n")
    empty = tmp_path / "python"
    empty.write_text("#!/bin/sh\necho no module named ziglang >&2\nexit 1\n")
    empty.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(empty))
    with pytest.raises(ToolchainError, match="no module named ziglang"):
        compile_library(source, tmp_path / "good.so", host_platform())


@pytest.mark.parametrize(
    ("system", "machine", "name"),
    [
        ("linux", "x86_64", "linux64"),
        ("linux", "aarch64", "aarch64-linux"),
        ("darwin", "x86_64", "darwin64"),
        ("darwin", "arm64", "aarch64-darwin"),
        ("win32", "AMD64", "win64"),
    ],
)
def test_host_platforms(monkeypatch: pytest.MonkeyPatch, system: str, machine: str, name: str) -> None:
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(toolchain.platform, "machine", lambda: machine)
    assert host_platform() is PLATFORMS[name]


@pytest.mark.parametrize(
    ("system", "machine"),
    [
        ("freebsd14", "x86_64"),
        ("win32", "ARM64"),
        ("linux", "riscv64"),
        ("linux", "i686"),
        ("linux", "ppc64le"),
    ],
)
def test_other_platforms_are_an_error_not_a_guess(monkeypatch: pytest.MonkeyPatch, system: str, machine: str) -> None:
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(toolchain.platform, "machine", lambda: machine)
    with pytest.raises(ToolchainError, match=f"No FMU platform for {system} on .*; known: linux64, win64"):
        host_platform()


def test_identity_names_what_decides_the_bytes() -> None:
    for part in ("ziglang ", "fmpy ", "-ffp-contract=off", "-O2"):
        assert part in toolchain.identity()


# The cache


def test_a_second_build_compiles_nothing_and_writes_nothing(tmp_path: Path, compiled: list[str]) -> None:
    path = build(gain(), tmp_path / "out", cache=tmp_path / "cache")
    os.utime(path, ns=(1, 1))
    cached = next((tmp_path / "cache").rglob(f"*{host_platform().extension}"))
    os.utime(cached, ns=(2, 2))
    assert build(gain(), tmp_path / "out", cache=tmp_path / "cache") == path
    assert compiled == [host_platform().name]
    assert path.stat().st_mtime_ns == 1
    assert cached.stat().st_mtime_ns == 2


def test_the_cache_serves_another_folder(tmp_path: Path, compiled: list[str]) -> None:
    one = build(gain(), tmp_path / "one", cache=tmp_path / "cache")
    two = build(gain(), tmp_path / "two", cache=tmp_path / "cache")
    assert len(compiled) == 1
    assert one.read_bytes() == two.read_bytes()


def test_a_changed_definition_is_compiled_and_written(tmp_path: Path, compiled: list[str]) -> None:
    path = build(gain(2.0), tmp_path / "out", cache=tmp_path / "cache")
    first = path.read_bytes()
    build(gain(3.0), tmp_path / "out", cache=tmp_path / "cache")
    assert len(compiled) == 2
    assert path.read_bytes() != first
    build(gain(2.0), tmp_path / "out", cache=tmp_path / "cache")
    assert len(compiled) == 2
    assert path.read_bytes() == first


def test_another_compiler_or_flag_is_another_binary(
    tmp_path: Path, compiled: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    build(gain(), tmp_path / "out", cache=tmp_path / "cache")
    monkeypatch.setattr(binary, "identity", lambda: "ziglang 99")
    build(gain(), tmp_path / "out", cache=tmp_path / "cache")
    assert len(compiled) == 2


def test_the_same_sources_compiled_otherwise_are_another_binary(tmp_path: Path, compiled: list[str]) -> None:
    sources = {"a.c": "int a(void) { return 1; }\n", "b.c": "int b(void) { return 2; }\n"}
    for names in (["a.c"], ["a.c", "b.c"], ["b.c", "a.c"]):
        binary.binary("both", sources, host_platform(), compiled=names, cache=tmp_path)
    assert len(compiled) == 3


def test_a_failed_build_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(sources: list[Path], output: Path, target: toolchain.Platform, _libraries: object) -> None:
        output.write_bytes(b"half a binary")
        raise ToolchainError(f"{sources[0].name} does not compile for {target.name}")

    monkeypatch.setattr(binary, "compile_library", fail)
    with pytest.raises(ToolchainError):
        build(gain(), tmp_path / "out", cache=tmp_path / "cache")
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]


def test_platforms_are_packed_in_one_order(tmp_path: Path, compiled: list[str]) -> None:
    chosen = [PLATFORMS["win64"], PLATFORMS["aarch64-linux"], PLATFORMS["linux64"]]
    one = build(gain(), tmp_path / "one", chosen, tmp_path / "cache")
    two = build(gain(), tmp_path / "two", reversed(chosen), tmp_path / "cache")
    assert one.read_bytes() == two.read_bytes()
    assert sorted(compiled) == ["aarch64-linux", "linux64", "win64"]
    with zipfile.ZipFile(one) as archive:
        names = [name for name in archive.namelist() if name.startswith("binaries/")]
    assert names == [
        "binaries/aarch64-linux/Gain.so",
        "binaries/linux64/Gain.so",
        "binaries/win64/Gain.dll",
    ]


def test_the_cache_can_be_put_elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compiled: list[str]) -> None:
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "elsewhere"))
    assert default_cache() == tmp_path / "elsewhere"
    build(gain(), tmp_path / "out")
    assert compiled == [host_platform().name]
    assert list((tmp_path / "elsewhere").rglob(f"*{host_platform().extension}"))
    monkeypatch.delenv("ADAPTIMP_CACHE")
    assert default_cache().name.startswith("adaptimp")
