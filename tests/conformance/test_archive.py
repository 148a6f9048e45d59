"""Tests of rules 7 and 8: the archive of an FMU and the binary in it."""

import getpass
import os
import platform
import re
import stat
import subprocess
import sys
import zipfile
from collections.abc import Iterable
from pathlib import Path, PurePosixPath

import pytest
from lxml import etree

from adaptimp_fmu import build, host_platform
from adaptimp_fmu.toolchain import compile_library, fmi_headers
from fmus.catalog import MODELS
from tests.conformance import elf
from tests.conformance.binary import FUNCTIONS, Binary
from tests.conformance.container import of_models
from tests.conformance.units import UNITS, declared

ROOT = Path(__file__).parents[2]
INCLUDE = re.compile(r'^\s*#\s*include\s+(["<])([^">]+)[">]', re.MULTILINE)
STANDARD = {"float.h", "limits.h", "stdarg.h", "stddef.h", "stdint.h", "stdio.h", "stdlib.h", "string.h"}
BUILD_ALL = """
import sys
from pathlib import Path
from adaptimp_fmu import build
from fmus.catalog import MODELS
for declare in MODELS.values():
    build(declare(), Path(sys.argv[1]), cache=Path(sys.argv[2]))
"""
PRINT_DESCRIPTIONS = """
from adaptimp_fmu.package import definition
from fmus.catalog import MODELS
for declare in MODELS.values():
    print(definition(declare())[1].decode())
"""

needs_elf = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads ELF, the format of Linux")


@pytest.fixture
def entries(fmu: Path) -> list[zipfile.ZipInfo]:
    """The archive's directory."""
    with zipfile.ZipFile(fmu) as archive:
        return archive.infolist()


@pytest.fixture
def sources(fmu: Path, tmp_path: Path) -> Path:
    """The archive's sources/, alone in a folder."""
    folder = tmp_path / "only" / "sources"
    folder.mkdir(parents=True)
    with zipfile.ZipFile(fmu) as archive:
        for name in archive.namelist():
            if name.startswith("sources/"):
                file = folder.parent / name
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(archive.read(name))
    return folder


@pytest.fixture
def library(binary: Binary) -> elf.Library:
    """The binary's dynamic section."""
    return elf.read(binary.path)


def test_07_entries_are_plain_files(entries: list[zipfile.ZipInfo]) -> None:
    for entry in entries:
        path = PurePosixPath(entry.orig_filename)
        assert entry.compress_type in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
        assert "\\" not in entry.orig_filename
        assert not path.is_absolute()
        assert ".." not in path.parts
        assert stat.S_ISREG(entry.external_attr >> 16), entry.filename
        assert not entry.flag_bits & 1, "encrypted"


def test_07_entries_have_one_order_and_date(entries: list[zipfile.ZipInfo], identifier: str) -> None:
    names = [entry.filename for entry in entries]
    assert len(set(names)) == len(names)
    assert names[0] == "modelDescription.xml"
    extra = {"extra"} if identifier in UNITS else set()
    assert {PurePosixPath(name).parts[0] for name in names[1:]} == extra | {
        "model.png",
        "binaries",
        "sources",
        "documentation",
        "terminalsAndIcons",
    }
    assert {"documentation/index.html", "documentation/licenses/license.txt"} <= set(names)
    assert {entry.date_time for entry in entries} == {(1980, 1, 1, 0, 0, 0)}
    assert {entry.create_system for entry in entries} == {3}


def build_elsewhere(folder: Path, hash_seed: str) -> dict[str, bytes]:
    """Bytes of all FMUs, built by another process with everything but the input different.

    Another folder, working directory, cache, hash seed, time zone and umask; zig's local cache too, so
    that it compiles.
    """
    (folder / "cwd").mkdir(parents=True)
    environment = os.environ | {
        "PYTHONPATH": str(ROOT),
        "PYTHONHASHSEED": hash_seed,
        "TZ": f"UTC{hash_seed}",
        "ZIG_LOCAL_CACHE_DIR": str(folder / "zig"),
    }
    command = [sys.executable, "-c", BUILD_ALL, str(folder / "out"), str(folder / "cache")]
    subprocess.run(command, cwd=folder / "cwd", env=environment, check=True, umask=0o027)
    assert len(list((folder / "cache").rglob(f"*{host_platform().extension}"))) == len(MODELS)
    return {path.name: path.read_bytes() for path in (folder / "out").iterdir()}


def test_07_same_definition_same_bytes(fmu_folder: Path, tmp_path: Path) -> None:
    """Built anew with another hash seed in another folder, against those of this run, which the cache may hold."""
    elsewhere = build_elsewhere(tmp_path / "another, longer place", "2")
    here = {path.name: path.read_bytes() for path in fmu_folder.iterdir()}
    assert sorted(elsewhere) == sorted(f"{name}.fmu" for name in MODELS)
    for name in elsewhere:
        assert elsewhere[name] == here[name], name


@pytest.mark.skipif(platform.machine().lower() not in ("x86_64", "amd64"), reason="names x86-64 processors")
def test_07_same_definition_on_another_processor() -> None:
    """OpenBLAS picks its kernels by processor; what it computes must not reach a start value's last digit."""
    described = []
    for processor in ("Nehalem", "Haswell", "SkylakeX"):
        environment = os.environ | {"OPENBLAS_CORETYPE": processor}
        command = [sys.executable, "-c", PRINT_DESCRIPTIONS]
        described.append(subprocess.run(command, cwd=ROOT, env=environment, check=True, stdout=subprocess.PIPE).stdout)
    assert described[0]
    assert described[0] == described[1] == described[2]


@of_models
def test_07_compiler_gives_the_same_bytes(identifier: str, tmp_path: Path, fmu: Path) -> None:
    """Compiled again in this process, with an empty cache."""
    again = build(declared(identifier), tmp_path, cache=tmp_path / "cache")
    assert again.read_bytes() == fmu.read_bytes()


def compiled_files(binary: Binary) -> list[str]:
    """Files that ``SourceFiles`` names."""
    description = etree.parse(binary.path.parents[2] / "modelDescription.xml")
    return [file.attrib["name"] for file in description.iterfind("CoSimulation/SourceFiles/File")]


def test_07_builds_from_its_own_sources(sources: Path, binary: Binary) -> None:
    """sources/ and FMI's headers are enough, and give the very binary that is in the archive."""
    output = sources.parent / binary.path.name
    units = [sources / file for file in compiled_files(binary)]
    compile_library(units, output, host_platform())
    assert output.read_bytes() == binary.path.read_bytes()


def test_07_includes_are_relative_and_complete(sources: Path) -> None:
    files = [path for path in sources.rglob("*") if path.is_file()]
    headers = {path.name for path in fmi_headers().glob("fmi2*.h")}
    assert not {path.name for path in files} & headers, "FMI's headers come with the importing tool"
    for path in files:
        for quote, name in INCLUDE.findall(path.read_text()):
            if quote == "<":
                assert name in STANDARD, path
            else:
                assert name in headers or (path.parent / name).is_file(), f"{path}: {name}"


def private_texts() -> Iterable[bytes]:
    """What would tell where, or by whom, an FMU was built."""
    yield from (str(path).encode() for path in (ROOT, Path.home(), Path(sys.prefix)) if len(path.parts) > 1)
    yield b"/tmp/"
    if len(getpass.getuser()) > 4:
        yield getpass.getuser().encode()


def test_07_no_absolute_path_is_left(fmu: Path) -> None:
    with zipfile.ZipFile(fmu) as archive:
        for name in archive.namelist():
            content = archive.read(name)
            for text in private_texts():
                assert text not in content, f"{name} contains {text!r}"


@needs_elf
def test_08_exports_the_34_functions_and_nothing_else(library: elf.Library) -> None:
    assert len(FUNCTIONS) == 34
    assert library.exported == set(FUNCTIONS)


@needs_elf
def test_08_needs_libc_only(library: elf.Library) -> None:
    assert set(library.needed) <= {"libc.so.6"}
    assert library.search_paths == ()


@needs_elf
def test_08_runs_on_glibc_2_17(library: elf.Library) -> None:
    versions = [re.fullmatch(r"GLIBC_(\d+)\.(\d+)(?:\.\d+)?", version) for version in library.versions]
    assert versions
    assert all(versions), library.versions
    assert max((int(v[1]), int(v[2])) for v in versions if v) <= (2, 17)


@needs_elf
def test_08_imports_nothing_that_can_surprise(library: elf.Library) -> None:
    """No files, sockets, processes, threads, environment or mathematics: memory and text only."""
    memory = {"bcmp", "calloc", "free", "malloc", "memcmp", "memcpy", "memmove", "memset"}
    text = {"snprintf", "strcmp", "strcpy", "strlen", "strncmp", "strncpy", "strspn", "vsnprintf"}
    assert library.imported <= memory | text
