"""Tests that hostile XML is refused, or cheap, in descriptions of FMUs and in all files of packages."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from orchestration import ArchiveError, System
from orchestration.check import Severity, check
from tests.faults.cli import Command
from tests.strangers.fmus import HEAD, U, Y, description
from tests.strangers.hostile.archives import LIBRARY
from tests.strangers.hostile.packages import component, described, package
from tests.strangers.hostile.test_archives import assert_said
from tests.strangers.hostile.zips import DEFLATED, Row, zipped

XML = description("feedthrough", [U, Y], outputs='<Unknown index="2" dependencies="1"/>')
ROOT = "<fmiModelDescription"
DOCTYPE = "declares a document type; entities are not allowed"
LAUGHS = "".join(f'<!ENTITY e{i + 1} "{f"&e{i};" * 10}">' for i in range(9))
SIGN_OF_ORDER = "\ufeff"


def with_type(declared: str, text: str = XML) -> str:
    """The description with a document type."""
    return text.replace(ROOT, f"<!DOCTYPE x {declared}>{ROOT}", 1)


def longer(n: int, extra: str = "") -> str:
    """The description of an FMU with many more variables."""
    row = '<ScalarVariable name="{0}" valueReference="{0}"{1}><Real/></ScalarVariable>'
    return XML.replace("</ModelVariables>", "".join(row.format(i, extra) for i in range(n)) + "</ModelVariables>")


HOSTILE: dict[str, tuple[Callable[[], str | bytes], str]] = {
    "an entity in the text": (
        lambda: with_type('[<!ENTITY a "b">]').replace("<ModelStructure>", "&a;<ModelStructure>"),
        DOCTYPE,
    ),
    "an entity in an attribute": (
        lambda: with_type('[<!ENTITY a "b">]').replace('modelName="S', 'modelName="&a;S'),
        DOCTYPE,
    ),
    "a file of ours": (lambda: with_type('[<!ENTITY a SYSTEM "file:///etc/passwd">]'), DOCTYPE),
    "a network": (lambda: with_type('SYSTEM "http://localhost:1/x.dtd"'), DOCTYPE),
    "a billion laughs": (
        lambda: with_type(f'[<!ENTITY e0 "ha">{LAUGHS}]').replace('modelName="S', 'modelName="&e9;S'),
        DOCTYPE,
    ),
    "a document type behind comments": (
        lambda: with_type("[]").replace("<!DOCTYPE", "<!-- <x> --><?pi x?>\n<!-- --><!DOCTYPE"),
        DOCTYPE,
    ),
    "a document type in UTF-16": (lambda: with_type("[]").replace("UTF-8", "UTF-16").encode("utf-16"), DOCTYPE),
    "an entity without a document type": (
        lambda: XML.replace("<ModelStructure>", "&a;<ModelStructure>"),
        "not well-formed XML: Entity 'a' not defined",
    ),
    "inclusion": (
        lambda: XML.replace(
            "<ModelStructure>",
            '<xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="/etc/passwd"/><ModelStructure>',
        ),
        "violates the schema",
    ),
    "200 elements in one another": (
        lambda: XML.replace("<ModelStructure>", "<a>" * 200 + "</a>" * 200 + "<ModelStructure>"),
        "nested more than 128 deep",
    ),
    "100,000 elements in one another": (
        lambda: XML.replace("<ModelStructure>", "<a>" * 100_000 + "</a>" * 100_000 + "<ModelStructure>"),
        "nested more than 128 deep",
    ),
    "millions of elements": (
        lambda: longer(0).replace("<Mod", "<a/>" * 2_000_000 + "<Mod", 1),
        "more than 1000000 tags",
    ),
    "millions of attributes": (
        lambda: XML.replace("<ModelVariables", "<ModelVariables " + " ".join(f"a{i}=''" for i in range(2_000_100))),
        "more than 2000000 attributes",
    ),
    "33 MB": (lambda: XML + " " * 33 * 1024**2, "has more than 33554432 bytes"),
    "a name of 2000 characters": (
        lambda: XML.replace('name="u"', f'name="{"u" * 2000}"'),
        "attribute name of 2000 char",
    ),
    "a value of 2 MB": (
        lambda: XML.replace('guid="', f'generationTool="{"x" * 2_000_000}" guid="'),
        "attribute generationTool of 2000000 characters, more than 1048576",
    ),
    "a long version": (lambda: XML.replace('Version="2.0', f'Version="{"2" * 900}'), "fmiVersion 222"),
    "a flood of violations": (lambda: longer(100_000, ' x="1"'), "the attribute 'x' is not allowed"),
    "a long violation": (lambda: longer(10, f' causality="{"x" * 100_000}"'), "violates the schema in line"),
    "UTF-7": (lambda: XML.replace("UTF-8", "UTF-7"), "has the encoding UTF-7, which is not supported"),
    "EBCDIC": (lambda: XML.replace("UTF-8", "cp037").encode("cp037"), "does not begin with an element"),
    "EBCDIC by name": (lambda: XML.replace("UTF-8", "cp037"), "has the encoding cp037, which is not supported"),
    "an unknown encoding": (lambda: XML.replace("UTF-8", "klingon"), "has the encoding klingon"),
    "half of a character": (lambda: (SIGN_OF_ORDER + XML).encode("utf-16-le")[:-1], "its encoding should be UTF-16"),
    "bytes that are not UTF-8": (
        lambda: XML.replace("Stranger", "\ud8ff").encode("utf-8", "surrogatepass"),
        "well-formed",
    ),
    "a NUL": (lambda: XML.replace("Stranger", "Str\0nger"), "not well-formed XML"),
    "a comment without an end": (lambda: f"{HEAD}<!-- {XML}", "not well-formed XML"),
    "nothing": (lambda: "", "does not begin with an element"),
    "spaces": (lambda: " " * 10_000, "does not begin with an element"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_description_is_refused(name: str, tmp_path: Path, adaptimp: Command, left_over) -> None:
    make, rule = HOSTILE[name]
    xml = make()
    content = xml if isinstance(xml, bytes) else xml.encode()
    path = tmp_path / "given" / "hostile.fmu"
    path.write_bytes(zipped([Row("modelDescription.xml", content), Row(LIBRARY)]))
    with pytest.raises(ArchiveError) as refused:
        System.of({"m": path})
    assert_said(refused.value, path, f"(?i){rule}")
    (finding,) = [f for f in check(path).findings if f.severity == Severity.ERROR]
    assert re.search(f"(?i){rule}", finding.message)
    outcome = adaptimp("info", path)
    assert outcome.code == 2
    assert_said(outcome.sentence, path, f"(?i){rule}")
    assert not left_over()


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "iso-8859-1", "windows-1252", "shift_jis"]
)
def test_encodings_stay_readable(encoding: str, tmp_path: Path) -> None:
    said = "\u00e4\u00fc" if encoding != "shift_jis" else "\u30a2"
    xml = XML.replace("UTF-8", "UTF-16" if "16" in encoding else encoding.removesuffix("-sig"))
    xml = xml.replace('modelName="Stranger"', f'modelName="{said}"')
    path = tmp_path / "encoded.fmu"
    path.write_bytes(zipped([Row("modelDescription.xml", xml.encode(encoding)), Row(LIBRARY)]))
    assert System.of({"m": path})["m"].description.model_name == said


def test_a_hundred_thousand_variables_pass(tmp_path: Path) -> None:
    path = tmp_path / "large.fmu"
    path.write_bytes(zipped([Row("modelDescription.xml", longer(100_000).encode(), DEFLATED), Row(LIBRARY)]))
    assert len(System.of({"m": path})["m"].description.variables) == 100_002


ENTITY = '<!DOCTYPE x [<!ENTITY a "b">]>'
SSV = 'xmlns:ssv="http://ssp-standard.org/SSP1/SystemStructureParameterValues"'


@pytest.mark.parametrize(
    ("xml", "rule"),
    [
        (f"{ENTITY}<ssv:ParameterSet {SSV}/>", DOCTYPE),
        (f"<ssv:ParameterSet {SSV}>{'<a>' * 200}{'</a>' * 200}</ssv:ParameterSet>", "nested more than 128 deep"),
        (f"<ssv:ParameterSet {SSV}>{'<a/>' * 1_000_001}</ssv:ParameterSet>", "more than 1000000 tags"),
        ("no XML", "does not begin with an element"),
    ],
    ids=["entity", "depth", "tags", "text"],
)
@pytest.mark.parametrize("where", ["structure", "parameters", "mapping", "parameters in an FMU"])
def test_hostile_files_of_packages_are_refused(xml: str, rule: str, where: str, tmp_path: Path, left_over) -> None:
    values = zipped([Row("modelDescription.xml", XML.encode()), Row(LIBRARY), Row("a.ssv", xml.encode())])
    base = ' sourceBase="component"' if where == "parameters in an FMU" else ""
    mapping = '<ssd:ParameterMapping source="a.ssm"/>' if where == "mapping" else ""
    source = "good.ssv" if mapping else "a.ssv"
    bindings = f'<ssd:ParameterBinding source="{source}"{base}>{mapping}</ssd:ParameterBinding>'
    inner = f"<ssd:ParameterBindings>{bindings}</ssd:ParameterBindings>"
    structure = xml if where == "structure" else described(f"<ssd:Elements>{component('m', inner)}</ssd:Elements>")
    good = f'<ssv:ParameterSet {SSV} version="1.0" name="p"><ssv:Parameters/></ssv:ParameterSet>'
    files = [Row("a.ssv", xml.encode()), Row("a.ssm", xml.encode()), Row("good.ssv", good.encode())]
    path = tmp_path / "given" / "hostile.ssp"
    path.write_bytes(package({"m": values}, structure=structure, entries=files))
    with pytest.raises(ArchiveError) as refused:
        System.read(path)
    assert_said(refused.value, path, rule)
    assert not left_over()
