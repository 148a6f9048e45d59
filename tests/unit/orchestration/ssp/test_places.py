"""Tests of where a system may lie: a package, a folder, an .ssd file, and which of its variants is read."""

import os
import zipfile
from pathlib import Path

import pytest

from orchestration import ArchiveError, System, SystemDescriptionError
from tests.unit.orchestration.packages import SSD_FILE, same

pytestmark = pytest.mark.usefixtures("own_cache")


@pytest.fixture
def folder(package: Path, tmp_path: Path) -> Path:
    """The package, unpacked, with a second variant in which relay.offset is 7."""
    place = tmp_path / "unpacked"
    with zipfile.ZipFile(package) as archive:
        archive.extractall(place)
    values = (place / "resources" / "relay.ssv").read_text(encoding="utf-8")
    (place / "resources" / "warm.ssv").write_text(values.replace('value="0.1"', 'value="7.0"'), encoding="utf-8")
    text = (place / SSD_FILE).read_text(encoding="utf-8")
    (place / "Warm.ssd").write_text(text.replace("relay.ssv", "warm.ssv"), encoding="utf-8")
    return place


def offset(system: System) -> float:
    """The value in which the variants differ."""
    return float(system["relay"]["offset"])


def zipped(folder: Path, path: Path) -> Path:
    """A package of a folder."""
    with zipfile.ZipFile(path, "w") as archive:
        for file in sorted(folder.rglob("*")):
            archive.write(file, file.relative_to(folder).as_posix())
    return path


def test_folders_and_ssd_files_are_the_same_system(folder: Path, package: Path) -> None:
    assert same(System.read(folder), System.read(package))
    assert same(System.read(folder / SSD_FILE), System.read(package))


def test_a_path_is_relative_to_the_working_directory(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(folder)
    assert offset(System.read(SSD_FILE)) == 0.1
    assert offset(System.read(".")) == 0.1


def test_variants_are_chosen_by_name(folder: Path, tmp_path: Path) -> None:
    package = zipped(folder, tmp_path / "both.ssp")
    for place in (folder, package, folder / SSD_FILE):
        assert [offset(System.read(place, variant=name)) for name in (None, "Warm", "Warm.ssd")] == [0.1, 7.0, 7.0]
    assert offset(System.read(folder / "Warm.ssd")) == 7.0
    assert offset(System.read(folder / "Warm.ssd", variant="SystemStructure")) == 0.1


def test_a_wrong_variant_is_answered_with_their_list(folder: Path) -> None:
    with pytest.raises(SystemDescriptionError, match=r"has no variant Cold; there are SystemStructure, Warm\."):
        System.read(folder, variant="Cold")
    with pytest.raises(SystemDescriptionError, match=r"no variant warm; names are case-sensitive: did you mean Warm\?"):
        System.read(folder, variant="warm")


def test_a_package_without_a_default_names_its_variants(folder: Path, tmp_path: Path) -> None:
    (folder / SSD_FILE).rename(folder / "Cold.ssd")
    words = rf"has no {SSD_FILE}; choose one of its variants, Cold, Warm\."
    with pytest.raises(SystemDescriptionError, match=words):
        System.read(zipped(folder, tmp_path / "both.ssp"))
    with pytest.raises(SystemDescriptionError, match=words):
        System.read(folder)


def test_missing_places_are_said(tmp_path: Path) -> None:
    with pytest.raises(ArchiveError, match=r"none\.ssd: there is no such system"):
        System.read(tmp_path / "none.ssd")
    with pytest.raises(ArchiveError, match=r"SystemStructure\.ssd is missing"):
        System.read(tmp_path)


def test_files_of_a_folder_must_lie_in_it(folder: Path, tmp_path: Path) -> None:
    text = (folder / SSD_FILE).read_text(encoding="utf-8")
    (folder / "Warm.ssd").write_text(text.replace("resources/Relay.fmu", "../Relay.fmu"), encoding="utf-8")
    with pytest.raises(ArchiveError, match="leads outside"):
        System.read(folder / "Warm.ssd")
    fmu = folder / "resources" / "Relay.fmu"
    fmu.rename(tmp_path / "Relay.fmu")
    os.symlink(tmp_path / "Relay.fmu", fmu)
    with pytest.raises(ArchiveError, match="leads outside"):
        System.read(folder)
