"""Tests that unsafe, invalid and unsupported SSP packages are refused with the reason."""

import zipfile
from pathlib import Path

import pytest

from orchestration import ArchiveError, System, SystemDescriptionError
from tests.unit.orchestration.packages import SSD_FILE, edited, substitute

pytestmark = pytest.mark.usefixtures("own_cache")
FMU, VALUES = 'source="resources/Relay.fmu"', 'source="resources/relay.ssv"'
FROM_PLANT = 'startElement="plant" startConnector="x"'
MAPPED = r'\1><ssc:BooleanMappingTransformation><ssc:MapEntry source="true" target="false"/>'
MAPPED += "</ssc:BooleanMappingTransformation>"
SCALED = r'\1><ssc:LinearTransformation factor="2"/>'
DICTIONARY = '<ssd:SignalDictionaryReference name="d" dictionary="d"/></ssd:Elements>'
NESTED = '<ssd:System name="a"><ssd:Elements><ssd:Component name="b" source="resources/Relay.fmu"/></ssd:Elements>'
NESTED += '</ssd:System><ssd:Component name="a__b" source="resources/Relay.fmu"/></ssd:Elements>'


@pytest.mark.parametrize(
    ("pattern", "replacement", "message"),
    [
        (FMU, 'source="../Relay.fmu"', r"'\.\./Relay\.fmu' is missing or leads outside"),
        (FMU, 'source="resources/../../x.fmu"', "leads outside the package"),
        (FMU, 'source="/etc/passwd"', "'/etc/passwd' is missing or leads outside"),
        (FMU, 'source="resources/None.fmu"', r"'resources/None\.fmu' is not in the package"),
        (VALUES, 'source="../relay.ssv"', r"'\.\./relay\.ssv' is missing or leads outside"),
        (VALUES, 'source="resources/none.ssv"', r"none\.ssv' is not in the package"),
        (VALUES, f'{VALUES} sourceBase="component"', r"resources/relay\.ssv' is not in Relay\.fmu"),
        (VALUES, 'source="http://x.org/relay.ssv"', r"'http://x\.org/relay\.ssv' lies elsewhere"),
        ('<step size="[^"]*"', '<step size="long"', r"org\.adaptimp\.step has the size 'long'"),
        (FMU, 'source="%2e%2e/Relay.fmu"', r"'%2e%2e/Relay\.fmu' is missing or leads outside"),
        ("<ssd:Elements>", "<ssd:Element>", r"SystemStructure\.ssd is not well-formed XML"),
        ("<ssd:Connections>", "<ssd:Connections><ssd:Wire/>", r"SystemStructure\.ssd is invalid in line \d+: .*Wire"),
        ('version="1.0"', 'version="3.0"', r"SystemStructure\.ssd is invalid"),
    ],
)
def test_bad_packages_are_refused(package: Path, pattern: str, replacement: str, message: str) -> None:
    with pytest.raises(ArchiveError, match=rf"edited\.ssp: .*{message}"):
        System.read(edited(package, SSD_FILE, substitute(pattern, replacement)))


@pytest.mark.parametrize(
    ("pattern", "replacement", "message"),
    [
        (
            r'(<ssd:Connection startElement="source" startConnector="even"[^>]*)>',
            MAPPED,
            "a BooleanMapping.* not supp",
        ),
        (r'(<ssd:Connection startElement="source" startConnector="n"[^>]*)>', SCALED, "Integer; only Reals can be"),
        (FROM_PLANT, 'startConnector="x"', "system small has no connector x; there is none"),
        (
            'type="application/x-fmu-sharedlibrary"',
            'type="application/x-matlab"',
            "source is of type application/x",
        ),
        (
            '(<ssd:Component name="source")',
            r'\1 implementation="ModelExchange"',
            "source is to be run as model exchange",
        ),
        ("</ssd:Elements>", DICTIONARY, "d refers to a signal dictionary"),
        ("</ssd:Elements>", NESTED, r"a\.b and a__b would both be called a__b; rename one"),
        (FROM_PLANT, FROM_PLANT.replace("plant", "spring"), "no component spring; there are source, relay"),
        (FROM_PLANT, FROM_PLANT.replace('"x"', '"z"'), "plant has no variable z; there are "),
        (FROM_PLANT, 'startElement="source" startConnector="even"', "types Boolean and Real differ"),
        (
            r'(Connector name="x" kind="output">\s*<ssc:Real unit=)"m"',
            r'\1"m2"',
            "has unit m2, but the variable of the FMU has unit m",
        ),
        ('(<ssd:Component name=)"switch"', r'\1"relay"', "'relay' is empty, or is used twice"),
    ],
)
def test_what_cannot_be_run_is_refused(package: Path, pattern: str, replacement: str, message: str) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        System.read(edited(package, SSD_FILE, substitute(pattern, replacement)))


@pytest.mark.parametrize(
    ("pattern", "replacement", "message"),
    [
        ('name="offset"', 'name="y"', r"relay\.y has causality output; only parameters, inputs and initial"),
        ('(value="0.1") unit="m"', r'\1 unit="rad"', r"relay\.offset is given in rad, but the unit in the FMU is m"),
        ('(ssc:BaseUnit) m="1"', r'\1 s="1"', r"relay\.offset is given in m, but the unit in the FMU is m"),
        ('(<ssv:Parameter name=)"n"', r'\1"offset"', "parameter set parameters has two parameters offset"),
        ('Real value="0.1"', 'Real value="NaN"', r"relay\.offset = 'NaN': a plain number in m is needed"),
        ('Integer value="-7"', 'Real value="-7.5"', r"relay\.n = '-7\.5': an integer"),
    ],
)
def test_wrong_values_are_refused(package: Path, pattern: str, replacement: str, message: str) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        System.read(edited(package, "resources/relay.ssv", substitute(pattern, replacement)))


def test_external_entities_are_not_read(package: Path, tmp_path: Path) -> None:
    secret = tmp_path / "secret.txt"
    secret.write_text("relay9")
    doctype = f'<!DOCTYPE x [<!ENTITY leak SYSTEM "{secret.as_uri()}">]>'
    edit = substitute(r"(<ssd:SystemStructureDescription.*?>)", rf"{doctype}\1<!-- -->&leak;")
    with pytest.raises(ArchiveError, match=r"SystemStructure\.ssd declares a document type"):
        System.read(edited(package, SSD_FILE, edit))


def test_entities_are_not_read_in_parameter_sets_either(package: Path) -> None:
    edit = substitute(r"(<ssv:ParameterSet)", r'<!DOCTYPE x [<!ENTITY a "aaaa">]>\1')
    with pytest.raises(ArchiveError, match=r"relay\.ssv declares a document type"):
        System.read(edited(package, "resources/relay.ssv", edit))


def test_missing_package_and_missing_description(tmp_path: Path, package: Path) -> None:
    with pytest.raises(ArchiveError, match=r"none\.ssp: there is no such package"):
        System.read(tmp_path / "none.ssp")
    with zipfile.ZipFile(tmp_path / "hollow.ssp", "w") as archive:
        archive.writestr("readme.txt", "nothing")
    with pytest.raises(ArchiveError, match=r"hollow\.ssp: SystemStructure\.ssd is missing"):
        System.read(tmp_path / "hollow.ssp")
    half = tmp_path / "half.ssp"
    half.write_bytes(package.read_bytes()[:500])
    with pytest.raises(ArchiveError, match=r"half\.ssp is not a readable zip archive"):
        System.read(half)


def test_a_refused_package_leaves_no_folder_in_the_cache(package: Path, own_cache: Path) -> None:
    bad = package.with_name("bad.ssp")
    bad.write_bytes(package.read_bytes())
    with zipfile.ZipFile(bad, "a") as archive:
        archive.writestr("../escape.txt", "out")
    with pytest.raises(ArchiveError, match=r"'\.\./escape\.txt' leads outside"):
        System.read(bad)
    assert not [p for p in own_cache.rglob("*") if p.name != "ssp" and "users" not in p.parts]


def test_a_package_cannot_pass_for_an_unpacked_one(package: Path, own_cache: Path) -> None:
    """An entry named like a marker file, then one that does not unpack: the next read fails as well."""
    trick = package.with_name("trick.ssp")
    with zipfile.ZipFile(package) as old, zipfile.ZipFile(trick, "w") as new:
        new.writestr("complete", "")
        for entry in old.namelist():
            new.writestr(entry, old.read(entry))
        new.writestr("broken", "x" * 100)
    content = bytearray(trick.read_bytes())
    content[content.index(b"x" * 100)] ^= 1
    trick.write_bytes(content)
    for _ in range(2):
        with pytest.raises(ArchiveError, match="entry 'broken' is damaged: its CRC is"):
            System.read(trick)
    assert not [p for p in own_cache.rglob("*") if p.is_file() and "users" not in p.parts]
