"""Tests of the terminals of each FMU: another tool that connects them couples the arm as connections by name do."""

import importlib.resources
import itertools
import zipfile
from pathlib import Path

import pytest
from fmu_manipulation_toolbox.operations import FMU
from fmu_manipulation_toolbox.terminals import Terminals
from lxml import etree

from fmus.project import TERMINALS
from orchestration import scenario
from tests.conformance.binary import Binary
from tests.conformance.container import of_models

FILE = "terminalsAndIcons/terminalsAndIcons.xml"


def terminals(fmu: Path) -> Terminals:
    """Terminals of an FMU as fmutool reads them from the file."""
    opened = FMU(str(fmu))
    return Terminals(opened.tmp_directory)


def test_the_file_is_valid(fmu: Path) -> None:
    path = importlib.resources.files("fmpy") / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"
    with zipfile.ZipFile(fmu) as archive:
        root = etree.fromstring(archive.read(FILE))
    etree.XMLSchema(etree.parse(str(path))).assertValid(root)


@of_models
def test_members_are_inputs_and_outputs_and_in_one_terminal_each(fmu: Path, binary: Binary) -> None:
    found = terminals(fmu)
    members = [member for terminal in found for member in terminal.members.items()]
    assert members
    assert set(found.terminals) <= set(TERMINALS)
    assert all(name == variable for name, variable in members)
    assert {name for name, _ in members} <= {*binary.names("input"), *binary.names("output")}
    assert len(set(members)) == len(members)


@pytest.mark.parametrize("run", ["fig2", "fig5", "fig7", "spong-ortega"])
def test_terminals_of_one_name_couple_an_arm_as_names_of_signals_do(run: str) -> None:
    system = scenario(run)
    read = {component.name: terminals(component.description.path) for component in system.components}
    coupled, connected = 0, set()
    for (one, its), (other, theirs) in itertools.combinations(read.items(), 2):
        for name in its.terminals:
            if name in theirs:
                coupled += 1
                connected |= {frozenset({(one, a), (other, b)}) for a, b in its[name].connect(theirs[name])}
    assert coupled == len(TERMINALS)
    by_name = {frozenset({(c.source, c.output), (c.target, c.input)}) for c in system.connections}
    assert connected == by_name
