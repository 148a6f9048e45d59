"""Errors name the component and the package, and never a file in a cache or in a temporary folder."""

import re
import tempfile
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from adaptimp_fmu.files.cache_folder import cache_folder
from adaptimp_fmu.toolchain import host_platform
from orchestration import OrchestrationError, System, simulate
from tests.strangers.conftest import Stranger
from tests.strangers.fmus import Y

ALONE = '<Unknown index="1" dependencies=""/>'
Entries = dict[str, bytes]


def entries(path: Path) -> Entries:
    """Contents of an archive by name."""
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def archive(path: Path, contents: Entries) -> Path:
    """An archive of these contents."""
    with zipfile.ZipFile(path, "w") as made:
        for name, content in contents.items():
            made.writestr(name, content)
    return path


def without_library(fmu: Entries) -> None:
    """The FMU has a library for another machine only."""
    (library,) = (name for name in fmu if name.startswith("binaries/"))
    fmu["binaries/vax/Stranger.exe"] = fmu.pop(library)


def with_a_text_as_library(fmu: Entries) -> None:
    """The library is a text."""
    fmu[next(name for name in fmu if name.startswith("binaries/"))] = b"not a library at all" * 10


def of_version_3(fmu: Entries) -> None:
    """The FMU is one of FMI 3.0."""
    fmu["modelDescription.xml"] = fmu["modelDescription.xml"].replace(b'fmiVersion="2.0"', b'fmiVersion="3.0"')


def with_damaged_xml(fmu: Entries) -> None:
    """The description ends early."""
    fmu["modelDescription.xml"] = fmu["modelDescription.xml"][:-20]


def with_a_name_twice(fmu: Entries) -> None:
    """Two variables have one name."""
    text = fmu["modelDescription.xml"]
    fmu["modelDescription.xml"] = text.replace(b"<ModelVariables>", b"<ModelVariables>" + Y.encode())


def with_a_path_that_leads_out(fmu: Entries) -> None:
    """An entry of the archive leads out of it."""
    fmu["../evil"] = b""


BROKEN: list[Callable[[Entries], None]] = [
    without_library,
    with_a_text_as_library,
    of_version_3,
    with_damaged_xml,
    with_a_name_twice,
    with_a_path_that_leads_out,
]


@pytest.fixture
def good(stranger: Stranger) -> Path:
    """An FMU."""
    return stranger("clock", [Y], outputs=ALONE)


def refused(system: Path | System) -> str:
    """What is said of a system that cannot be run."""
    with pytest.raises(OrchestrationError) as found:
        simulate(system, 0.2, 0.1)
    text = str(found.value)
    places = [str(cache_folder()), str(cache_folder().resolve()), f"{tempfile.gettempdir()}/adaptimp"]
    assert not [place for place in places if place in text], text
    assert len(re.findall(r"\.fmu", text)) <= 2, text
    return text


@pytest.mark.parametrize("broken", BROKEN, ids=lambda function: function.__name__)
def test_an_fmu_in_a_package(good: Path, tmp_path: Path, broken: Callable[[Entries], None]) -> None:
    fmu = entries(good)
    broken(fmu)
    package = entries(System.of({"pump": good}, "loop").write(tmp_path / "loop.ssp"))
    package["resources/stranger.fmu"] = archive(tmp_path / "broken.fmu", fmu).read_bytes()
    said = refused(archive(tmp_path / "broken.ssp", package))
    assert "stranger.fmu" in said
    if broken is not with_a_path_that_leads_out:  # which is seen before the package is read
        assert "pump" in said


@pytest.mark.parametrize("broken", BROKEN[:2], ids=lambda function: function.__name__)
def test_a_library(good: Path, tmp_path: Path, broken: Callable[[Entries], None]) -> None:
    fmu = entries(good)
    broken(fmu)
    said = refused(System.of({"pump": archive(tmp_path / "broken.fmu", fmu)}))
    assert said.startswith("pump: broken.fmu")
    assert host_platform().name in said


def test_a_structure(good: Path, tmp_path: Path) -> None:
    package = entries(System.of({"pump": good}, "loop").write(tmp_path / "loop.ssp"))
    structure = package["SystemStructure.ssd"]
    for wrong in (structure.replace(b"<ssd:Elements>", b"<ssd:Elements><ssd:Pump/>"), structure[:-30], b""):
        package["SystemStructure.ssd"] = wrong
        said = refused(archive(tmp_path / "broken.ssp", package))
        assert said.startswith(f"{tmp_path / 'broken.ssp'}: SystemStructure.ssd is ")
