"""Tests of reading packages of other tools: nested systems, connectors, transformations, units, values.

Factors are powers of two and values small, so all predictions are exact.
"""

import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from orchestration import ArchiveError, Connection, System, SystemDescriptionError, simulate
from tests.unit.orchestration.foreign import (
    binding,
    component,
    connection,
    connector,
    entry,
    foreign,
    real,
    scaled,
    system_xml,
)
from tests.unit.orchestration.small_models import H

pytestmark = pytest.mark.usefixtures("own_cache")
PAIR = component("a", "Decay") + component("b", "Decay")
MAPPED = "<ssc:IntegerMappingTransformation><ssc:MapEntry source='1' target='2'/></ssc:IntegerMappingTransformation>"
FINE = 2.0**10  # fine units in a metre


def inner(bindings: str = "", unit: str = "", *, scale: str = "", name: str = "drive") -> str:
    """A system with a component ``b``, its input and output, and a parameter ``first`` for ``z_start``."""
    connectors = connector("cmd", "input", unit) + connector("out", "output") + connector("first", "parameter", unit)
    lines = connection("cmd", "b.u", scale) + connection("b.y", "out") + connection("first", "b.z_start", scale)
    return system_xml(name, component("b", "Decay"), lines, connectors, bindings)


def read(tmp_path: Path, fmus: dict[str, Path], xml: str, others: dict[str, str] | None = None) -> System:
    """Read a package with the given outermost system."""
    return System.read(foreign(tmp_path / "theirs.ssp", xml, fmus, others))


def start(tmp_path: Path, fmus: dict[str, Path], bindings: str, others: dict[str, str] | None = None) -> float:
    """Return the start value of ``z_start`` that bindings of a component give."""
    xml = system_xml("top", component("b", "Decay", bindings))
    return float(read(tmp_path, fmus, xml, others).component("b").start["z_start"])


def test_nested_systems_are_flattened(tmp_path: Path, strange: dict[str, Path]) -> None:
    deep = system_xml(
        "outer",
        inner(),
        connection("in", "drive.cmd") + connection("drive.out", "out"),
        connector("in", "input") + connector("out", "output"),
    )
    lines = connection("a.y", "outer.in") + connection("outer.out", "a.u")
    found = read(tmp_path, strange, system_xml("top", component("a", "Decay") + deep, lines))
    assert [c.name for c in found.components] == ["a", "outer__drive__b"]
    assert found.connections == (
        Connection("a", "y", "outer__drive__b", "u", 1.0),
        Connection("outer__drive__b", "y", "a", "u", 1.0),
    )
    assert found.name == "theirs"


def test_a_connector_leads_to_many_inputs_from_either_end(tmp_path: Path, strange: dict[str, Path]) -> None:
    fan = system_xml("fan", PAIR, connection("b.u", "in") + connection("in", "a.u"), connector("in", "input"))
    found = read(tmp_path, strange, system_xml("top", component("s", "Decay") + fan, connection("fan.in", "s.y")))
    assert {str(c) for c in found.connections} == {"s.y -> fan__a.u", "s.y -> fan__b.u"}


def test_transformations_and_units_add_up_along_the_way(tmp_path: Path, strange: dict[str, Path]) -> None:
    """The way has three parts: from fine units to metres (2**-10), 4 x + 1 m, and 2 x + 3 m."""
    lines = connection("a.y", "drive.cmd", scaled(4.0, 1.0))
    top = system_xml("top", component("a", "FineDecay") + inner(unit="m", scale=scaled(2.0, 3.0)), lines)
    (found,) = read(tmp_path, strange, top).connections
    assert (found.factor, found.offset) == (8 / FINE, 5.0)


def test_a_connector_without_a_unit_passes_the_value_as_it_is(tmp_path: Path, strange: dict[str, Path]) -> None:
    top = system_xml("top", component("a", "FineDecay") + inner(), connection("a.y", "drive.cmd"))
    assert read(tmp_path, strange, top).connections[0].factor == 1 / FINE


@pytest.mark.parametrize(
    ("attributes", "scale", "factor", "offset"),
    [
        ("", "", 1 / FINE, 0.0),
        ("", scaled(2.0, 0.5), 2 / FINE, 0.5),
        ('suppressUnitConversion="true"', "", 1.0, 0.0),
        ('suppressUnitConversion="1"', scaled(2.0, 0.5), 2.0, 0.5),
        ("", scaled(FINE), 1.0, 0.0),
    ],
)
def test_units_are_converted_before_transformations(
    tmp_path: Path, strange: dict[str, Path], attributes: str, scale: str, factor: float, offset: float
) -> None:
    elements = component("a", "FineDecay") + component("b", "Decay")
    found = read(tmp_path, strange, system_xml("top", elements, connection("a.y", "b.u", scale, attributes)))
    assert [(c.factor, c.offset) for c in found.connections] == [(factor, offset)]
    with pytest.warns(UserWarning, match=r"a\.u"):
        row = simulate(found, H, H).rows[0]
    assert row[1] == 8 + (factor * row[0] + offset) / 4  # b: y = z + u / 4
    again = System.read(found.write(tmp_path / "again.ssp"))
    assert again.connections == found.connections


def test_equal_names_of_different_units_are_told_apart(tmp_path: Path, strange: dict[str, Path]) -> None:
    """Two FMUs define a unit ``m`` differently; the definitions decide, and the name does not."""
    other = dict(strange)
    other["FineDecay"] = tmp_path / "Odd.fmu"
    rename_unit(strange["FineDecay"], other["FineDecay"])
    elements = component("a", "FineDecay") + component("b", "Decay")
    found = read(tmp_path, other, system_xml("top", elements, connection("a.y", "b.u")))
    assert found.connections[0].factor == 1 / FINE
    assert {found.component(n).variable(v).unit for n, v in (("a", "y"), ("b", "u"))} == {"m"}
    again = System.read(found.write(tmp_path / "again.ssp"))
    assert again.connections == found.connections


def rename_unit(fmu: Path, copy: Path) -> None:
    """Copy an FMU, and change the name of its unit ``fine`` to ``m``."""
    with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(copy, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            new.writestr(name, content.replace(b'"fine"', b'"m"') if name.endswith(".xml") else content)


def test_undriven_connectors_are_told(tmp_path: Path, strange: dict[str, Path]) -> None:
    top = system_xml("top", PAIR, connection("cmd", "b.u"), connector("cmd", "input"))
    assert read(tmp_path, strange, top).notices == (
        "Nothing drives the connector cmd of the system, so these inputs are unconnected: b.u.",
    )


@pytest.mark.parametrize(
    ("xml", "message"),
    [
        (system_xml("top", PAIR, connection("a.y", "b.u", MAPPED)), "IntegerMappingTransformation is not supported"),
        (system_xml("top", PAIR, connection("a.y", "out"), connector("out", "input")), "both ends give a value"),
        (system_xml("top", PAIR, connection("a.u", "in"), connector("in", "output")), "both ends take a value"),
        (
            system_xml("top", PAIR + inner(), connection("a.y", "drive.none")),
            "system drive has no connector none; there are cmd",
        ),
        (system_xml("top", PAIR + inner(unit="s"), connection("a.y", "drive.cmd")), "a.y -> drive.cmd: units m and s"),
        (system_xml("top", PAIR + inner(name="a")), "the element name 'a' is empty, or is used twice"),
        (system_xml("top", PAIR, connection("a.y", "b.u") + connection("b.y", "b.u")), r"b\.u already has a source"),
    ],
)
def test_connections_that_lead_nowhere_are_refused(
    tmp_path: Path, strange: dict[str, Path], xml: str, message: str
) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        read(tmp_path, strange, xml)


def test_a_circle_of_connectors_is_refused(tmp_path: Path, strange: dict[str, Path]) -> None:
    through = connector("in", "input") + connector("out", "output")
    lines = connection("p.out", "q.in") + connection("q.out", "p.in") + connection("a.y", "p.in")
    systems = "".join(system_xml(name, component("x", "Decay"), connection("in", "out"), through) for name in "pq")
    with pytest.raises(SystemDescriptionError, match=r"in a circle without a component: p\.in -> p\.out -> q\.in"):
        read(tmp_path, strange, system_xml("top", component("a", "Decay") + systems, lines))


@pytest.mark.parametrize(
    ("bindings", "value"),
    [
        (binding(real("z_start", 3.0)), 3.0),
        (binding(real("z_start", 3.0, "m")), 3.0),
        (binding(real("z_start", 3.0, "fine")), 3 / FINE),
        (binding(real("z_start", 3.0)) + binding(real("z_start", 5.0)), 5.0),
        (binding(real("start", 3.0), attributes='prefix="z_"'), 3.0),
        (binding(real("mine", 3.0), entry("mine", "z_start")), 3.0),
        (binding(real("mine", 3.0), entry("p.mine", "z_start"), 'prefix="p."'), 3.0),
        (binding(real("mine", 3.0), entry("mine", "z_start", scaled(2.0, 1.0))), 7.0),
        (binding(real("mine", 3.0, "fine"), entry("mine", "z_start", scaled(2.0, 1.0))), 6 / FINE + 1),
        (binding(real("mine", 3.0, "s"), entry("mine", "z_start", "", 'suppressUnitConversion="true"')), 3.0),
        (binding(real("one", 1.0) + real("two", 2.0), entry("one", "u") + entry("two", "z_start")), 2.0),
    ],
)
def test_values_reach_their_variable(tmp_path: Path, strange: dict[str, Path], bindings: str, value: float) -> None:
    assert start(tmp_path, strange, bindings) == value


@pytest.mark.parametrize(
    ("bindings", "value"),
    [
        (binding(real("drive.b.z_start", 3.0)), 3.0),
        (binding(real("b.z_start", 3.0), attributes='prefix="drive."'), 3.0),
        (binding(real("drive.first", 3.0)), 7.0),  # through the connector: 2 x + 1
        (binding(real("drive.first", 3.0, "fine")), 6 / FINE + 1),
        (binding(real("mine", 3.0), entry("mine", "drive.first", scaled(4.0))), 25.0),
    ],
)
def test_values_of_a_system_go_inside_and_win(
    tmp_path: Path, strange: dict[str, Path], bindings: str, value: float
) -> None:
    drive = inner(binding(real("b.z_start", 100.0)), "m", scale=scaled(2.0, 1.0))
    found = read(tmp_path, strange, system_xml("top", drive, bindings=bindings))
    assert found.component("drive__b").start == {"z_start": value}
    found = read(tmp_path, strange, system_xml("top", drive))
    assert found.component("drive__b").start == {"z_start": 100.0}


def test_values_and_mappings_may_lie_in_files(tmp_path: Path, strange: dict[str, Path]) -> None:
    values = f'<ssv:ParameterSet xmlns:ssv="{NAMESPACE}ParameterValues" version="1.0" name="p">'
    values += f"<ssv:Parameters>{real('mine', 3.0, 'ell')}</ssv:Parameters><ssv:Units>"
    values += f'<ssc:Unit xmlns:ssc="{NAMESPACE}Common" name="ell"><ssc:BaseUnit m="1" factor="0.5"/></ssc:Unit>'
    values += "</ssv:Units></ssv:ParameterSet>"
    mapping = f'<ssm:ParameterMapping xmlns:ssm="{NAMESPACE}ParameterMapping" version="1.0">'
    mapping += f"{entry('mine', 'z_start')}</ssm:ParameterMapping>"
    files = {"extra/my values.ssv": values, "extra/map.ssm": mapping}
    bindings = '<ssd:ParameterBinding source="extra/my%20values.ssv"><ssd:ParameterMapping source="extra/map.ssm"/>'
    assert start(tmp_path, strange, f"{bindings}</ssd:ParameterBinding>", files) == 1.5
    for wrong in ("../map.ssm", "extra/none.ssm"):
        with pytest.raises(ArchiveError, match=rf"the source '{wrong}' is "):
            start(tmp_path, strange, f"{bindings}</ssd:ParameterBinding>".replace("extra/map.ssm", wrong), files)


NAMESPACE = "http://ssp-standard.org/SSP1/SystemStructure"


@pytest.mark.parametrize(
    ("bindings", "message"),
    [
        (binding(real("z_start", 3.0, "s")), r"b\.z_start is given in s, but the unit in the FMU is m"),
        (binding(real("z_start", 3.0, "ell")), r"b\.z_start is given in ell, but the unit in the FMU is m"),
        (binding(real("mine", 3.0), entry("yours", "z_start")), "has no parameter yours to map; there are mine"),
        (binding(real("mine", 3.0), entry("mine", "z_start", MAPPED)), "IntegerMapping.* not apply to .* type Real"),
        (binding(real("z_start", 3.0), attributes='type="text/csv"'), "of type text/csv are not supported"),
    ],
)
def test_values_that_fit_nothing_are_refused(
    tmp_path: Path, strange: dict[str, Path], bindings: str, message: str
) -> None:
    with pytest.raises(SystemDescriptionError, match=message):
        start(tmp_path, strange, bindings)


@pytest.mark.parametrize(
    "bindings",
    [
        binding(real("z", 3.0)),
        binding(real("mine", 3.0), entry("mine", "z")),
        binding(real("z_start", 3.0), attributes='prefix="p."'),
        binding(real("mine", 3.0), entry("mine", "z_start") + entry("", "z_start")),
    ],
)
def test_parameters_that_mean_nothing_to_a_component_are_ignored_and_told(
    tmp_path: Path, strange: dict[str, Path], bindings: str
) -> None:
    found = read(tmp_path, strange, system_xml("top", component("b", "Decay", bindings)))
    assert len([notice for notice in found.notices if "is ignored, because" in notice]) == 1
    assert found["b"].start.get("z_start") in (None, 3.0)


def test_names_of_elements_may_have_dots_and_the_system_may_be_an_empty_name(
    tmp_path: Path, strange: dict[str, Path]
) -> None:
    top = system_xml(
        "top",
        component("left.arm", "Decay") + component("b", "Decay"),
        connection("left.arm.y", "b.u") + connection("u", "left.arm.u", attributes='startElement=""'),
        connectors=connector("u", "input"),
        bindings=binding(real("left.arm.z_start", 3.0)),
    )
    found = read(tmp_path, strange, top)
    assert [str(c) for c in found.connections] == ["left__arm.y -> b.u"]
    assert found["left__arm"].start == {"z_start": 3.0}
    assert "The component left.arm is called left__arm, because a name in a system has no dot." in found.notices


def test_ignored_values_are_told(tmp_path: Path, strange: dict[str, Path]) -> None:
    mapped = binding(real("mine", 3.0) + real("other", 1.0), entry("mine", "b.z_start"))
    top = system_xml("top", component("b", "Decay"), bindings=binding(real("b.none", 3.0)) + mapped)
    found = read(tmp_path, strange, top)
    assert [notice.partition(": ")[2] or notice for notice in found.notices] == [
        "The parameter b.none of the system is ignored, because no variable has that name.",
        "the parameter mapping of the system does not map other, so other is ignored.",
    ]
    assert replace(found, notices=()) == found  # notices do not count in a comparison
