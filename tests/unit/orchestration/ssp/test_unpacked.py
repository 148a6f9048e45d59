"""Tests that a damaged package in the cache heals, and that runs share one."""

import os
import shutil
import zipfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from orchestration import OrchestrationError, System, simulate
from orchestration.ssp import unpacked
from orchestration.ssp.unpacked import unpacked_package
from tests.unit.orchestration.small_models import H

pytestmark = pytest.mark.usefixtures("own_cache")


def empty(folder: Path) -> None:
    next(folder.rglob("*.fmu")).write_bytes(b"")


def alter(folder: Path) -> None:
    structure = folder / "SystemStructure.ssd"
    structure.write_bytes(structure.read_bytes()[:-1] + b" ")


def remove(folder: Path) -> None:
    next(folder.rglob("*.fmu")).unlink()


def add(folder: Path) -> None:
    (folder / "resources" / "planted.fmu").write_text("planted")


def cut_manifest(folder: Path) -> None:
    (folder.parent / "manifest").write_bytes(b"")


@pytest.mark.parametrize("damage", [empty, alter, remove, add, cut_manifest])
def test_a_damaged_package_heals(package: Path, damage: Callable[[Path], None]) -> None:
    folder, _ = unpacked_package(package)
    before = {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    assert System.read(package).components
    damage(folder)
    assert unpacked_package(package)[0] == folder
    assert {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
    assert System.read(package).components
    assert len(list(folder.parents[1].iterdir())) == 1  # nothing else is left in the cache


def test_an_intact_package_is_not_unpacked_again(package: Path) -> None:
    folder, _ = unpacked_package(package)
    stamp = (folder / "SystemStructure.ssd").stat().st_mtime_ns
    assert unpacked_package(package) == (folder, False)
    assert (folder / "SystemStructure.ssd").stat().st_mtime_ns == stamp


def test_an_intact_package_is_looked_at_once(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its checksums need a look at every byte."""
    folder, now = unpacked_package(package)
    looks, manifest = [], unpacked._manifest
    monkeypatch.setattr(unpacked, "_manifest", lambda files: looks.append(files) or manifest(files))
    assert now
    assert unpacked_package(package) == (folder, False)
    assert looks == [folder]


def test_runs_that_begin_at_once_share_the_package(package: Path) -> None:
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(unpacked_package, [package] * 8))
    folders = {folder for folder, _ in found}
    assert len(folders) == 1
    assert sum(now for _, now in found) == 1
    (folder,) = folders
    assert (folder / "SystemStructure.ssd").is_file()
    assert len(list(folder.parents[1].iterdir())) == 1


@pytest.mark.skipif(not hasattr(os, "getuid") or os.getuid() != 0, reason="only root can give files to other users")
def test_a_package_of_another_user_is_not_trusted(package: Path) -> None:
    folder, _ = unpacked_package(package)
    os.chown(folder.parent, 12345, -1)
    assert unpacked_package(package)[0] == folder
    assert folder.parent.stat().st_uid == 0
    shutil.rmtree(folder.parent)


def test_a_refused_read_leaves_the_files_of_another_system(package: Path) -> None:
    """Both use one folder in the cache."""
    with zipfile.ZipFile(package, "a") as archive:
        archive.writestr("Broken.ssd", "<broken>")
    system = System.read(package)
    for variant in ("None", "Broken"):
        with pytest.raises(OrchestrationError, match=variant):
            System.read(package, variant=variant)
    assert simulate(system, H, H).time.tolist() == [0.0, H]


@pytest.mark.parametrize("variant", ["Broken", "None"])
def test_a_refused_variant_takes_no_place_in_the_cache(package: Path, own_cache: Path, variant: str) -> None:
    with zipfile.ZipFile(package, "a") as archive:
        archive.writestr("Broken.ssd", "<broken>")
    with pytest.raises(OrchestrationError, match=variant):
        System.read(package, variant=variant)
    assert not [path for path in own_cache.rglob("*") if path.is_file() and "users" not in path.parts]
