"""Tests of what only a container has: inner steps, failures of components, states in many places, its parts' papers."""

import ctypes as ct
import itertools
import math
import struct
import zipfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fmu_manipulation_toolbox.operations import FMU
from fmu_manipulation_toolbox.terminals import Terminals
from lxml import etree

from orchestration.containers.fmu.write import write_fmu
from orchestration.errors import ContainerError
from orchestration.sandbox.archive import file_hash
from tests.conformance.binary import ERROR, OK, Binary, Instance
from tests.conformance.calls import assert_refused
from tests.conformance.container import CONTAINER, PARTS, container_system, write_container
from tests.conformance.scenes import H, run, scene
from tests.conformance.test_state import assert_blob_refused, forged

Create = Callable[..., Instance]
OUT_OF_RANGE = "a parameter is out of its range"


@pytest.fixture
def identifier() -> str:
    """The container only."""
    return CONTAINER


def description(fmu: Path) -> etree._Element:
    """Root of modelDescription.xml."""
    with zipfile.ZipFile(fmu) as archive:
        return etree.fromstring(archive.read("modelDescription.xml"))


@pytest.mark.parametrize("ratio", [0.5, 0.999, 1.5, 1 + 1e-8, 1e-3, 1e-10, 2.5])
def test_a_step_that_is_no_multiple_is_refused_with_both_values(binary: Binary, create: Create, ratio: float) -> None:
    instance = create(binary, start=scene(binary)).initialize(t0=0.125)
    assert instance.step(3 * H) == OK
    before = instance.blob()
    assert_refused(
        instance, instance.step(ratio * H), before, f"h = {ratio * H:.17g} s", "whole multiple", f"{H:.17g} s"
    )
    assert instance.step(H) == OK


@pytest.mark.parametrize("t0", [0.0, 1e3])
def test_steps_of_a_clock_that_rounds_are_multiples(binary: Binary, create: Create, t0: float) -> None:
    """Differences of times, which are 4 eps |t| off; at 1000 s that is 1e-8 of the inner step."""
    instance, single = (create(binary, start=scene(binary)).initialize(t0=t0) for _ in range(2))
    times = t0 + 7 * H * np.arange(50)
    assert any(b - a < 7 * H for a, b in itertools.pairwise(times)), "a step cut off would lack an inner step"
    assert [instance.step(b - a, a) for a, b in itertools.pairwise(times)] == [OK] * 49
    assert [single.step(H, t0 + k * H) for k in range(7 * 49)] == [OK] * (7 * 49)
    np.testing.assert_array_equal(instance.outputs(), single.outputs())


def test_one_large_step_is_many_small_ones(binary: Binary, create: Create) -> None:
    one, many = (create(binary, start=scene(binary)).initialize(t0=0.125) for _ in range(2))
    forces = []
    for k in range(40):
        assert many.step(H, 0.125 + k * H) == OK
        forces.append(many.get("sensor.F_hat[1]")[0])
    assert one.step(40 * H) == OK
    np.testing.assert_array_equal(one.outputs(), many.outputs())
    assert len(set(forces)) > 30, "noise, while the tip is in the wall"


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_an_input_that_is_not_finite_is_stored_then_refused(binary: Binary, create: Create, value: float) -> None:
    name = "actuator.tau_cmd[2]"
    instance = create(binary).enter()
    assert instance.set({name: value}) == OK
    assert instance.call("fmi2ExitInitializationMode") == ERROR
    assert instance.last == f"Input {name} is {value:g}; it must be finite."
    assert instance.set({name: 0.0}) == OK
    assert instance.call("fmi2ExitInitializationMode") == OK
    assert instance.set({name: value}) == OK
    before = instance.blob()
    assert_refused(instance, instance.step(H), before, f"Input {name} is {value:g}")
    assert instance.set({name: 0.0}) == OK
    assert instance.step(H) == OK


def test_a_failing_component_is_named_and_an_earlier_state_leads_back(binary: Binary, create: Create) -> None:
    instance = create(binary, start=scene(binary)).initialize()
    run(instance, seed=1, steps=5)
    time, before = instance.time, instance.blob()
    assert instance.set({f"actuator.tau_max[{i}]": 1e300 for i in (1, 2)} | {"actuator.tau_cmd[1]": 1e300}) == OK
    assert instance.step(3 * H) == ERROR
    assert instance.last.startswith("plant: State q[1] is nan at t = ")
    assert instance.last.endswith(" s; it diverges.")
    assert instance.step(H) == ERROR
    assert 'not allowed in state "error"' in instance.last
    assert instance.restore(before) == OK
    assert instance.time == time
    assert instance.blob() == before
    run(instance, seed=2, steps=5)


def test_an_initialization_that_fails_changes_nothing(binary: Binary, create: Create) -> None:
    """Some components have ended theirs when another one refuses."""
    instance = create(binary, start={"sensor.noise_std": 1.0}).enter()
    shown = instance.outputs()
    assert instance.call("fmi2ExitInitializationMode") == ERROR
    assert instance.last.startswith("sensor: ")
    assert "noise_bound" in instance.last
    np.testing.assert_array_equal(instance.outputs(), shown)
    assert instance.set({"sensor.noise_bound": 3.0, "actuator.tau_cmd[1]": 0.5}) == OK
    assert instance.call("fmi2ExitInitializationMode") == OK
    fresh = create(binary, start={"sensor.noise_std": 1.0, "sensor.noise_bound": 3.0, "actuator.tau_cmd[1]": 0.5})
    fresh.initialize()
    for one in (instance, fresh):
        assert one.step(100 * H) == OK
    np.testing.assert_array_equal(instance.outputs(), fresh.outputs())


@pytest.mark.parametrize("period", [1.5e-4, 1e-12, 0.99e-4])
def test_a_sample_time_that_is_no_multiple_is_refused(binary: Binary, create: Create, period: float) -> None:
    instance = create(binary, start={"sensor.sample_time": period}).enter()
    assert instance.call("fmi2ExitInitializationMode") == ERROR
    assert instance.last == f"sensor: sample_time = {period:.17g} s is not a multiple of the step {H:.17g} s."
    assert instance.set({"sensor.sample_time": 2 * H}) == OK
    assert instance.call("fmi2ExitInitializationMode") == OK
    assert instance.step(H) == OK


def test_an_initialization_that_the_last_component_refuses_changes_nothing(binary: Binary, create: Create) -> None:
    instance = create(binary, start={"sensor.noise_std": 1.0, "sensor.noise_bound": 0.0}).enter()
    instance.outputs()
    before = instance.blob()
    assert_refused(instance, instance.call("fmi2ExitInitializationMode"), before, "sensor: ")
    assert instance.set({"sensor.noise_bound": 3.0}) == OK
    assert instance.call("fmi2ExitInitializationMode") == OK
    assert instance.step(H) == OK


def test_a_tiny_internal_step_is_refused_at_once(binary: Binary, create: Create) -> None:
    instance = create(binary, start={"plant.dt_max": 1e-12}).initialize()
    assert instance.step(1.0) == ERROR
    assert instance.last.startswith("plant: A step of ")
    assert "dt_max" in instance.last


def changed_byte(create: Create, binary: Binary, name: str) -> int:
    """Where a parameter stands in a state: the first byte that differs between two values."""
    value = binary.starts("parameter")[name]
    other = 1 - value if binary.variables[name].type == "Boolean" else value + 1
    blobs = [create(binary, start={name: v}).blob()[64:] for v in (value, other)]
    first = next(i for i, (a, b) in enumerate(zip(*blobs, strict=True)) if a != b)
    return 64 + 8 * (first // 8)


def test_made_up_parameters_are_refused(binary: Binary, create: Create) -> None:
    blob = create(binary, start=scene(binary)).initialize().blob()
    instance = create(binary)
    for variable in (v for v in binary.variables.values() if v.causality == "parameter"):
        place = changed_byte(create, binary, variable.name)
        wrong = {math.nan, math.inf}
        wrong |= {math.nextafter(float(variable.min), -math.inf)} if variable.min is not None else set()
        for value in wrong:
            assert_blob_refused(instance, forged(blob, place, struct.pack("<d", value)))
            assert OUT_OF_RANGE in instance.last


def test_made_up_states_are_refused(binary: Binary, create: Create) -> None:
    """Ticks, positions between ticks and numbers of steps of components; times and phase of the container."""
    instance = create(binary, start=scene(binary)).initialize(t0=0.125, stop=10.0)
    run(instance, seed=1, steps=7)
    ticks = round((instance.time - 0.125) / H)
    blob = instance.blob()
    counts = [i for i in range(64, len(blob), 8) if blob[i : i + 8] == struct.pack("<q", ticks)]
    assert len(counts) == 3, "ticks of the actuator and the sensor, and steps of the system"
    for place, count in itertools.product(counts, (-1, 2**62)):
        assert_blob_refused(instance, forged(blob, place, struct.pack("<q", count)))
        assert "impossible" in instance.last
    for place in counts[:2]:
        for fraction in (1.0, -0.5, math.nan):
            assert_blob_refused(instance, forged(blob, place + 8, struct.pack("<d", fraction)))
            assert "position" in instance.last
    latest_end = max(i for i in range(64, len(blob), 8) if blob[i : i + 8] == struct.pack("<d", 10.0))
    for place in (latest_end - 24, latest_end - 16, latest_end - 8):  # of the start, of the stop, of now
        assert_blob_refused(instance, forged(blob, place, struct.pack("<d", math.inf)))
        assert "time" in instance.last
    assert_blob_refused(instance, forged(blob, latest_end + 8, struct.pack("<i", 3)))
    assert "phase" in instance.last


def test_no_output_depends_on_an_input_within_a_communication_point(fmu: Path) -> None:
    """The actuator holds its torques, so that a command reaches the arm within the following step only."""
    rows = description(fmu).findall("ModelStructure/Outputs/Unknown")
    assert rows
    assert {row.get("dependencies") for row in rows} == {""}


def test_an_input_that_nothing_drives_feeds_through_as_its_component_declares(fmu_folder: Path, tmp_path: Path) -> None:
    """Without the actuator the torques are inputs, and the accelerations feel them at once."""
    system = container_system(fmu_folder)
    kept = tuple(c for c in system.connections if c.target != "plant")
    root = description(write_fmu(replace(system, connections=kept), tmp_path / "open.fmu"))
    names = [row.attrib["name"] for row in root.iterfind("ModelVariables/ScalarVariable")]
    depends = {
        names[int(row.attrib["index"]) - 1]: [names[int(i) - 1] for i in row.attrib["dependencies"].split()]
        for row in root.iterfind("ModelStructure/Outputs/Unknown")
    }
    assert {name for name, on in depends.items() if on} == {"plant.ddq[1]", "plant.ddq[2]"}
    assert depends["plant.ddq[1]"] == ["plant.tau[1]", "plant.tau[2]"]


def test_variables_are_those_of_the_parts(fmu: Path, fmu_folder: Path) -> None:
    """All attributes but names, references, types' names and starts that the system sets."""
    of_parts = {}
    for part, model in PARTS.items():
        root = description(fmu_folder / f"{model}.fmu")
        for row in root.iterfind("ModelVariables/ScalarVariable"):
            of_parts[f"{part}.{row.attrib['name']}"] = row
    driven = {f"plant.tau[{i}]" for i in (1, 2)} | {f"sensor.F_ext[{i}]" for i in (1, 2)}
    rows = description(fmu).findall("ModelVariables/ScalarVariable")
    assert [row.attrib["name"] for row in rows if row.get("causality") == "input"] == [
        "actuator.tau_cmd[1]",
        "actuator.tau_cmd[2]",
    ]
    assert {row.attrib["name"] for row in rows} == set(of_parts) - driven
    for row in rows:
        part = of_parts[row.attrib["name"]]
        for name in ("description", "causality", "variability", "initial"):
            assert row.get(name) == part.get(name), row.attrib["name"]
        assert row[0].tag == part[0].tag
        for name in ("unit", "displayUnit", "min", "max", "start"):
            assert row[0].get(name) == part[0].get(name), row.attrib["name"]


def test_each_component_is_a_terminal_with_its_own_names(fmu: Path, binary: Binary) -> None:
    opened = FMU(str(fmu))
    found = Terminals(opened.tmp_directory)
    assert list(found.terminals) == list(PARTS)
    members = {f"{terminal}.{name}": v for terminal in PARTS for name, v in found.terminals[terminal].members.items()}
    assert members == {name: name for name in binary.variables}


def test_the_page_says_what_the_container_is_made_of(fmu: Path, fmu_folder: Path, tmp_path: Path) -> None:
    changed = write_fmu(container_system(fmu_folder).set({"plant.K_f": 12345.0}), tmp_path / "changed.fmu")
    pages = []
    for file in (fmu, changed):
        with zipfile.ZipFile(file) as archive:
            pages.append(" ".join(archive.read("documentation/index.html").decode().split()))
    for model in PARTS.values():
        path = fmu_folder / f"{model}.fmu"
        for said in (path.name, file_hash(path), description(path).attrib["guid"]):
            assert said in pages[0]
    for said in (
        "actuator.tau[1] -&gt; plant.tau[1]",
        "gauss-seidel",
        "Inner step: 0.0001 s",
        "at most 1e7 inner steps",
    ):
        assert said in pages[0]
    assert "12345 N/m" not in pages[0]
    assert "12345 N/m" in pages[1]
    assert description(fmu).attrib["guid"] != description(changed).attrib["guid"]


def test_licenses_of_the_parts_and_of_the_program_are_inside(fmu: Path) -> None:
    with zipfile.ZipFile(fmu) as archive:
        text = archive.read("documentation/licenses/license.txt").decode()
        names = set(archive.namelist())
    for part, model in PARTS.items():
        assert f"{part} ({model}.fmu): MIT" in text
        assert f"documentation/licenses/{model}/license.txt" in names
        assert f"sources/fmus/{model}/runtime_license.txt" in names
    assert "MIT License" in text


def test_compiled_again_it_has_the_same_bytes(
    fmu: Path, fmu_folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path / "cache"))
    assert write_container(fmu_folder, tmp_path).read_bytes() == fmu.read_bytes()
    assert list((tmp_path / "cache").rglob("*.*")), "the cache was empty"


def test_the_binary_is_small(binary: Binary) -> None:
    assert binary.path.stat().st_size < 400_000


def test_an_unknown_platform_is_refused(fmu_folder: Path, tmp_path: Path) -> None:
    with pytest.raises(ContainerError, match="There is no platform linux46; did you mean linux64"):
        write_fmu(container_system(fmu_folder), tmp_path / "x.fmu", platforms=["linux46"])
    assert not (tmp_path / "x.fmu").exists()


def test_derivatives_are_refused(binary: Binary, create: Create) -> None:
    """The description declares none, and each function says so."""
    instance = create(binary).initialize()
    before, place = instance.blob(), (ct.c_double * 1)(7.0)
    output, one = instance.references("plant.q[1]"), (ct.c_int * 1)(1)
    status = instance.call("fmi2GetRealOutputDerivatives", output, 1, one, place)
    assert_refused(instance, status, before, "maxOutputDerivativeOrder is 0")
    known = instance.references("actuator.tau_cmd[1]")
    status = instance.call("fmi2GetDirectionalDerivative", output, 1, known, 1, place, place)
    assert_refused(instance, status, before, "providesDirectionalDerivative is false")
    status = instance.call("fmi2SetRealInputDerivatives", known, 1, one, place)
    assert_refused(instance, status, before, "canInterpolateInputs is false")
    assert place[0] == 7.0
