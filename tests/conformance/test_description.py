"""Tests of rules 1 to 6: modelDescription.xml, and the interface that the components of the paper's loop share."""

import importlib.resources
import re
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from fmpy.validation import validate_fmu
from fmu_manipulation_toolbox.checker import OperationGenericCheck, OperationSemanticCheck
from fmu_manipulation_toolbox.operations import FMU
from lxml import etree

from adaptimp_fmu import SampledModel, build
from adaptimp_fmu.model import Limits
from adaptimp_fmu.package import definition
from fmus.catalog import MODELS
from tests.conformance.binary import ERROR, OK, Binary, Instance, kind
from tests.conformance.container import CONTAINER, of_models
from tests.conformance.interface import INTERFACES, Signal
from tests.conformance.scenes import scene
from tests.conformance.units import SPATIAL, declared

# FMI 2.0.5, section 2.2.7: the combinations of causality and variability that an FMU without
# constants, locals and calculated parameters may use, and `initial` of each (None: must be absent).
LEGAL = {
    ("parameter", "fixed"): {"exact"},
    ("parameter", "tunable"): {"exact"},
    ("input", "discrete"): {None},
    ("input", "continuous"): {None},
    ("output", "discrete"): {"exact", "approx", "calculated"},
    ("output", "continuous"): {"exact", "approx", "calculated"},
}

# Powers of kg, m, s and rad, as the SI brochure has them.
BASE_UNITS = {
    "m/s2": (0, 1, -2, 0),
    "rad/s": (0, 0, -1, 1),
    "N": (1, 1, -2, 0),
    "N.m": (1, 2, -2, 0),
    "N/m": (1, 0, -2, 0),
    "N.s/m": (1, 0, -1, 0),
    "N.m.s/rad": (1, 2, -1, -1),
    "s/m": (0, -1, 1, 0),
}

# Structural dependencies that cancel: motion that leaves the tip of point masses still has no
# momentum about the last joint, where only the tip's mass hangs.
# The actuator's first tick starts at its target: lag and rate limit find nothing to do.
CANCELLING = {
    "HoganImpedance3R": {("tau_cmd[3]", "null_damping")},
    **{
        identifier: {
            (f"{output}[{i}]", known)
            for i in range(1, n + 1)
            for output in ("tau", "saturated")
            for known in ("sample_time", "time_constant", f"tau_rate_max[{i}]")
        }
        for identifier, n in (("Actuator", 2), ("Actuator3R", 3))
    },
}
# In the container what cancels in the actuator does not reach the arm's accelerations either.
CANCELLING[CONTAINER] = {(f"actuator.{output}", f"actuator.{known}") for output, known in CANCELLING["Actuator"]} | {
    (f"plant.ddq[{i}]", f"actuator.{known}") for i in (1, 2) for _, known in CANCELLING["Actuator"]
}


@pytest.fixture
def xml(fmu: Path) -> etree._Element:
    """Root of modelDescription.xml."""
    with zipfile.ZipFile(fmu) as archive:
        return etree.fromstring(archive.read("modelDescription.xml"))


def scalars(xml: etree._Element) -> list[tuple[etree._Element, etree._Element]]:
    """Each ScalarVariable and its type's element."""
    return [(variable, variable[0]) for variable in xml.findall("ModelVariables/ScalarVariable")]


def unknowns(xml: etree._Element, listing: str) -> dict[int, list[int]]:
    """Index of each unknown in a list of ModelStructure, and its dependencies, 1-based."""
    rows = xml.findall(f"ModelStructure/{listing}/Unknown")
    return {int(row.attrib["index"]): [int(i) for i in row.attrib["dependencies"].split()] for row in rows}


def test_01_validates_against_the_schema(xml: etree._Element) -> None:
    path = importlib.resources.files("fmpy") / "schema" / "fmi2" / "fmi2ModelDescription.xsd"
    schema = etree.XMLSchema(etree.parse(str(path)))
    assert schema.validate(xml), schema.error_log
    assert xml.get("fmiVersion") == "2.0"


def test_01_guid_is_the_binarys(xml: etree._Element, binary: Binary, create: Callable[..., Instance]) -> None:
    guid = xml.attrib["guid"].encode()
    assert re.fullmatch(rb"\{[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}\}", guid)
    assert guid in binary.path.read_bytes()
    assert create(binary, guid=guid).component


@of_models
def test_01_guid_is_a_hash_of_the_definition(xml: etree._Element, identifier: str) -> None:
    model = declared(identifier)
    assert etree.fromstring(definition(model)[1]).get("guid") == xml.get("guid")
    model.description += "."
    assert etree.fromstring(definition(model)[1]).get("guid") != xml.get("guid")


def test_01_guid_covers_the_equations() -> None:
    guids = set()
    for factor in (2.0, 3.0):
        model = SampledModel("Gain", "Multiplies")
        model.output("y", factor * model.input("u", 1.0, description="Input"), description="Output")
        guids.add(etree.fromstring(definition(model)[1]).get("guid"))
    assert len(guids) == 2


def test_02_combinations_are_legal_and_explicit(xml: etree._Element) -> None:
    for variable, typed in scalars(xml):
        combination = (variable.attrib["causality"], variable.attrib["variability"])
        assert combination in LEGAL, variable.get("name")
        assert variable.get("initial") in LEGAL[combination], variable.get("name")
        assert typed.tag == "Real" or variable.get("variability") != "continuous", variable.get("name")


def test_03_start_exactly_where_it_is_needed(xml: etree._Element) -> None:
    for variable, typed in scalars(xml):
        needed = variable.get("causality") == "input" or variable.get("initial") in ("exact", "approx")
        assert (typed.get("start") is not None) == needed, variable.get("name")


def test_04_structure_lists_every_output_in_order(xml: etree._Element) -> None:
    outputs = [i for i, (v, _) in enumerate(scalars(xml), start=1) if v.get("causality") == "output"]
    assert outputs
    assert list(unknowns(xml, "Outputs")) == outputs
    assert list(unknowns(xml, "InitialUnknowns")) == outputs


def test_04_dependencies_are_known_and_ascending(xml: etree._Element) -> None:
    causality = {i: v.get("causality") for i, (v, _) in enumerate(scalars(xml), start=1)}
    for listing, known in (("Outputs", {"input"}), ("InitialUnknowns", {"input", "parameter"})):
        for row in unknowns(xml, listing).values():
            assert row == sorted(set(row))
            assert {causality[i] for i in row} <= known
    for row in xml.iter("Unknown"):
        kinds = row.get("dependenciesKind")
        assert kinds is None or len(kinds.split()) == len(row.attrib["dependencies"].split())


def points(binary: Binary) -> list[dict[str, float]]:
    """Starts of inputs and parameters at which dependencies show: defaults, the scene, and points near both.

    Also the scene with the inputs' default starts: without a force the sensor's gate is closed.
    """
    rng = np.random.default_rng(2005)
    defaults = binary.starts("input", "parameter")
    bases = [defaults, defaults | scene(binary)]
    for limit in (name for name in defaults if name.rpartition(".")[2] == "range"):  # a force beyond it
        bases.append(bases[1] | {limit: 0.5})
    often = 15 if binary.name == CONTAINER else 5  # of more parameters, fewer points have contact
    near = [{n: moved(binary, n, v, rng) for n, v in base.items()} for base in bases for _ in range(often)]
    return [*bases, defaults | scene(binary) | binary.starts("input"), *near]


def moved(binary: Binary, name: str, value: float, rng: np.random.Generator) -> float:
    """Another legal value nearby: Reals by about 10 %, off zero by about 0.1, bounded ones upwards."""
    variable = binary.variables[name]
    if kind(variable) == "Boolean":
        return float(rng.integers(2))
    if kind(variable) == "Integer":
        return value + 1
    shift = 0.1 * rng.uniform(0.5, 1) * (abs(value) or 1.0)
    upwards = variable.causality == "parameter" and variable.min is not None
    return value + shift * (1 if upwards else rng.choice([-1, 1]))


def others(binary: Binary, name: str, value: float, rng: np.random.Generator) -> list[float]:
    """Values to change a variable to: nearby, and far enough to reach the other side of a switch."""
    variable = binary.variables[name]
    if kind(variable) == "Boolean":
        return [1 - value]
    near = moved(binary, name, value, rng)
    if kind(variable) == "Integer":
        return [near]
    return [near, value + 10 if variable.min is not None else value - 10]


def changed_outputs(instance: Instance, name: str, value: float) -> set[int]:
    """1-based positions among the outputs that move when one variable does; restores it.

    Bitwise: an output that does not depend on a variable is computed from the same bits.
    """
    before = instance.outputs()
    old = instance.get(name)[0]
    assert instance.set({name: value}) == OK
    after = instance.outputs()
    assert instance.set({name: old}) == OK
    return {i for i, (a, b) in enumerate(zip(before, after, strict=True), start=1) if a != b}


def test_04_initial_dependencies_are_those_seen(
    xml: etree._Element, binary: Binary, create: Callable[..., Instance]
) -> None:
    rng = np.random.default_rng(1991)
    names = list(binary.variables)
    declared = {
        (names[unknown - 1], names[known - 1])
        for unknown, row in unknowns(xml, "InitialUnknowns").items()
        for known in row
    }
    seen = set()
    outputs = binary.names("output")
    for point in points(binary):
        instance = create(binary, start=point).enter(t0=0.003)
        for known, value in point.items():
            for other in others(binary, known, value, rng):
                seen |= {(outputs[i - 1], known) for i in changed_outputs(instance, known, other)}
    assert seen <= declared, f"undeclared: {sorted(seen - declared)}"
    if binary.name in SPATIAL:  # ranges, stops, limits and a filter, of which no scene shows all
        return
    unseen = declared - seen - CANCELLING.get(binary.name, set())
    assert not unseen, f"declared but never seen (a scene may show them): {sorted(unseen)}"


@of_models
def test_04_direct_dependencies_cover_those_seen(
    xml: etree._Element, binary: Binary, create: Callable[..., Instance]
) -> None:
    """Outputs at the end of a vanishing step change with an input only where `Outputs` says so.

    A sampled FMU holds its outputs: between ticks no input reaches them. Of a continuous one the
    rates change by less than 1e2 h, forces by 1e3 N.s/m (K_f D_f 1 cm) times that: 1e-7 at h = 1e-12 s.
    """
    h, threshold = 1e-12, 1e-6
    names, outputs = list(binary.variables), binary.names("output")
    declared = {
        (names[unknown - 1], names[known - 1]) for unknown, row in unknowns(xml, "Outputs").items() for known in row
    }
    instance = create(binary, start=scene(binary)).initialize()
    assert instance.step(0.5e-4) == OK
    start, seen = instance.blob(), set()
    for name in binary.names("input", type="Real"):
        values = []
        for shift in (0.0, 1.0):
            assert instance.restore(start) == OK
            assert instance.set({name: instance.get(name)[0] + shift}) == OK
            assert instance.step(h) == OK
            values.append(instance.outputs())
        change = np.abs(values[1] - values[0])
        seen |= {(outputs[i], name) for i in np.flatnonzero(change > threshold)}
    assert seen == declared


def test_04_outputs_are_computed_by_steps_not_by_gets(binary: Binary, create: Callable[..., Instance]) -> None:
    instance = create(binary).initialize()
    assert instance.step(1e-4) == OK
    before = instance.outputs()
    assert instance.set({n: instance.get(n)[0] + 1 for n in binary.names("input", type="Real")}) == OK
    np.testing.assert_array_equal(instance.outputs(), before)


def test_05_names_are_unique_and_structured(xml: etree._Element, identifier: str) -> None:
    names = [variable.attrib["name"] for variable, _ in scalars(xml)]
    references = [variable.get("valueReference") for variable, _ in scalars(xml)]
    assert len(set(names)) == len(names)
    assert len(set(references)) == len(references)
    assert xml.get("variableNamingConvention") == "structured"
    own = r"[A-Za-z_][A-Za-z0-9_]*(\[[1-9][0-9]*\])?"
    assert all(re.fullmatch(rf"[A-Za-z_]\w*\.{own}" if identifier == CONTAINER else own, name) for name in names)
    assert all(variable.get("description") for variable, _ in scalars(xml))


def test_05_units_are_declared_with_base_units(xml: etree._Element) -> None:
    declared = {unit.get("name"): unit for unit in xml.findall("UnitDefinitions/Unit")}
    used = {typed.get("unit") for _, typed in scalars(xml)} - {None}
    assert used == set(declared)
    for name, unit in declared.items():
        base_unit = dict(next(unit.iterfind("BaseUnit")).attrib)
        assert base_unit or name == "1"
        if name in BASE_UNITS:
            powers = {base: str(power) for base, power in zip(("kg", "m", "s", "rad"), BASE_UNITS[name], strict=True)}
            assert base_unit == {base: power for base, power in powers.items() if power != "0"}


@of_models
def test_05_types_are_declared_used_and_agree(xml: etree._Element) -> None:
    declared = {simple.get("name"): simple[0] for simple in xml.findall("TypeDefinitions/SimpleType")}
    used = {typed.get("declaredType") for _, typed in scalars(xml)} - {None}
    assert used == set(declared)
    assert used
    assert not used & {variable.get("name") for variable, _ in scalars(xml)}
    for variable, typed in scalars(xml):
        if typed.get("declaredType"):
            simple = declared[typed.get("declaredType")]
            assert (simple.tag, simple.get("unit")) == (typed.tag, typed.get("unit")), variable.get("name")
            assert simple.get("quantity") or typed.get("declaredType") in ("BooleanAsReal", "IntegerAsReal")


def test_05_limits_hold(xml: etree._Element) -> None:
    for variable, typed in scalars(xml):
        if typed.tag != "Boolean" and typed.get("start") is not None:
            low, high = float(typed.get("min", "-inf")), float(typed.get("max", "inf"))
            assert low <= float(typed.attrib["start"]) <= high, variable.get("name")
            assert low < high, variable.get("name")
    experiment = {name: float(value) for name, value in next(xml.iterfind("DefaultExperiment")).attrib.items()}
    assert experiment["stopTime"] > experiment["startTime"]
    assert experiment["stepSize"] > 0


def test_05_limits_are_declared_and_enforced(tmp_path: Path, create: Callable[..., Instance]) -> None:
    """Both ends of a closed range, in the description and in the binary."""
    model = SampledModel("Limited", "Has a parameter with limits")
    model.output("y", model.parameter("p", 1.0, limits=Limits(-1.0, 2.5), description="In a range"), description="p")
    binary = Binary(build(model, tmp_path, cache=tmp_path / "cache"), tmp_path / "unpacked")
    assert (binary.variables["p"].min, binary.variables["p"].max) == ("-1", "2.5")
    instance = create(binary)
    assert [instance.set({"p": value}) for value in (-1.0, 2.5)] == [OK, OK]
    assert [instance.set({"p": value}) for value in (np.nextafter(-1.0, -2), np.nextafter(2.5, 3))] == [ERROR, ERROR]


def test_06_capabilities_agree(xml: etree._Element, fmu: Path) -> None:
    element = next(xml.iterfind("CoSimulation"))
    identifier = element.attrib["modelIdentifier"]
    assert element.get("canSerializeFMUstate") == element.get("canGetAndSetFMUstate") == "true"
    assert element.get("canHandleVariableCommunicationStepSize") == "true"
    assert element.get("canNotUseMemoryManagementFunctions") == "true", "the binary has its own malloc"
    assert element.get("canBeInstantiatedOnlyOncePerProcess") == "false"
    assert re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", identifier)
    with zipfile.ZipFile(fmu) as archive:
        entries = set(archive.namelist())
    binaries = [Path(entry) for entry in entries if entry.startswith("binaries/")]
    assert binaries
    assert {path.stem for path in binaries} == {identifier}
    assert {f"sources/{file.get('name')}" for file in element.iter("File")} <= entries
    categories = [category.get("name") for category in xml.findall("LogCategories/Category")]
    assert len(set(categories)) == len(categories) > 0


def test_01_to_06_fmpy_finds_no_problem(fmu: Path) -> None:
    assert validate_fmu(str(fmu)) == []


def test_01_to_06_fmutool_finds_no_problem(fmu: Path) -> None:
    generic, semantic = OperationGenericCheck(), OperationSemanticCheck()
    with FMU(str(fmu)) as archive:
        archive.apply_operation(generic)
        archive.apply_operation(semantic)
    assert generic.compliant_with_version == "2.0"
    assert semantic.errors == []


def base(name: str) -> str:
    """Name of the vector an element belongs to."""
    return name.partition("[")[0]


def assert_declared(binary: Binary, causality: str, signals: dict[str, Signal], *, exactly: bool) -> None:
    """The variables of a causality are those signals, with their units and starts."""
    found = binary.names(causality)
    expected = [element for name, signal in signals.items() for element in signal.elements(name)]
    assert set(expected) <= set(found), f"missing: {sorted(set(expected) - set(found))}"
    assert not exactly or set(found) == set(expected), f"not in the design: {sorted(set(found) - set(expected))}"
    for name, signal in signals.items():
        for element, start in zip(signal.elements(name), signal.starts, strict=True):
            variable = binary.variables[element]
            assert signal.unit is None or (variable.unit or "") == signal.unit, element
            # pi and pi^2 are rounded once more in the unit than here: 4 ulp
            assert start is None or binary.starts(causality)[element] == pytest.approx(start, rel=1e-15), element


@of_models
def test_05_interface_is_the_designs(binary: Binary) -> None:
    expected = INTERFACES[binary.name]
    assert_declared(binary, "input", expected.inputs, exactly=True)
    assert_declared(binary, "output", expected.outputs, exactly=not expected.open_outputs)
    assert_declared(binary, "parameter", expected.parameters, exactly=False)


@of_models
def test_05_tunables_and_discrete_outputs_are_the_designs(binary: Binary) -> None:
    expected = INTERFACES[binary.name]
    parameters = {base(name) for name in binary.names("parameter")}
    tunable = {base(name) for name in binary.names("parameter", variability="tunable")}
    assert tunable == parameters & expected.tunable
    for name in binary.names("output"):
        variable = binary.variables[name]
        held = expected.sampled or variable.type != "Real"
        assert variable.variability == ("discrete" if held else "continuous"), name


def test_05_inputs_start_where_the_others_are(load: Callable[[str], Binary], create: Callable[..., Instance]) -> None:
    """At t0 a controller's inputs are the outputs of Plant, ForceSensor and VirtualTrajectory.

    Joint angles, rates and accelerations are given to ten decimals: 5e-11, and what q and dq, rounded
    themselves, move ddq = -H^-1 C dq by, about 10 times as much.
    """
    for arm in {name.rpartition("Plant")[2] for name in MODELS if name.startswith("Plant")}:
        shown: dict[str, float] = {}
        for name in (f"Plant{arm}", "ForceSensor", "VirtualTrajectory"):
            source = create(load(name)).enter()
            shown |= dict(zip(source.binary.names("output"), source.outputs(), strict=True))
        for name in {name for name in MODELS if name.endswith("3R") == (arm == "3R")} - {"Plant", "Plant3R"}:
            starts = load(name).starts("input")
            for signal in starts.keys() & shown.keys():
                assert starts[signal] == pytest.approx(shown[signal], rel=0, abs=1e-9), f"{name}.{signal}"


def test_every_unit_has_a_designed_interface() -> None:
    assert set(MODELS) <= set(INTERFACES)
