"""Tests of the references inside each FMU: form of FMI-LS-REF, and another tool repeats the runs from the file alone.

The schema of the standard's manifest is a draft and comes with no package, so its rules are written out here. The
files were validated against the draft's schema, too (docs/components.md).
"""

import importlib.resources
import io
import re
import zipfile
from pathlib import Path, PurePosixPath
from typing import Any, cast

import fmpy
import numpy as np
import pytest
from lxml import etree

from fmus.catalog import MODELS
from orchestration import scenario
from orchestration.paper.reference_data import FOLDER as REPOSITORY
from orchestration.paper.scenarios import SCENARIOS, VARIANTS
from orchestration.ssp.schema import SSV
from tests.conformance.binary import Binary
from tests.conformance.replay import table

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
NAMESPACE = "{http://fmi-standard.org/fmi-ls-manifest}"
ROLES = re.compile(
    r"document|requirement|specification|model|parameter|system|testcase"
    r"|experiment(/(smoke-test|validation|uncertainty-analysis))?|result|method|rationale|report|request|delivery"
    r"|configuration|signature|serialized-state(/.*)?|meta-data|other"
)
TYPES = {
    "experiment/smoke-test": "application/x-ma-hs-experiments",
    "parameter": "application/x-ssp-parameter-set",
    "result": "text/csv",
    "testcase": "text/csv",
}


LARGEST = 16_000  # bytes by which an FMU grows, as docs/components.md says


class Inside:
    """The folder of the layered standard in an FMU."""

    def __init__(self, fmu: Path) -> None:
        with zipfile.ZipFile(fmu) as archive:
            self.files = {
                str(PurePosixPath(name).relative_to(FOLDER)): archive.read(name)
                for name in archive.namelist()
                if name.startswith(f"{FOLDER}/")
            }
            self.pages = {name: archive.read(name) for name in archive.namelist() if name.startswith("documentation/")}
        self.manifest = etree.fromstring(self.files["fmi-ls-manifest.xml"])

    def sources(self, role: str) -> list[str]:
        """Files of a role."""
        return [one.attrib["source"] for one in self.manifest if one.get("role") == role]

    def table(self, name: str) -> np.ndarray:
        """A table as NumPy reads it."""
        text = io.StringIO(self.files[name].decode().replace('"', ""))
        return np.atleast_1d(np.genfromtxt(text, delimiter=",", names=True, deletechars="", replace_space=""))


@pytest.fixture(params=list(MODELS))
def identifier(request: pytest.FixtureRequest) -> str:
    """Name of each FMU in turn; the container has no runs of its own."""
    return request.param


@pytest.fixture
def inside(fmu: Path) -> Inside:
    """The folder of each FMU in turn."""
    return Inside(fmu)


def test_the_manifest_names_the_standard(inside: Inside) -> None:
    root = inside.manifest
    assert root.tag == "fmiReferences"
    assert dict(root.attrib) == {
        f"{NAMESPACE}fmi-ls-name": "org.fmi-standard.fmi-ls-ref",
        f"{NAMESPACE}fmi-ls-version": "1.0.0-alpha.1",
        f"{NAMESPACE}fmi-ls-description": "Layered Standard providing information on related files included in an FMU.",
    }


def test_each_file_is_described_once(inside: Inside) -> None:
    described = [one.attrib["source"] for one in inside.manifest]
    assert sorted([*described, "fmi-ls-manifest.xml"]) == sorted(inside.files)


def test_each_description_keeps_the_rules_of_the_draft(inside: Inside) -> None:
    for one in inside.manifest:
        assert one.tag == "Related"
        assert set(one.attrib) == {"type", "source", "role", "description"}
        assert ROLES.fullmatch(one.attrib["role"])
        assert one.attrib["type"] == TYPES[one.attrib["role"]]
        assert one.attrib["description"]
        for label in one:
            assert label.tag == "Label"
            assert set(label.attrib) == {"name"}
            assert label.attrib["name"].startswith("variant:")


def test_the_experiment_names_its_files(inside: Inside, identifier: str, binary: Binary) -> None:
    (source,) = inside.sources("experiment/smoke-test")
    root = etree.fromstring(inside.files[source])
    assert root.tag == "Experiments"
    assert set(root.attrib) == {"name", "description"}
    (experiment,) = root
    assert experiment.tag == "Experiment"
    assert set(experiment.attrib) == {"name", "description", "startTime", "stopTime", "stepSize", "tolerance"}
    tables = {one.tag: dict(one.attrib) for one in experiment}
    driven = {"Stimuli": {"type": "text/csv", "source": f"{identifier}_in.csv"}} if binary.names("input") else {}
    assert tables == {**driven, "References": {"type": "text/csv", "source": f"{identifier}_ref.csv"}}
    assert inside.sources("testcase") == [one["source"] for one in driven.values()]
    assert inside.sources("result") == [f"{identifier}_ref.csv"]


def test_another_tool_repeats_the_run_from_the_file_alone(fmu: Path, inside: Inside) -> None:
    """With fmpy, from the FMU's file; no output differs by more than the tolerance that stands in the FMU."""
    (source,) = inside.sources("experiment/smoke-test")
    experiment = etree.fromstring(inside.files[source])[0]
    start, stop, step, tolerance = (
        float(experiment.attrib[name]) for name in ("startTime", "stopTime", "stepSize", "tolerance")
    )
    tables = {one.tag: inside.table(one.attrib["source"]) for one in experiment}
    expected = tables["References"]
    columns = expected.dtype.names or ()
    result = fmpy.simulate_fmu(
        str(fmu),
        start_time=start,
        stop_time=stop,
        step_size=step,
        output_interval=step,
        input=cast("Any", tables.get("Stimuli")),
        output=list(columns[1:]),
    )
    assert result.size == expected.size
    assert np.ptp([expected[name] for name in columns[1:]], axis=1).max() > 0, "nothing moves"
    for name in columns[1:]:
        atol = tolerance * np.max(np.abs(expected[name]))
        np.testing.assert_allclose(result[name], expected[name], rtol=0, atol=atol, err_msg=name)


def test_the_tables_are_those_of_the_repository(inside: Inside, identifier: str) -> None:
    np.testing.assert_array_equal(inside.table(f"{identifier}_ref.csv")["time"], table(identifier, "ref")["time"])
    for source in (*inside.sources("testcase"), *inside.sources("result")):
        assert inside.files[source] == (REPOSITORY / identifier / source).read_bytes()


def values(content: bytes) -> dict[str, float]:
    """Numbers of a parameter set, by parameter."""
    words = {"true": 1.0, "false": 0.0}
    found = etree.fromstring(content).iterfind(f"{{{SSV}}}Parameters/{{{SSV}}}Parameter")
    texts = {parameter.attrib["name"]: parameter[0].attrib["value"] for parameter in found}
    return {name: words[text] if text in words else float(text) for name, text in texts.items()}


def test_parameter_sets_are_valid(inside: Inside) -> None:
    path = importlib.resources.files("fmpy") / "ssp" / "schema" / "SystemStructureParameterValues.xsd"
    schema = etree.XMLSchema(etree.parse(str(path)))
    for source in inside.sources("parameter"):
        schema.assertValid(etree.fromstring(inside.files[source]))
        assert values(inside.files[source])


@pytest.mark.parametrize("run", [*SCENARIOS, *VARIANTS])
def test_parameter_sets_are_the_start_values_of_the_runs(run: str, fmu_folder: Path) -> None:
    system = scenario(run)
    for component in system.components:
        inside = Inside(fmu_folder / component.description.path.name)
        labelled = [
            one.attrib["source"]
            for one in inside.manifest
            if f"variant:{run}" in [label.attrib["name"] for label in one]
        ]
        assert len(labelled) == 1, component.name
        assert values(inside.files[labelled[0]]) == dict(component.start)


def test_fmus_of_no_run_have_no_parameter_sets(inside: Inside, identifier: str) -> None:
    used = {model for one in (*SCENARIOS.values(), *VARIANTS.values()) for model in one.models.values()}
    assert bool(inside.sources("parameter")) == (identifier in used)
    assert used < set(MODELS)


def test_an_fmu_grows_by_little(fmu: Path) -> None:
    with zipfile.ZipFile(fmu) as archive:
        entries = [e for e in archive.infolist() if e.filename.startswith(f"{FOLDER}/") or "ls-ref" in e.filename]
    heads = 46 + 30  # bytes of each entry in the archive's directory and before its content, besides its name
    assert 4000 < sum(e.compress_size + 2 * len(e.filename) + heads for e in entries) < LARGEST


def test_the_documentation_explains_the_files(inside: Inside) -> None:
    page = inside.pages["documentation/fmi-ls-ref.html"].decode()
    for one in inside.manifest:
        assert f"<code>{one.attrib['source']}</code>" in page
    assert '<a href="fmi-ls-ref.html">' in inside.pages["documentation/index.html"].decode()
