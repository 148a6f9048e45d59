"""Tests of reading what an FMU carries beside its definition."""

import zipfile
from pathlib import Path

import pytest

from orchestration.fmi.document import DocumentError
from orchestration.fmi.related_files import MANIFEST, RelatedFile, related_files
from orchestration.sandbox.xml import LARGEST


def with_manifest(folder: Path, content: str | None) -> Path:
    """An archive with this manifest; without one if None."""
    path = folder / "x.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", "<fmiModelDescription/>")
        if content is not None:
            archive.writestr(MANIFEST, content)
    return path


def test_an_fmu_without_a_manifest_carries_nothing(tmp_path: Path) -> None:
    assert related_files(with_manifest(tmp_path, None)) == ()


def test_each_file_of_the_manifest_is_told(tmp_path: Path) -> None:
    manifest = """<fmiReferences>
        <Related source="a.ssv" role="parameter" type="application/x-ssp-parameter-set" description="Soft">
            <Label name="variant:soft"/><Label name="os:any" description="anywhere"/>
        </Related>
        <Annotations><Annotation type="org.example"/></Annotations>
        <Related source="../../resources/b.mo" role="model"/>
    </fmiReferences>"""
    assert related_files(with_manifest(tmp_path, manifest)) == (
        RelatedFile("a.ssv", "parameter", "application/x-ssp-parameter-set", "Soft", ("variant:soft", "os:any")),
        RelatedFile("../../resources/b.mo", "model", "", "", ()),
    )


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("<fmiReferences>", rf"{MANIFEST} is not well-formed XML"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', rf"{MANIFEST} "),
        ("<a>" + " " * LARGEST + "</a>", rf"{MANIFEST} has more than \d+ bytes"),
    ],
    ids=["damaged", "entities", "too large"],
)
def test_a_damaged_manifest_is_an_error(tmp_path: Path, content: str, message: str) -> None:
    with pytest.raises(DocumentError, match=message):
        related_files(with_manifest(tmp_path, content))
