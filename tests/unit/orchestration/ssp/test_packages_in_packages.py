"""Tests of components that are packages or .ssd files themselves, and of tables that map values of parameters."""

import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from orchestration import ArchiveError, System, SystemDescriptionError
from orchestration.ssp import read as reading
from orchestration.ssp import schema
from tests.unit.orchestration.foreign import (
    _HEAD,
    binding,
    component,
    connection,
    connector,
    entry,
    foreign,
    real,
    system_xml,
)
from tests.unit.orchestration.small_models import system as small_system

pytestmark = pytest.mark.usefixtures("own_cache")
INNER = system_xml(
    "drive",
    component("b", "Decay", binding(real("z_start", 2.0))),
    connection("cmd", "b.u") + connection("b.y", "out"),
    connector("cmd", "input", "m") + connector("out", "output", "m"),
)


def nested(name: str, source: str, kind: str = "package", bindings: str = "") -> str:
    """A component that is a package or a definition."""
    inner = f"<ssd:ParameterBindings>{bindings}</ssd:ParameterBindings>" if bindings else ""
    return f'<ssd:Component name="{name}" type="application/x-ssp-{kind}" source="{source}">{inner}</ssd:Component>'


def outer(element: str) -> str:
    """A system of a component and a nested one in a circle."""
    lines = connection("a.y", "drive.cmd") + connection("drive.out", "a.u")
    return system_xml("top", component("a", "Decay") + element, lines)


def with_files(package: Path, files: dict[str, bytes]) -> Path:
    """The package with more files."""
    with zipfile.ZipFile(package, "a") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return package


@pytest.fixture
def flat(tmp_path: Path, strange: dict[str, Path]) -> System:
    """The same system without a package in it."""
    return System.read(foreign(tmp_path / "flat.ssp", outer(INNER), strange))


@pytest.mark.parametrize("bindings", ["", binding(real("b.z_start", 3.0))])
def test_a_package_in_a_package_is_a_system_in_the_system(
    tmp_path: Path, strange: dict[str, Path], flat: System, bindings: str
) -> None:
    inner = foreign(tmp_path / "drive.ssp", INNER, strange).read_bytes()
    xml = outer(nested("drive", "resources/drive.ssp", bindings=bindings))
    found = System.read(with_files(foreign(tmp_path / "top.ssp", xml, strange), {"resources/drive.ssp": inner}))
    assert found.connections == flat.connections
    assert list(found) == ["a", "drive__b"]
    assert found["drive__b"].start == {"z_start": 3.0 if bindings else 2.0}


def test_a_variant_of_a_package_in_a_package(tmp_path: Path, strange: dict[str, Path]) -> None:
    other = f"{_HEAD}{INNER.replace('2.0', '5.0')}</ssd:SystemStructureDescription>".replace('unit="m"', "")
    inner = foreign(tmp_path / "drive.ssp", INNER, strange, {"Fast one.ssd": other}).read_bytes()
    xml = outer(nested("drive", "resources/drive.ssp#Fast%20one.ssd"))
    found = System.read(with_files(foreign(tmp_path / "top.ssp", xml, strange), {"resources/drive.ssp": inner}))
    assert found["drive__b"].start == {"z_start": 5.0}


def test_an_ssd_file_has_sources_beside_itself(tmp_path: Path, strange: dict[str, Path], flat: System) -> None:
    units = "<ssd:Units><ssc:Unit name='m'><ssc:BaseUnit m='1'/></ssc:Unit></ssd:Units>"
    text = f"{_HEAD}{INNER}{units}</ssd:SystemStructureDescription>"
    files = {"parts/drive.ssd": text.encode(), "parts/resources/Decay.fmu": strange["Decay"].read_bytes()}
    xml = outer(nested("drive", "parts/drive.ssd", "definition"))
    found = System.read(with_files(foreign(tmp_path / "top.ssp", xml, strange), files))
    assert found.connections == flat.connections
    assert found["drive__b"].path.parent.parent.name == "parts"


def test_a_definition_that_contains_itself_is_refused(tmp_path: Path, strange: dict[str, Path]) -> None:
    xml = system_xml("top", nested("again", "parts/again.ssd", "definition"))
    again = f"{_HEAD}{system_xml('x', nested('again', 'again.ssd', 'definition'))}</ssd:SystemStructureDescription>"
    package = with_files(foreign(tmp_path / "top.ssp", xml, strange), {"parts/again.ssd": again.encode()})
    with pytest.raises(SystemDescriptionError, match=r"component again\.again, again\.ssd, contains itself"):
        System.read(package)


def test_a_fan_of_packages_is_bounded(
    tmp_path: Path, strange: dict[str, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each of twenty files names the next one twice, which would be a million systems."""
    monkeypatch.setattr(reading, "MOST_NESTED", 50)
    files = {}
    for i in range(20):
        two = "".join(nested(name, f"{i + 1}.ssd", "definition") for name in "ab")
        files[f"{i}.ssd"] = f"{_HEAD}{system_xml('x', two)}</ssd:SystemStructureDescription>".encode()
    files["20.ssd"] = f"{_HEAD}{system_xml('x', component('c', 'Decay'))}</ssd:SystemStructureDescription>".encode()
    xml = system_xml("top", nested("x", "0.ssd", "definition"))
    with pytest.raises(SystemDescriptionError, match="is one of over 50 packages in packages"):
        System.read(with_files(foreign(tmp_path / "top.ssp", xml, strange), files))


def test_a_nested_package_that_is_not_there_is_refused(tmp_path: Path, strange: dict[str, Path]) -> None:
    with pytest.raises(ArchiveError, match=r"'resources/drive\.ssp' is not in the package"):
        System.read(foreign(tmp_path / "top.ssp", outer(nested("drive", "resources/drive.ssp")), strange))


def table(kind: str, entries: dict[str, str]) -> str:
    """A transformation that maps single values."""
    rows = "".join(f'<ssc:MapEntry source="{s}" target="{t}"/>' for s, t in entries.items())
    return f"<ssc:{kind}MappingTransformation>{rows}</ssc:{kind}MappingTransformation>"


@pytest.mark.parametrize(
    ("name", "kind", "value", "entries", "expected"),
    [
        ("flag", "Boolean", "true", {"true": "false", "false": "true"}, 0.0),
        ("flag", "Boolean", "0", {"true": "false", "false": "1"}, 1.0),
        ("n", "Integer", "3", {"3": "30", "4": "40"}, 30.0),
    ],
)
def test_values_of_parameters_are_mapped(
    tmp_path: Path, small: dict[str, Path], name: str, kind: str, value: str, entries: dict[str, str], expected: float
) -> None:
    parameter = f'<ssv:Parameter name="theirs"><ssv:{kind} value="{value}"/></ssv:Parameter>'
    bindings = binding(parameter, entry("theirs", name, table(kind, entries)))
    xml = system_xml("top", component("s", "Switch", bindings))
    assert System.read(foreign(tmp_path / "map.ssp", xml, small))["s"].start == {name: expected}


def test_a_value_that_is_not_in_the_table_is_refused(tmp_path: Path, small: dict[str, Path]) -> None:
    parameter = '<ssv:Parameter name="theirs"><ssv:Integer value="5"/></ssv:Parameter>'
    bindings = binding(parameter, entry("theirs", "n", table("Integer", {"3": "30", "4": "40"})))
    xml = system_xml("top", component("s", "Switch", bindings))
    with pytest.raises(SystemDescriptionError, match=r"theirs -> n: the table .* has 3, 4, but not 5; add an entry"):
        System.read(foreign(tmp_path / "map.ssp", xml, small))


def test_a_table_that_changes_nothing_may_stand_at_a_connection(tmp_path: Path, small: dict[str, Path]) -> None:
    line = connection("source.even", "switch.flag", table("Boolean", {"true": "true", "false": "false"}))
    xml = system_xml("top", component("source", "Source") + component("switch", "Switch"), line)
    found = System.read(foreign(tmp_path / "map.ssp", xml, small))
    plain = small_system(small, {"source": "Source", "switch": "Switch"})
    assert found.connections == replace(plain, connections=()).connect("source.even -> switch.flag").connections


def test_refused_packages_within_packages_take_no_place_in_the_cache(
    tmp_path: Path, strange: dict[str, Path], own_cache: Path
) -> None:
    inner = foreign(tmp_path / "drive.ssp", INNER, strange).read_bytes()
    bad = nested("drive", "resources/drive.ssp") + component("c", "None")
    package = with_files(foreign(tmp_path / "top.ssp", outer(bad), strange), {"resources/drive.ssp": inner})
    with pytest.raises(ArchiveError, match=r"'resources/None\.fmu' is not in the package"):
        System.read(package)
    assert not [path for path in own_cache.rglob("*") if path.is_file() and "users" not in path.parts]


@pytest.mark.parametrize("kind", ["package", "definition"])
def test_the_xml_files_of_all_packages_are_bounded_together(
    tmp_path: Path, strange: dict[str, Path], monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    """Each of two parts has more than half of what all may have."""
    padding = f"<!--{'x' * 6000}-->"
    text = f"{_HEAD}{system_xml('x', component('c', 'Decay'))}{padding}</ssd:SystemStructureDescription>"
    package = foreign(tmp_path / "inner.ssp", system_xml("x", component("c", "Decay")) + padding, strange)
    source, content = {
        "package": ("resources/inner.ssp", package.read_bytes()),
        "definition": ("inner.ssd", text.encode()),
    }[kind]
    xml = system_xml("top", nested("a", source, kind) + nested("b", source, kind))
    whole = with_files(foreign(tmp_path / "top.ssp", xml, strange), {source: content})
    assert list(System.read(whole)) == ["a__c", "b__c"]
    monkeypatch.setattr(schema, "MAX_PARSED", 10_000)
    with pytest.raises(ArchiveError, match="its XML files have more than 10000 bytes"):
        System.read(whole)
