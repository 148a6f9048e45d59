"""Tests of rule 7: other compilers build an FMU's sources without a warning, to a binary that behaves the same."""

import os
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from lxml import etree

from adaptimp_fmu.toolchain import fmi_headers
from tests.conformance.replay import assert_reproduces
from tests.driver import Driver
from tests.untested import needs

# MSVC has no arrays of variable length, and refuses what is no C11.
STRICT = ("-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Wvla", "-Werror", "-O2", "-fPIC")
# fmpy finds cmake by name: it may be the one installed beside this Python.
PATH = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
COMPILERS = {"gcc": ("gcc",), "clang": ("clang",), "zig cc": (sys.executable, "-m", "ziglang", "cc")}
COMPILER = next((name for name in ("cc", "gcc", "clang") if shutil.which(name)), None)

needs_compiler = pytest.mark.skipif(COMPILER is None, reason=needs("no C compiler is installed", "gcc"))
needs_cmake = pytest.mark.skipif(
    shutil.which("cmake", path=PATH) is None or not any(map(shutil.which, ("c++", "g++", "clang++"))),
    reason=needs("fmpy compile needs cmake, and its CMakeLists.txt a C++ compiler too", "cmake", "g++"),
)


def compiled(compiler: Sequence[str], fmu: Path, folder: Path, *flags: str) -> subprocess.CompletedProcess[str]:
    """What a compiler says to the FMU's sources, alone in a folder."""
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder, [name for name in archive.namelist() if name.startswith("sources/")])
        description = etree.fromstring(archive.read("modelDescription.xml"))
    files = [file.attrib["name"] for file in description.iterfind("CoSimulation/SourceFiles/File")]
    command = [*compiler, *STRICT, *flags, "-I", str(fmi_headers()), "-c", *files]
    return subprocess.run(command, cwd=folder / "sources", capture_output=True, text=True, check=False)


@needs_compiler
def test_07_sources_compile_without_a_warning(fmu: Path, tmp_path: Path) -> None:
    run = compiled([str(COMPILER)], fmu, tmp_path)
    assert run.returncode == 0, run.stderr
    assert run.stderr == ""


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("identifier", ["Plant", "ForceSensor"])
def test_07_fast_math_is_refused(compiler: str, identifier: str, fmu_folder: Path, tmp_path: Path) -> None:
    """A compiler that may take every number for finite removes the tests that find NaN and infinity."""
    fmu, command = fmu_folder / f"{identifier}.fmu", COMPILERS[compiler]
    if shutil.which(command[0]) is None:
        pytest.skip(f"{compiler} is not installed")
    assert compiled(command, fmu, tmp_path).returncode == 0
    for flag in ("-ffast-math", "-ffinite-math-only", *["-Ofast"] * (compiler != "zig cc")):  # zig's -Ofast is -O3
        run = compiled(command, fmu, tmp_path, "-Wno-error=deprecated", flag)
        assert run.returncode != 0, flag
        assert "Compile without -ffast-math" in run.stderr


def stripped(fmu: Path, folder: Path) -> Path:
    """A copy of an FMU without its binaries."""
    path = folder / fmu.name
    with zipfile.ZipFile(fmu) as archive, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as copy:
        for name in archive.namelist():
            if not name.startswith("binaries/"):
                copy.writestr(name, archive.read(name))
    return path


@needs_compiler
@needs_cmake
@pytest.mark.parametrize("name", ["Plant", "ForceSensor", "SpongOrtegaAdaptiveImpedance"])
def test_07_fmpy_rebuilds_a_stripped_fmu(
    name: str, fmu_folder: Path, tmp_path: Path, open_fmu: Callable[..., Driver]
) -> None:
    """With other compiler and flags, the FMU still reproduces its reference data."""
    fmu = stripped(fmu_folder / f"{name}.fmu", tmp_path)
    command = [sys.executable, "-m", "fmpy", "compile", str(fmu), "--all-warnings", "--warning-as-error"]
    run = subprocess.run(command, env=os.environ | {"PATH": PATH}, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
    assert_reproduces(name, fmu, open_fmu)
