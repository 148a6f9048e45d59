"""Tests that a written SSP package is valid, complete and reproducible, and can be read again."""

import importlib.resources
import re
import warnings
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from lxml import etree

from adaptimp_fmu import SampledModel, build
from orchestration import Options, System, UnconnectedInputWarning, simulate
from tests.unit.orchestration.packages import SSD_FILE, edited, same, substitute
from tests.unit.orchestration.small_models import H, system

pytestmark = pytest.mark.usefixtures("own_cache")


def test_what_is_written_is_read_again(signals: System, package: Path) -> None:
    read = System.read(package)
    assert same(read, signals)
    assert read.notices == ()
    assert read.component("relay").start == {"offset": 0.1, "n": -7.0, "even": 1.0}
    assert read.component("switch").start == {"flag": 0.0}
    assert simulate(read, 1.5).rows.tobytes() == simulate(signals, 1.5).rows.tobytes()


def test_order_survives(signals: System, tmp_path: Path) -> None:
    turned = signals.ordered(["switch", "plant", "relay", "source"])
    assert same(System.read(turned.write(tmp_path / "turned.ssp")), turned)


def test_a_single_component_and_numbers_of_numpy_survive(small: dict[str, Path], tmp_path: Path) -> None:
    lone = replace(system(small, {"plant": "Integrator"}), step=np.float64(0.1), stop_time=np.float64(0.3))
    lone = lone.set({"plant.x_start": np.float64(0.1)})
    assert same(System.read(lone.write(tmp_path / "lone.ssp")), lone)


def test_fig2_survives(fig2: System, tmp_path: Path) -> None:
    read = System.read(fig2.write(tmp_path / "fig2.ssp"))
    assert same(read, fig2)
    assert same(System.read(read.write(tmp_path / "again.ssp")), fig2)
    assert (tmp_path / "again.ssp").read_bytes() == (tmp_path / "fig2.ssp").read_bytes()


def test_same_system_same_bytes(signals: System, package: Path, tmp_path: Path) -> None:
    assert signals.write(tmp_path / "sub" / "other.ssp").read_bytes() == package.read_bytes()
    assert not list(tmp_path.rglob("*.part"))


def test_files_are_valid_against_the_standard(package: Path) -> None:
    schemas = importlib.resources.files("fmpy") / "ssp" / "schema"
    checked = 0
    with zipfile.ZipFile(package) as archive:
        for name in archive.namelist():
            kind = {"ssd": "Description", "ssv": "ParameterValues"}.get(name.rpartition(".")[2])
            if kind:
                schema = etree.XMLSchema(etree.parse(str(schemas / f"SystemStructure{kind}.xsd")))
                schema.assertValid(etree.fromstring(archive.read(name)))
                checked += 1
    assert checked == 5  # the structure; values of each component


def test_profile_is_the_one_other_engines_load(package: Path) -> None:
    with zipfile.ZipFile(package) as archive:
        text = archive.read(SSD_FILE).decode()
        values = archive.read("resources/relay.ssv").decode()
    assert "<ssd:SystemStructureDescription" in text
    assert '<ssv:Real value="0.1" unit="m"/>' in values
    assert '<ssv:Integer value="-7"/>' in values
    assert '<ssv:Boolean value="true"/>' in values
    connectors = set(re.findall(r'Connector name="(\w+)"', text))
    assert connectors == {
        "n",
        "even",
        "u",
        "y",
        "m",
        "odd",
        "flag",
        "x",
    }  # an unconnected variable such as source.u has no connector
    assert re.search(
        r"<ssd:System .*<ssd:Elements>.*<ssd:Connections>.*<ssd:Units>.*<ssd:DefaultExperiment",
        text,
        re.DOTALL,
    )


def test_two_fmus_of_one_file_name_stay_apart(small: dict[str, Path], tmp_path: Path) -> None:
    other = SampledModel("Source", "Shows one", sample_time=H)
    other.output("u", other.parameter("one", 1.0, description="One"), unit="m", description="One", scalar=True)
    fmus = {**small, "Other": build(other, tmp_path / "other")}
    twins = system(fmus, {"a": "Source", "b": "Other"})
    read = System.read(twins.write(tmp_path / "twins.ssp"))
    assert same(read, twins)
    assert simulate(read, H)["b.u"][0] == 1.0


def test_connections_may_be_written_from_either_end(signals: System, package: Path) -> None:
    turn = substitute(
        r'startElement="plant" startConnector="x" endElement="relay" endConnector="u"',
        'startElement="relay" startConnector="u" endElement="plant" endConnector="x"',
    )
    assert same(System.read(edited(package, SSD_FILE, turn)), signals)


def test_drawings_of_other_tools_do_no_harm(signals: System, package: Path) -> None:
    edit = substitute(r'pointsX="[^"]*" pointsY="[^"]*"', 'pointsX="0" pointsY="1"')
    assert same(System.read(edited(package, SSD_FILE, edit)), signals)


def test_inline_values_are_read(signals: System, package: Path) -> None:
    with zipfile.ZipFile(package) as archive:
        values = archive.read("resources/relay.ssv").decode().partition("?>")[2]
    inline = rf"<ssd:ParameterBinding\1><ssd:ParameterValues>{values}</ssd:ParameterValues></ssd:ParameterBinding>"
    edit = substitute(r'<ssd:ParameterBinding( type="[^"]*") source="resources/relay.ssv"/>', inline)
    assert same(System.read(edited(package, SSD_FILE, edit)), signals)


def test_a_run_begins_at_the_start_time_of_the_package(package: Path, tmp_path: Path) -> None:
    system = System.read(edited(package, SSD_FILE, substitute('startTime="0.0"', 'startTime="1.0"')))
    assert (system.start_time, system.stop_time, system.notices) == (1.0, 1.5, ())
    assert System.read(system.write(tmp_path / "again.ssp")).start_time == 1.0
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnconnectedInputWarning)
        assert simulate(system, record=()).time[[0, -1]].tolist() == [1.0, 1.5]
        asked = simulate(system, record=(), options=Options(start_time=0.0))
    assert asked.time[[0, -1]].tolist() == [0.0, 1.5]
