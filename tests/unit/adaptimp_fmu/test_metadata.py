"""Tests of a model's metadata: an FMU does not claim anything that its model does not state."""

import math
import zipfile
from pathlib import Path

import pytest
from lxml import etree

from adaptimp_fmu import DefinitionError, Experiment, Ownership, SampledModel, build, runtime_license
from adaptimp_fmu.documentation import documentation
from adaptimp_fmu.package import definition

ROOT = Path(__file__).parents[3]
LICENSE = "documentation/licenses/license.txt"


def gain(ownership: Ownership | None = None, experiment: Experiment | None = None) -> SampledModel:
    """A model that multiplies by two."""
    model = SampledModel(
        "Gain", "Multiplies", ownership=ownership or Ownership(), experiment=experiment or Experiment()
    )
    model.output("y", 2 * model.input("u", 1.0, description="Input"), description="Output")
    return model


def described(model: SampledModel) -> etree._Element:
    """The root of modelDescription.xml."""
    return etree.fromstring(definition(model)[1])


def page(model: SampledModel) -> str:
    """The documentation's HTML."""
    return documentation(model)["index.html"].decode()


def test_a_model_that_says_nothing_claims_nothing(tmp_path: Path) -> None:
    root = described(gain())
    assert not {"author", "version", "copyright", "license"} & set(root.attrib)
    assert root.find("DefaultExperiment") is None
    with zipfile.ZipFile(build(gain(), tmp_path, cache=tmp_path / "cache")) as archive:
        assert not [name for name in archive.namelist() if name.startswith("documentation/licenses")]
        assert "MIT" not in archive.read("documentation/index.html").decode()
    assert "The author of the model states no license." in page(gain())


def test_what_a_model_states_is_in_the_fmu(tmp_path: Path) -> None:
    stated = Ownership("Ada <Example>", "2.1", "(c) 2026 Ada & Co", "Confidential", "Ask Ada first.\n")
    model = gain(stated, Experiment(1.0, 3.5, 0.25, 1e-6))
    root = described(model)
    names = ("author", "version", "copyright", "license")
    assert [root.get(name) for name in names] == ["Ada <Example>", "2.1", "(c) 2026 Ada & Co", "Confidential"]
    experiment = root.find("DefaultExperiment")
    assert experiment is not None
    assert dict(experiment.attrib) == {"startTime": "1", "stopTime": "3.5", "stepSize": "0.25", "tolerance": "1e-06"}
    with zipfile.ZipFile(build(model, tmp_path, cache=tmp_path / "cache")) as archive:
        assert archive.read(LICENSE) == b"Ask Ada first.\n"
    text = page(model)
    for shown in (
        "Version: 2.1",
        "Author: Ada &lt;Example&gt;",
        "Copyright: (c) 2026 Ada &amp; Co",
        "Confidential, in <a",
    ):
        assert shown in text


@pytest.mark.parametrize(
    ("ownership", "sentence"),
    [
        (Ownership(license="BSD-3-Clause"), "License of the model: BSD-3-Clause."),
        (Ownership(license_text="Text"), 'License of the model: in <a href="licenses/license.txt">'),
    ],
    ids=["name alone", "text alone"],
)
def test_the_page_shows_half_a_license(ownership: Ownership, sentence: str) -> None:
    assert sentence in " ".join(page(gain(ownership)).split())


def test_only_what_is_stated_of_an_experiment_is_written() -> None:
    experiment = described(gain(experiment=Experiment(stop_time=5.0))).find("DefaultExperiment")
    assert experiment is not None
    assert dict(experiment.attrib) == {"stopTime": "5"}


def test_ownership_is_part_of_the_guid() -> None:
    """The GUID is a hash of modelDescription.xml, which holds what the model states."""
    guids = {described(gain(ownership)).get("guid") for ownership in (None, Ownership(version="1"), Ownership("Ada"))}
    assert len(guids) == 3


def test_the_runtime_keeps_its_license_in_every_fmu(tmp_path: Path) -> None:
    assert runtime_license() == (ROOT / "LICENSE").read_text(encoding="utf-8")
    with zipfile.ZipFile(build(gain(), tmp_path, cache=tmp_path / "cache")) as archive:
        notice = archive.read("sources/runtime_license.txt").decode()
    assert notice.endswith(runtime_license())
    assert "model.c, sizes.h and\nequations.h. Those files are generated from the model" in notice


@pytest.mark.parametrize(
    ("numbers", "sentence"),
    [
        ({"stop_time": math.inf}, "stop_time is inf; it must be finite"),
        ({"start_time": math.nan}, "start_time is nan; it must be finite"),
        ({"step_size": 0.0}, r"step_size is 0\.0; it must be positive"),
        ({"tolerance": -1e-6}, "tolerance is -1e-06; it must be positive"),
        ({"stop_time": 0.0}, r"stop_time 0\.0 s must be later than start_time 0\.0 s"),
        ({"start_time": 2.0, "stop_time": 1.0}, r"stop_time 1\.0 s must be later than start_time 2\.0 s"),
    ],
)
def test_experiments_that_cannot_be_run_are_refused(numbers: dict[str, float], sentence: str) -> None:
    with pytest.raises(DefinitionError, match=sentence):
        Experiment(**numbers)
