"""Evidence that every figure's package is valid SSP 1.0: each of its files against the standard's schemas.

The schemas are those that fmpy ships; our writer checks itself against them too, but here the files are
taken from the archive as another tool would find them. ``adaptimp export`` writes the same packages.
"""

import importlib.resources
import zipfile
from pathlib import Path
from typing import Any

import pytest
from lxml import etree

from fmus.catalog import MODELS
from tests.interop.matrix.jobs import FIGURES, figure_system

KINDS = {"ssd": "Description", "ssv": "ParameterValues"}


@pytest.fixture(scope="module")
def schemas() -> dict[str, Any]:
    """The schemas by the ending of the files that they describe."""
    folder = importlib.resources.files("fmpy") / "ssp" / "schema"
    return {
        ending: etree.XMLSchema(etree.parse(str(folder / f"SystemStructure{kind}.xsd")))
        for ending, kind in KINDS.items()
    }


@pytest.fixture(scope="module", params=FIGURES)
def package(request: pytest.FixtureRequest, fmu_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A figure's package."""
    fmus = {identifier: fmu_folder / f"{identifier}.fmu" for identifier in MODELS}
    return figure_system(request.param, fmus).write(tmp_path_factory.mktemp("package") / f"{request.param}.ssp")


def described(package: Path) -> dict[str, Any]:
    """Parsed files of a package that are no FMUs, by name."""
    with zipfile.ZipFile(package) as archive:
        names = [name for name in archive.namelist() if not name.endswith(".fmu")]
        return {name: etree.fromstring(archive.read(name)) for name in names}


def test_every_file_is_valid(package: Path, schemas: dict[str, Any]) -> None:
    files = described(package)
    assert sorted(name.rpartition(".")[2] for name in files) == ["ssd"] + ["ssv"] * 5  # values of each component
    for name, root in files.items():
        schemas[name.rpartition(".")[2]].assertValid(root)
        assert root.get("version") == "1.0"


def test_every_source_is_in_the_package(package: Path) -> None:
    with zipfile.ZipFile(package) as archive:
        names = set(archive.namelist())
    sources = {
        element.get("source")
        for element in described(package)["SystemStructure.ssd"].iter()
        if "source" in element.attrib
    }
    assert sources == names - {"SystemStructure.ssd"}


def test_the_schemas_tell_valid_from_invalid(package: Path, schemas: dict[str, Any]) -> None:
    for name, root in described(package).items():
        schema = schemas[name.rpartition(".")[2]]
        root[0].set("nonsense", "1")
        assert not schema.validate(root), name
        del root[0].attrib["nonsense"]
        assert schema.validate(root), name
        del root.attrib["name"]
        assert not schema.validate(root), name
