"""Tests of terminals: another tool reads them as they were declared, and impossible ones are refused."""

import io
from collections.abc import Mapping
from typing import Any

import pytest
from lxml import etree

from adaptimp_fmu import DefinitionError, Terminal, terminals_and_icons

VARIABLES = ["plant.x[1]", "plant.tau[1]", "controller.K", "controller.tau[1]"]
PLANT = Terminal("plant", {"x[1]": "plant.x[1]", "tau[1]": "plant.tau[1]"}, "The arm")
CONTROLLER = Terminal("controller", {"tau[1]": "controller.tau[1]", "K": "controller.K"}, matching_rule="plug")


toolbox: Any = pytest.importorskip(
    "fmu_manipulation_toolbox.terminals", reason="fmu-manipulation-toolbox is not installed (group interop)"
)


def read(terminals: list[Terminal], variables: list[str] = VARIABLES) -> Any:
    """Terminals as fmutool reads them."""
    return toolbox.Terminals.from_xml_source(io.BytesIO(terminals_and_icons("Fig5", terminals, variables)))


def test_another_tool_reads_names_rules_and_members_in_their_order() -> None:
    found = read([PLANT, CONTROLLER])
    assert list(found.terminals) == ["plant", "controller"]
    assert [terminal.matching for terminal in found] == ["bus", "plug"]
    assert list(found["plant"].members.items()) == list(PLANT.members.items())
    assert list(found["controller"].members.items()) == list(CONTROLLER.members.items())


def test_another_tool_connects_members_of_one_name() -> None:
    found = read([PLANT, CONTROLLER])
    assert found["plant"].connect(found["controller"]) == [("plant.tau[1]", "controller.tau[1]")]


def test_the_file_names_the_version_of_fmi_that_defines_it() -> None:
    root = etree.fromstring(terminals_and_icons("Fig5", [PLANT], VARIABLES))
    assert root.tag == "fmiTerminalsAndIcons"
    assert root.get("fmiVersion") == "3.0"


def test_a_description_is_kept_and_an_empty_one_left_out() -> None:
    root = etree.fromstring(terminals_and_icons("Fig5", [PLANT, CONTROLLER], VARIABLES))
    assert [terminal.get("description") for terminal in root.iter("Terminal")] == ["The arm", None]


def test_same_terminals_same_bytes() -> None:
    assert terminals_and_icons("Fig5", [PLANT], VARIABLES) == terminals_and_icons("Fig5", [PLANT], VARIABLES)


@pytest.mark.parametrize(
    ("terminals", "message"),
    [
        ([PLANT, PLANT], "Fig5 already has a terminal plant; give the other one another name."),
        (
            [Terminal("arm", {"x": "plant.x[3]"})],
            "Fig5: terminal arm holds plant.x[3], which is not an input, output or parameter; did you mean plant.x[1]",
        ),
        ([], "Fig5: terminalsAndIcons/terminalsAndIcons.xml is invalid: "),
    ],
)
def test_impossible_terminals_are_refused(terminals: list[Terminal], message: str) -> None:
    with pytest.raises(DefinitionError) as refused:
        terminals_and_icons("Fig5", terminals, VARIABLES)
    assert str(refused.value).startswith(message)


@pytest.mark.parametrize("members", [{}, {"q": "controller.K"}])
def test_terminals_without_common_members_are_not_connected(members: Mapping[str, str]) -> None:
    found = read([PLANT, Terminal("other", members)])
    assert found["plant"].connect(found["other"]) == []
