"""Unit definitions of several FMUs become one list, in which every name means one thing."""

from typing import Any

import pytest
from lxml import etree

from orchestration.containers.fmu.unit_definitions import UnitDefinitions
from orchestration.fmi.document import Document

SI = '<Unit name="rad/s"><BaseUnit rad="1" s="-1"/><DisplayUnit name="rpm" factor="9.549"/></Unit>'
PLAIN = '<Unit name="rad/s"><BaseUnit s="-1"/><DisplayUnit name="rpm" factor="9.549296585513721"/></Unit>'
DEFAULTS = '<Unit name="rad/s"><BaseUnit rad="1" s="-1" factor="1" offset="0.0" kg="0"/></Unit>'
UNDEFINED = '<Unit name="rad/s"/>'
CELSIUS = '<Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>'


def document(*units: str) -> Document:
    """The description of an FMU with some unit definitions."""
    root = f"<fmiModelDescription><UnitDefinitions>{''.join(units)}</UnitDefinitions></fmiModelDescription>"
    return Document(etree.fromstring(root))


def written(units: UnitDefinitions) -> Any:
    """The element that holds the merged list."""
    root = etree.Element("fmiModelDescription")
    units.write(root)
    return root.find("UnitDefinitions")


def test_equal_definitions_are_one() -> None:
    units = UnitDefinitions()
    assert [units.unit(document(text), "rad/s") for text in (SI, DEFAULTS, SI)] == ["rad/s"] * 3
    assert [unit.get("name") for unit in written(units)] == ["rad/s"]


@pytest.mark.parametrize("other", [PLAIN, UNDEFINED])
def test_another_meaning_gets_a_number(other: str) -> None:
    units = UnitDefinitions()
    names = [units.unit(document(text), "rad/s") for text in (SI, other, SI, other)]
    assert names == ["rad/s", "rad/s_2", "rad/s", "rad/s_2"]
    assert [unit.get("name") for unit in written(units)] == ["rad/s", "rad/s_2"]


def test_a_number_that_is_taken_is_passed_over() -> None:
    units = UnitDefinitions()
    assert units.unit(document(SI.replace('"rad/s"', '"rad/s_2"')), "rad/s_2") == "rad/s_2"
    assert units.unit(document(SI), "rad/s") == "rad/s"
    assert units.unit(document(PLAIN), "rad/s") == "rad/s_3"


def test_definitions_keep_their_numbers() -> None:
    units = UnitDefinitions()
    assert units.unit(document(CELSIUS), "degC") == "degC"
    assert units.unit(document(SI), "rad/s") == "rad/s"
    listing = written(units)
    assert [dict(unit[0].attrib) for unit in listing] == [{"K": "1", "offset": "273.15"}, {"rad": "1", "s": "-1"}]


def test_display_units_are_merged_within_their_unit() -> None:
    units = UnitDefinitions()
    assert units.display_unit(document(SI), "rad/s", "rpm") == "rpm"
    finer = SI.replace("9.549", "9.549296585513721")
    assert units.display_unit(document(finer), "rad/s", "rpm") == "rpm_2"
    assert units.display_unit(document(PLAIN), "rad/s", "rpm") == "rpm"
    shown = {unit.get("name"): [row.get("name") for row in unit.iterfind("DisplayUnit")] for unit in written(units)}
    assert shown == {"rad/s": ["rpm", "rpm_2"], "rad/s_2": ["rpm"]}


def test_what_is_not_defined_is_not_shown() -> None:
    units = UnitDefinitions()
    assert units.unit(document(SI), "") == ""
    assert units.display_unit(document(SI), "rad/s", "deg/s") == ""
    assert units.display_unit(document(), "kg", "g") == ""
    assert written(UnitDefinitions()) is None
