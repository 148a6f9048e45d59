"""Tests that a package keeps the whole system: read(write(s)) == s, and writing again gives the same bytes.

The systems are random: names, values, connections, factors, assumptions and names of variables.
"""

import tempfile
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from lxml import etree

from orchestration import Component, Connection, System, SystemDescriptionError
from orchestration.fmi.description import read_description
from tests.unit.orchestration.packages import same

pytestmark = pytest.mark.usefixtures("own_cache")
# XML has no other characters below U+0020 than tab and line ends, and no surrogates.
TEXT = st.text(
    st.characters(exclude_categories=("Cs", "Cc"), exclude_characters="\ufffe\uffff"), min_size=1, max_size=12
)
NAMES = TEXT.filter(lambda name: "." not in name and name.strip() == name)
NUMBERS = st.floats(allow_nan=False)
FINITE = st.floats(allow_nan=False, allow_infinity=False)
INTEGERS = st.integers(-(2**31), 2**31 - 1)
UNCHECKED = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much]
UNCHECKED += [HealthCheck.function_scoped_fixture]  # one cache folder serves all examples


@st.composite
def systems(draw: st.DrawFn, fmus: dict[str, Path]) -> System:
    """Random systems of up to four components, with random start values and connections."""
    names = draw(st.lists(NAMES, min_size=1, max_size=4, unique=True))
    components, assumptions = [], {}
    for name in names:
        description = read_description(fmus[draw(st.sampled_from(sorted(fmus)))])
        if draw(st.booleans()):
            described = [v for v in description.variables if draw(st.booleans())]
            description = description.renamed({v: f"{v}{draw(st.sampled_from(['', '_', ' &']))}" for v in described})
        start = {}
        for variable in description.variables.values():
            if variable.causality in ("parameter", "input") and draw(st.booleans()):
                kinds = {"Real": NUMBERS, "Integer": INTEGERS.map(float), "Boolean": st.sampled_from([0.0, 1.0])}
                start[variable.name] = draw(kinds[variable.type])
                if draw(st.booleans()):
                    assumptions[f"{name}.{variable.name}"] = draw(TEXT)
        components.append(Component(name, description, start))
    connections = []
    for target in components:
        for variable in target.description.of_causality("input"):
            sources = [
                (component.name, output.name)
                for component in components
                for output in component.description.of_causality("output")
                if output.type == variable.type
            ]
            if sources and draw(st.booleans()):
                scale = draw(st.one_of(st.just((None, 0.0)), st.tuples(FINITE, FINITE)))
                scale = scale if variable.type == "Real" else (None, 0.0)
                connections.append(Connection(*draw(st.sampled_from(sources)), target.name, variable.name, *scale))
    step, stop = draw(st.none() | st.floats(1e-9, 1e3)), draw(st.none() | st.floats(0, 1e9))
    return System(draw(TEXT), tuple(components), tuple(connections), step, stop, assumptions=assumptions)


@settings(max_examples=60, deadline=None, derandomize=True, suppress_health_check=UNCHECKED)
@given(data=st.data())
def test_a_package_holds_all_of_a_system(data: st.DataObject, strange: dict[str, Path], small: dict[str, Path]) -> None:
    system = data.draw(systems({**strange, **small}))
    with tempfile.TemporaryDirectory() as folder:
        package = system.write(Path(folder) / "one.ssp")
        read = System.read(package)
        assert same(read, system)
        assert read.write(Path(folder) / "two.ssp").read_bytes() == package.read_bytes()
        shuffled = [replace(c, start=dict(reversed(list(c.start.items())))) for c in system.components]
        turned = replace(
            system, components=tuple(shuffled), assumptions=dict(reversed(list(system.assumptions.items())))
        )
        assert turned.write(Path(folder) / "three.ssp").read_bytes() == package.read_bytes()


def test_assumptions_are_annotations_of_the_system(signals: System, tmp_path: Path) -> None:
    assumed = replace(signals, assumptions={"relay.offset": 'said <nowhere> & "guessed"\n', "plant.x": "starts at 1"})
    package = assumed.write(tmp_path / "assumed.ssp")
    assert System.read(package).assumptions == assumed.assumptions
    with pytest.raises(SystemDescriptionError, match="relay has no variable z; there are "):
        replace(signals, assumptions={"relay.z": "is not there"})


def test_an_assumption_stands_beside_its_value(signals: System, tmp_path: Path) -> None:
    """The assumption is the attribute ``description`` of the value, which other tools show to their users."""
    assumed = replace(signals, assumptions={"relay.offset": "assumed: <any>"})
    with zipfile.ZipFile(assumed.write(tmp_path / "assumed.ssp")) as archive:
        values = etree.fromstring(archive.read("resources/relay.ssv"))
    described = {p.get("name"): p.get("description") for p in values.iterfind(".//{*}Parameter")}
    assert described == {"offset": "assumed: <any>", "n": None, "even": None}


def test_a_value_that_is_given_is_not_assumed(signals: System) -> None:
    texts = {"relay.offset": "any", "relay.n": "any", "plant.x_start": "the unit's own"}
    assumed = replace(signals, assumptions=texts)
    assert assumed.set({"relay.offset": 0.1, "switch.flag": True}).assumptions == texts
    assert assumed.set({"relay.offset": 0.2}).assumptions == {n: texts[n] for n in ("relay.n", "plant.x_start")}
    assert assumed.set({"plant.x_start": 2.0}).assumptions == {n: texts[n] for n in ("relay.offset", "relay.n")}


def test_what_xml_cannot_hold_is_refused(signals: System, tmp_path: Path) -> None:
    bell = replace(signals, name="ring \a")
    with pytest.raises(SystemDescriptionError, match=r"'ring \\x07': a name or an assumption cannot be written"):
        bell.write(tmp_path / "bell.ssp")
    assert not list(tmp_path.glob("bell*"))


def test_names_that_differ_by_case_or_punctuation_stay_apart(small: dict[str, Path], tmp_path: Path) -> None:
    description = read_description(small["Source"])
    names = ("A", "a", "a/b", "a b", "ä", "CON")
    system = System("names", tuple(Component(n, description, {"sample_time": 0.5 + i}) for i, n in enumerate(names)))
    assert same(System.read(system.write(tmp_path / "names.ssp")), system)
