"""What is read from a description; other kinds, foreign identifiers and wrong references are refused by name."""

import io
import re
import subprocess
import sys
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import ArchiveError, Component, simulate
from orchestration.analysis.energy import PowerBond, ledger
from orchestration.check.dynamic import supervision
from orchestration.check.static.archive_rules import open_package
from orchestration.fmi.description import read_description
from orchestration.fmi.units import Unit, UnitDefinition, conversion
from tests.reference.problems import PROBLEMS
from tests.unit.orchestration.checked import DESCRIPTION, edited, swap


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
    "identifier", ["../../evil", "/tmp/evil", "..\\evil", "evil/evil", "..", " ", "", "C:evil", "evil*", "e\u200evil"]
)
def test_model_identifier_must_name_a_library(small: dict[str, Path], tmp_path: Path, identifier: str) -> None:
    path = rewritten(
        small["Source"],
        tmp_path / "evil.fmu",
        lambda text: text.replace('modelIdentifier="Source"', f'modelIdentifier="{identifier}"'),
    )
    rule = rf"evil\.fmu: the model identifier {re.escape(repr(identifier))} is not the name of a library"
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
        (lambda text: text[:-30], r"is not a valid FMU"),
        (lambda text: text.replace("<ModelVariables>", "<Variables>"), r"is not a valid FMU"),
        (lambda text: text.replace('fmiVersion="2.0"', 'fmiVersion="7.0"'), r"is not a valid FMU"),
        (lambda text: text.replace('start="0.125"', 'start="often"'), r"is not a valid FMU"),
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
    with pytest.raises(ArchiveError, match=r"hollow\.fmu is not a valid FMU: .*modelDescription\.xml"):
        read_description(hollow)
    with pytest.raises(ArchiveError, match=r"none\.fmu: there is no such FMU"):
        read_description(tmp_path / "none.fmu")


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


def test_what_says_nothing_of_dependencies_depends_on_all_inputs(small: dict[str, Path], tmp_path: Path) -> None:
    """FMI 2.0.4, section 2.2.8; master, `check` and energy ledger read the same."""

    def direct(edit: Callable[[str], str]) -> dict[str, bool]:
        found = read_description(edited(small["Integrator"], tmp_path, edit))
        return {v.name: v.direct for v in found.of_causality("output")}

    assert direct(lambda xml: f"{xml}\n") == {"x": False, "y": True}
    assert direct(lambda xml: re.sub(r' dependencies="[^"]*"', "", xml)) == {"x": True, "y": True}
    assert direct(lambda xml: re.sub(r"<Outputs>.*?</Outputs>", "", xml, flags=re.DOTALL)) == {"x": True, "y": True}
    assert direct(lambda xml: re.sub(r' dependencies="[^"]*"', ' dependencies=""', xml)) == {"x": False, "y": False}
    source = edited(small["Source"], tmp_path, lambda xml: re.sub(r' dependencies="[^"]*"', "", xml))
    assert not any(v.direct for v in read_description(source).of_causality("output"))  # it has no inputs


def test_the_energy_ledger_reads_dependencies_as_the_master_does(tmp_path: Path) -> None:
    """An output that may depend on its inputs jumps, wherever that is asked."""
    system = PROBLEMS["wall"].system(1e-3, 0.05)
    result, bond = simulate(system), PowerBond("wall.F", "mass.v")
    silent = edited(
        system.component("mass").description.path, tmp_path, lambda xml: re.sub(r' dependencies="[^"]*"', "", xml)
    )
    books = [
        ledger(result, replace(bond, jumps=("wall.F", "mass.v")), system),
        ledger(result, bond, system.replace("mass", silent)),
    ]
    np.testing.assert_array_equal(books[1].residual, books[0].residual)
    assert (books[0].residual != ledger(result, bond, system).residual).any()


@pytest.mark.parametrize(
    ("type_", "own", "relative"),
    [("", "", False), ("true", "", True), ("", "true", True), ("true", "false", False), ("false", "1", True)],
)
def test_a_difference_is_declared_by_the_variable_or_its_type(
    small: dict[str, Path], tmp_path: Path, type_: str, own: str, relative: bool
) -> None:
    """The variable's own word counts, and else that of its type."""

    def attribute(value: str) -> str:
        return f'relativeQuantity="{value}" ' if value else ""

    def edit(xml: str) -> str:
        xml = xml.replace('<Real quantity="Length"', f'<Real {attribute(type_)}quantity="Length"')
        return xml.replace('<Real declaredType="Length"', f'<Real {attribute(own)}declaredType="Length"') + "\n"

    description = read_description(edited(small["Integrator"], tmp_path, edit))
    assert {v.relative for v in description.variables.values() if v.unit == "m"} == {relative}


@pytest.mark.parametrize(
    ("edit", "sentence"),
    [
        (swap('name="even"', 'name="n"'), "the variable name 'n' is used more than once"),
        (swap('declaredType="Time"', 'declaredType="T"'), "sample_time: the type 'T' is not declared"),
        (
            swap("declaredType=", 'derivative="99" declaredType='),
            "derivative 99 is not the index of a variable; there",
        ),
        (
            swap('<Unknown index="', '<Unknown index="9'),
            "Outputs: the index 9[0-9]* is not that of a variable; there",
        ),
        (swap('dependencies="[^"]*"', 'dependencies="0"'), "Outputs: the index 0 is not that of a variable"),
        (swap(r'(name="sample_time".*?<Real[^>]*?) start="[^"]*"', r"\1"), "sample_time has no start value"),
    ],
)
def test_what_cannot_be_stepped_safely_is_refused(
    small: dict[str, Path], tmp_path: Path, edit: Callable[[str], str], sentence: str
) -> None:
    with pytest.raises(ArchiveError, match=rf"Source\.fmu is not a valid FMU: .*{sentence}"):
        read_description(edited(small["Source"], tmp_path, edit))


CONTINUOUS = swap(r'(name="u".*?) variability="discrete"', r'\1 variability="continuous"')


def test_a_parameter_of_another_meaning_needs_no_start_value(small: dict[str, Path], tmp_path: Path) -> None:
    """The outputs of a sampled component are all discrete."""
    without = swap(r'(name="sample_time".*?<Real[^>]*?) start="[^"]*"', r"\1")
    path = edited(small["Source"], tmp_path, lambda xml: CONTINUOUS(without(xml)))
    description = read_description(path)
    assert description.variables["sample_time"].start is None
    assert Component("a", description).sample_time is None


@pytest.mark.parametrize(
    ("edit", "sampled"),
    [(CONTINUOUS, False), (swap(r'(name="sample_time".*?<Real).*?/>', r'\1 unit="m" start="0.125"/>'), True)],
    ids=["continuous output", "unit m"],
)
def test_a_parameter_of_another_meaning_is_no_step_of_a_check(
    small: dict[str, Path], tmp_path: Path, edit: Callable[[str], str], sampled: bool
) -> None:
    """An FMU whose outputs are all discrete is sampled for rule 14, whether its period is known or not."""
    paths = small["Source"], edited(small["Source"], tmp_path, edit)
    plans = [supervision._plan(open_package(path), tmp_path) for path in paths]
    assert [(plan["step"], plan["step_proposed"], plan["sampled"]) for plan in plans] == [
        (0.125, True, True),
        (supervision.USUAL_STEP, False, sampled),
    ]


def test_formalities_are_left_to_check(small: dict[str, Path], tmp_path: Path) -> None:
    """An output with a start value, a display unit that nobody declared, a Boolean without variability."""
    path = edited(
        small["Source"],
        tmp_path,
        lambda xml: swap(r'(name="u".*?<Real)', r'\1 start="3.0" displayUnit="inch"')(
            swap(r'(name="even".*?) variability="discrete"', r"\1")(xml)
        ),
    )
    found, usual = read_description(path), read_description(small["Source"])
    assert found.variables["even"].variability == "discrete"  # only a Real can be continuous
    assert found.units == usual.units
    assert replace(found.variables["u"], start=None) == usual.variables["u"]


def test_a_unit_without_a_usable_factor_is_known_by_name_alone(small: dict[str, Path], tmp_path: Path) -> None:
    path = edited(small["Source"], tmp_path, swap(r'(<Unit name="m">\s*<BaseUnit)', r'\1 factor="0"'))
    unit = read_description(path).units["m"]
    assert conversion(unit, UnitDefinition("m")) == (1.0, 0.0)
    assert conversion(unit, UnitDefinition("mm", Unit((("m", 1),), 1e-3))) is None


def test_a_description_is_read_without_fmpy(small: dict[str, Path]) -> None:
    """Importing fmpy takes longer than all the rest."""
    script = (
        "import sys\nfrom pathlib import Path\nfrom orchestration.fmi.description import read_description\n"
        f"read_description(Path({str(small['Source'])!r}))\nsys.exit('fmpy' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", script], check=False).returncode == 0
