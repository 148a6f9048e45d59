"""Evidence for opening FMUs: other kinds, foreign identifiers and missing parts are refused by name."""

import io
import re
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from orchestration import ArchiveError, simulate
from orchestration.fmi.instance import read_description
from tests.unit.orchestration.units import system

DESCRIPTION = "modelDescription.xml"


def rewritten(fmu: Path, path: Path, edit: Callable[[str], str], drop: str = "^$") -> Path:
    """A copy of an FMU with another description, without the entries that match `drop`."""
    with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            if re.match(drop, name):
                continue
            content = old.read(name)
            if name == DESCRIPTION:
                content = edit(content.decode()).encode()
            new.writestr(name, content)
    return path


@pytest.mark.parametrize(
    "identifier", ["../../evil", "/tmp/evil", "..\\evil", "evil/evil", "a b", "1a", "", "\u00e4", "evil.so"]
)
def test_model_identifier_must_be_one(small: dict[str, Path], tmp_path: Path, identifier: str) -> None:
    path = rewritten(
        small["Source"],
        tmp_path / "evil.fmu",
        lambda text: text.replace('modelIdentifier="Source"', f'modelIdentifier="{identifier}"'),
    )
    rule = rf"evil\.fmu: the model identifier {re.escape(repr(identifier))} is no C identifier"
    with pytest.raises(ArchiveError, match=rule):
        read_description(path)


NEEDED_KIND = r"one of FMI 2\.0 for co-simulation is needed"
EXCHANGE = '<ModelExchange modelIdentifier="a"/>'
FMI1 = (
    '<fmiModelDescription fmiVersion="1.0" modelName="a" modelIdentifier="a" guid="0"'
    ' numberOfContinuousStates="0" numberOfEventIndicators="0"><ModelVariables/></fmiModelDescription>'
)
FMI3 = (
    '<fmiModelDescription fmiVersion="3.0" modelName="a" instantiationToken="0">'
    '<CoSimulation modelIdentifier="a"/><ModelVariables><Float64 name="t" valueReference="0"'
    ' causality="independent"/></ModelVariables><ModelStructure/></fmiModelDescription>'
)


@pytest.mark.parametrize(
    ("edit", "rule"),
    [
        (lambda _: FMI1, rf"is an FMI 1\.0 FMU for model exchange; {NEEDED_KIND}"),
        (lambda _: FMI3, rf"is an FMI 3\.0 FMU for co-simulation; {NEEDED_KIND}"),
        (
            lambda text: re.sub("<CoSimulation.*</CoSimulation>", EXCHANGE, text, flags=re.DOTALL),
            rf"is an FMI 2\.0 FMU for model exchange; {NEEDED_KIND}",
        ),
        (lambda text: text[:-30], r"is no valid FMU"),
        (lambda text: text.replace("<ModelVariables>", "<Variables>"), r"is no valid FMU"),
        (lambda text: text.replace('fmiVersion="2.0"', 'fmiVersion="7.0"'), r"is no valid FMU"),
        (lambda text: text.replace('start="0.125"', 'start="often"'), r"is no valid FMU"),
    ],
)
def test_description_must_be_fmi_2_co_simulation(
    small: dict[str, Path], tmp_path: Path, edit: Callable[[str], str], rule: str
) -> None:
    path = rewritten(small["Source"], tmp_path / "other.fmu", edit)
    with pytest.raises(ArchiveError, match=rf"other\.fmu {rule}"):
        read_description(path)


def test_missing_description_and_missing_file(small: dict[str, Path], tmp_path: Path) -> None:
    hollow = rewritten(small["Source"], tmp_path / "hollow.fmu", str, drop=DESCRIPTION)
    with pytest.raises(ArchiveError, match=r"hollow\.fmu is no valid FMU: .*modelDescription\.xml"):
        read_description(hollow)
    with pytest.raises(ArchiveError, match=r"none\.fmu: there is no such FMU"):
        read_description(tmp_path / "none.fmu")


def test_missing_binary_names_the_platforms(small: dict[str, Path], tmp_path: Path) -> None:
    bare = rewritten(small["Source"], tmp_path / "bare.fmu", str, drop="binaries/")
    with pytest.raises(ArchiveError, match=r"bare\.fmu has no binary for \S+, this machine; it has none"):
        simulate(system({"Source": bare}, {"source": "Source"}))
    with zipfile.ZipFile(bare, "a") as archive_:
        archive_.writestr("binaries/beos64/Source.so", b"")
    with pytest.raises(ArchiveError, match=r"bare\.fmu has no binary for \S+, this machine; it has beos64"):
        simulate(system({"Source": bare}, {"source": "Source"}))


def test_a_binary_that_is_none_is_named(small: dict[str, Path], tmp_path: Path) -> None:
    with zipfile.ZipFile(small["Source"]) as old:
        (library,) = [name for name in old.namelist() if name.startswith("binaries/")]
    broken = rewritten(small["Source"], tmp_path / "broken.fmu", str, drop="binaries/")
    with zipfile.ZipFile(broken, "a") as new:
        new.writestr(library, b"not a library")
    before = Path.cwd()
    with pytest.raises(ArchiveError, match=r"source: broken\.fmu cannot be loaded: "):
        simulate(system({"Source": broken}, {"source": "Source"}))
    assert Path.cwd() == before  # fmpy leaves the working directory in a folder that is gone


def test_a_changed_file_is_screened_again(small: dict[str, Path], tmp_path: Path) -> None:
    path = tmp_path / "unit.fmu"
    path.write_bytes(small["Source"].read_bytes())
    read_description(path)
    buffer = io.BytesIO(small["Source"].read_bytes())
    with zipfile.ZipFile(buffer, "a") as new:
        new.writestr("../evil.txt", b"")
    path.write_bytes(buffer.getvalue())
    with pytest.raises(ArchiveError, match="leads outside"):
        read_description(path)
