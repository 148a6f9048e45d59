"""Files that a damaged disk, a careless tool or an attacker could leave: descriptions and archives, changed by chance.

Half of the changes of a description keep it valid against the schema, so that the rules behind it see them too.
"""

import copy
import io
import random
import zipfile
from collections.abc import Callable, Mapping

from lxml import etree

from tests.unit.orchestration.checked import DESCRIPTION

NUMBERS = (
    *("0", "-1", "-0", "+1", " 7 ", "00012", "0" * 5000 + "3", "4294967295", "4294967296", "2147483648", "9" * 400),
    *("1e308", "-1e308", "1e999", "5e-324", "INF", "-INF", "NaN", "0x10", "1_0", "1,5", "\u0663", ""),
)
TEXTS = (
    *("", " ", "true", "1", "x", "input", "output", "fixed", "tunable", "constant", "continuous", "exact", "approx"),
    *("tau_cmd[1]", "tau_cmd[999999999]", "q[0]", "q[01]", "q[" + "1," * 5000 + "1]", "der(" * 200, "'\\'", "a.b[1].c"),
    *("../../etc/passwd", "%s%n%d", "\u202e\U0001f600", "a" * 70_000, "\u0000".replace("\u0000", "\ufffd"), "N.m"),
)
RICH = b"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Rich" guid="{rich}" variableNamingConvention="structured">
  <CoSimulation modelIdentifier="Rich" canGetAndSetFMUstate="true" canSerializeFMUstate="true">
    <SourceFiles><File name="rich.c"/></SourceFiles>
  </CoSimulation>
  <UnitDefinitions>
    <Unit name="N.m"><BaseUnit kg="1" m="2" s="-2"/><DisplayUnit name="N.mm" factor="1000"/></Unit>
    <Unit name="deg"><BaseUnit rad="1" factor="0.0175" offset="0"/></Unit>
  </UnitDefinitions>
  <TypeDefinitions>
    <SimpleType name="Torque"><Real unit="N.m" displayUnit="N.mm" min="-9" max="9"/></SimpleType>
    <SimpleType name="Mode">
      <Enumeration><Item name="off" value="0"/><Item name="on" value="1"/></Enumeration>
    </SimpleType>
  </TypeDefinitions>
  <LogCategories><Category name="logStatusError"/></LogCategories>
  <DefaultExperiment startTime="0" stopTime="1" tolerance="1e-6" stepSize="0.1"/>
  <ModelVariables>
    <ScalarVariable name="q[1]" valueReference="0" causality="input"><Real start="0" unit="deg"/></ScalarVariable>
    <ScalarVariable name="tau_cmd[1]" valueReference="1" causality="output" initial="calculated">
      <Real declaredType="Torque"/>
    </ScalarVariable>
    <ScalarVariable name="mode" valueReference="2" causality="parameter" variability="tunable">
      <Enumeration declaredType="Mode" start="1"/>
    </ScalarVariable>
    <ScalarVariable name="on" valueReference="3" causality="output" variability="discrete"><Boolean/></ScalarVariable>
    <ScalarVariable name="n" valueReference="4" causality="local" variability="constant">
      <Integer start="3"/>
    </ScalarVariable>
    <ScalarVariable name="sample_time" valueReference="5" causality="parameter" variability="fixed">
      <Real start="0.1" min="0"/>
    </ScalarVariable>
    <ScalarVariable name="z" valueReference="6"><Real/></ScalarVariable>
    <ScalarVariable name="der(z)" valueReference="7"><Real derivative="7"/></ScalarVariable>
    <ScalarVariable name="file" valueReference="0" variability="discrete"><String/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="2" dependencies="1 3" dependenciesKind="dependent fixed"/><Unknown index="4"/></Outputs>
    <Derivatives><Unknown index="8" dependencies="1"/></Derivatives>
    <InitialUnknowns><Unknown index="2"/><Unknown index="4"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""
"""A description with an element of nearly every kind: a change soon hits each."""
DEPTH, COPIES = 3000, 3000
Change = Callable[[random.Random, etree._Element], None]


def mutant(rng: random.Random, description: bytes) -> bytes:
    """A description with one to four changes."""
    root = etree.fromstring(description)
    for _ in range(rng.randint(1, 4)):
        rng.choices(list(CHANGES), weights=list(CHANGES.values()))[0](rng, root)
    return etree.tostring(root, xml_declaration=rng.random() < 0.9, encoding=rng.choice(("UTF-8", "UTF-16", "ASCII")))


def damaged(rng: random.Random, archive: bytes) -> bytes:
    """An archive with flipped bits, a piece cut out, moved or doubled, or another directory."""
    content = bytearray(archive)
    for _ in range(rng.randint(1, 3)):
        directory = max(content.rfind(b"PK\x01\x02"), 0)
        at = rng.randrange(directory, len(content)) if rng.random() < 0.7 else rng.randrange(len(content))
        length = rng.choice((1, 2, 4, 46, 512))
        rng.choice((_flip, _fill, _cut, _double))(rng, content, at, length)
        if len(content) < 64:
            break
    return bytes(content)


def packed(entries: Mapping[str, bytes]) -> bytes:
    """An archive of these entries."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in entries.items():
            archive.writestr(name, data)
    return content.getvalue()


def entries_of(archive: bytes, *, binaries: bool) -> dict[str, bytes]:
    """Entries of an archive, the description first; with or without its binaries."""
    with zipfile.ZipFile(io.BytesIO(archive)) as opened:
        names = [name for name in opened.namelist() if binaries or not name.startswith("binaries/")]
        found = {name: opened.read(name) for name in names if not name.endswith("/")}
    return {DESCRIPTION: found.pop(DESCRIPTION), **found}


def _flip(rng: random.Random, content: bytearray, at: int, _length: int) -> None:
    content[at] ^= 1 << rng.randrange(8)


def _fill(rng: random.Random, content: bytearray, at: int, length: int) -> None:
    content[at : at + length] = bytes([rng.choice((0, 0x7F, 0x80, 0xFF))]) * min(length, len(content) - at)


def _cut(_rng: random.Random, content: bytearray, at: int, length: int) -> None:
    del content[at : at + length]


def _double(_rng: random.Random, content: bytearray, at: int, length: int) -> None:
    content[at:at] = content[at : at + length]


def _element(rng: random.Random, root: etree._Element) -> etree._Element:
    """Any element but the root; half of the time one of few, as there are so many variables."""
    elements = list(root.iterdescendants())
    rare = [e for e in elements if e.tag not in ("ScalarVariable", "Real", "Boolean", "Integer", "Unknown")]
    return rng.choice(rare if rare and rng.random() < 0.5 else elements or [root])


def _with_attributes(rng: random.Random, root: etree._Element) -> etree._Element:
    chosen = [_element(rng, root) for _ in range(20)]
    return next((e for e in chosen if e.attrib), root)


def _set_value(rng: random.Random, root: etree._Element) -> None:
    element = _with_attributes(rng, root)
    if not element.attrib:
        return
    name = rng.choice(list(element.attrib))
    numeric = element.attrib[name].strip("-+.0123456789e ") == ""
    pool = NUMBERS if numeric == (rng.random() < 0.8) else TEXTS
    element.set(name, rng.choice(pool))


def _borrow_value(rng: random.Random, root: etree._Element) -> None:
    """The value that the same attribute has elsewhere: of the right type, and in the wrong place."""
    element = _with_attributes(rng, root)
    if element.attrib:
        name = rng.choice(list(element.attrib))
        alike = [e.get(name) for e in root.iter() if e.tag == element.tag]
        element.set(name, rng.choice([value for value in alike if value is not None]))


def _drop_attribute(rng: random.Random, root: etree._Element) -> None:
    element = _with_attributes(rng, root)
    if element.attrib:
        del element.attrib[rng.choice(list(element.attrib))]


def _borrow_attribute(rng: random.Random, root: etree._Element) -> None:
    element, other = _element(rng, root), _with_attributes(rng, root)
    for name, value in list(other.attrib.items())[:1]:
        element.set(name, value)


def _drop_element(rng: random.Random, root: etree._Element) -> None:
    element = _element(rng, root)
    parent = element.getparent()
    if parent is not None:
        parent.remove(element)


def _double_element(rng: random.Random, root: etree._Element) -> None:
    element = _element(rng, root)
    if element is not root:
        for _ in range(rng.choice((1, 1, 2, COPIES if len(element) < 5 else 2))):
            element.addnext(copy.deepcopy(element))


def _move_element(rng: random.Random, root: etree._Element) -> None:
    element, place = _element(rng, root), _element(rng, root)
    if root not in (element, place) and element not in place.iterancestors() and element is not place:
        place.addnext(element)


def _rename_element(rng: random.Random, root: etree._Element) -> None:
    _element(rng, root).tag = rng.choice(("Real", "Integer", "Boolean", "String", "Enumeration", "Unknown", "x"))


def _bury_element(rng: random.Random, root: etree._Element) -> None:
    element = _element(rng, root)
    for _ in range(rng.choice((1, 5, DEPTH))):
        element = etree.SubElement(element, element.tag)


CHANGES: dict[Change, int] = {
    _set_value: 6,
    _borrow_value: 6,
    _drop_attribute: 4,
    _borrow_attribute: 1,
    _drop_element: 2,
    _double_element: 2,
    _move_element: 1,
    _rename_element: 1,
    _bury_element: 1,
}
