"""Tests of references in an FMU: a model's runs and parameter sets are written as declared, or refused."""

import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree

from adaptimp_fmu import (
    POSITIVE,
    DefinitionError,
    Experiment,
    ParameterSet,
    ReferenceRun,
    SampledModel,
    Type,
    build,
)
from adaptimp_fmu.package import definition

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
SSV = "{http://ssp-standard.org/SSP1/SystemStructureParameterValues}"
EXPERIMENT = Experiment(start_time=0.0, stop_time=0.2, step_size=0.1, tolerance=1e-9)
RESULTS = b'"time","y[1]","y[2]"\n0,0,0\n0.1,2,3\n0.2,2,3\n'
INPUTS = b"time,u\n0,1\n0.1,1\n0.2,1\n"


def gain() -> SampledModel:
    """A model with parameters of all types, an input and an output."""
    model = SampledModel("Gain", "Multiplies")
    k = model.parameter("k", [2.0, 3.0], unit="N/m", limits=POSITIVE, tunable=True, description="Gain for each axis")
    n = model.parameter("n", 1, type=Type.INTEGER, description="Repetitions")
    on = model.parameter("on", 1, type=Type.BOOLEAN, description="Whether it acts")
    model.output("y", k * n * on * model.input("u", 1.0, description="Input"), description="Output")
    return model


def run(results: bytes = RESULTS, inputs: bytes = INPUTS, experiment: Experiment = EXPERIMENT) -> ReferenceRun:
    """A run of the gain."""
    return ReferenceRun("step", experiment, results, inputs, "A constant input")


def built(folder: Path, *runs: ReferenceRun, sets: tuple[ParameterSet, ...] = ()) -> Mapping[str, bytes]:
    """Entries of the FMU with these references."""
    model = gain()
    model.reference_runs, model.parameter_sets = runs, sets
    with zipfile.ZipFile(build(model, folder)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_a_model_without_references_has_no_files_of_the_standard(tmp_path: Path) -> None:
    entries = built(tmp_path)
    assert not [name for name in entries if name.startswith("extra/")]
    assert "documentation/fmi-ls-ref.html" not in entries
    assert b"fmi-ls-ref" not in entries["documentation/index.html"]


def test_runs_are_written_with_their_experiment(tmp_path: Path) -> None:
    entries = built(tmp_path, run())
    assert entries[f"{FOLDER}/step_ref.csv"] == RESULTS
    assert entries[f"{FOLDER}/step_in.csv"] == INPUTS
    (experiment,) = etree.fromstring(entries[f"{FOLDER}/Gain.exp"])
    assert dict(experiment.attrib) == {
        "name": "step",
        "description": "A constant input",
        "startTime": "0",
        "stopTime": "0.2",
        "tolerance": "1e-09",
        "stepSize": "0.1",
    }
    assert [(one.tag, one.get("source")) for one in experiment] == [
        ("Stimuli", "step_in.csv"),
        ("References", "step_ref.csv"),
    ]


def test_a_run_without_inputs_has_no_table_of_them(tmp_path: Path) -> None:
    entries = built(tmp_path, run(inputs=b""))
    assert f"{FOLDER}/step_in.csv" not in entries
    assert [one.tag for one in etree.fromstring(entries[f"{FOLDER}/Gain.exp"])[0]] == ["References"]


def test_a_parameter_set_holds_types_units_and_arrays(tmp_path: Path) -> None:
    given = ParameterSet("soft", {"on": False, "k": [0.5, 1e-3], "n": 3}, "A soft wall", ["wall", "sponge"])
    entries = built(tmp_path, sets=(given,))
    root = etree.fromstring(entries[f"{FOLDER}/soft.ssv"])
    values = [
        (one.get("name"), etree.QName(one[0]).localname, one[0].get("value"), one[0].get("unit"))
        for one in root.iter(f"{SSV}Parameter")
    ]
    assert values == [
        ("k[1]", "Real", "0.5", "N/m"),
        ("k[2]", "Real", "0.001", "N/m"),
        ("n", "Integer", "3", None),
        ("on", "Boolean", "false", None),
    ]
    assert root.get("description") == "A soft wall"
    labels = [label.get("name") for label in etree.fromstring(entries[f"{FOLDER}/fmi-ls-manifest.xml"]).iter("Label")]
    assert labels == ["variant:wall", "variant:sponge"]


def test_neither_guid_nor_binary_depends_on_references(tmp_path: Path) -> None:
    plain, carrying = gain(), gain()
    carrying.reference_runs, carrying.parameter_sets = [run()], [ParameterSet("one", {"n": 1})]
    assert definition(plain) == definition(carrying)
    without, with_them = built(tmp_path / "a"), built(tmp_path / "b", run())
    same = [name for name in without if name.startswith(("binaries/", "sources/", "modelDescription"))]
    assert len(same) > 3
    assert [without[name] for name in same] == [with_them[name] for name in same]


def test_same_references_same_bytes(tmp_path: Path) -> None:
    model = gain()
    model.reference_runs, model.parameter_sets = [run()], [ParameterSet("one", {"n": 1})]
    assert build(model, tmp_path / "a").read_bytes() == build(model, tmp_path / "b").read_bytes()


def test_a_run_is_read_from_files_of_the_cross_check(tmp_path: Path) -> None:
    (tmp_path / "step_ref.opt").write_text("StartTime,0\nStopTime,0.2\nStepSize,0.1\nRelTol,1e-9\n\n")
    (tmp_path / "step_ref.csv").write_bytes(RESULTS)
    assert ReferenceRun.read(tmp_path, "step", "Alone") == ReferenceRun("step", EXPERIMENT, RESULTS, b"", "Alone")
    (tmp_path / "step_in.csv").write_bytes(INPUTS)
    assert ReferenceRun.read(tmp_path, "step").inputs == INPUTS
    (tmp_path / "step_ref.opt").write_text("StartTime,zero\n")
    with pytest.raises(DefinitionError, match=r"step_ref.opt: StartTime: 'zero' is not a finite number"):
        ReferenceRun.read(tmp_path, "step")


def test_a_run_is_made_from_arrays_with_all_digits(tmp_path: Path) -> None:
    time = np.array([0.0, 0.1, 0.2])
    y = np.array([0.0, 0.1 + 0.2, 1e-300])
    given = ReferenceRun.from_columns("step", EXPERIMENT, {"time": time, "y[1]": y}, {"time": time, "u": time})
    entries = built(tmp_path, given)
    assert entries[f"{FOLDER}/step_in.csv"] == b'"time","u"\n0.0,0.0\n0.1,0.1\n0.2,0.2\n'
    read = np.genfromtxt(entries[f"{FOLDER}/step_ref.csv"].decode().splitlines()[1:], delimiter=",")
    assert read[:, 1].tolist() == y.tolist()
    assert ReferenceRun.from_columns("step", EXPERIMENT, {"time": time, "y[1]": y}).inputs == b""


@pytest.mark.parametrize(
    ("results", "inputs", "message"),
    [
        (b"", INPUTS, "the results are not a table; the first column must be called time"),
        (b"t,y[1]\n0,0\n", INPUTS, "the results are not a table; the first column must be called time"),
        (b"time,y[1]\n\xff,0\n", INPUTS, "the results are not a text in UTF-8"),
        (b"time,z\n0,0\n0.2,0\n", INPUTS, "the results have a column z, which is not an output; there are y[1], y[2]."),
        (b"time,u\n0,0\n0.2,0\n", INPUTS, "the results have a column u, which is not an output"),
        (b"time,y[1],y[1]\n0,0,0\n0.2,0,0\n", INPUTS, "the results have two columns y[1]; remove one."),
        (b"time,y[1]\n0,0\n0.2\n", INPUTS, "the results have 2 columns, but row 2 has 1 numbers."),
        (b"time,y[1]\n0,0\n0.2,nan\n", INPUTS, "the results: row 2, y[1]: 'nan' is not a finite number."),
        (b"time,y[1]\n0,0\n0.2,0\n0.2,0\n", INPUTS, "the results: row 3 is at 0.2 s, not later than the row before"),
        (b"time,y[1]\n0.1,0\n0.2,0\n", INPUTS, "the first row of the results is at 0.1 s, but start_time is 0.0 s."),
        (b"time,y[1]\n0,0\n0.1,0\n", INPUTS, "the last row of the results is at 0.1 s, but stop_time is 0.2 s."),
        (RESULTS, b"time,n\n0,1\n", "the inputs have a column n, which is not an input or a tunable parameter"),
        (RESULTS, b"time,u\n0.1,1\n", "the inputs begin at 0.1 s, after start_time 0.0 s."),
    ],
)
def test_a_run_that_cannot_be_repeated_is_refused(results: bytes, inputs: bytes, message: str, tmp_path: Path) -> None:
    with pytest.raises(DefinitionError) as refused:
        built(tmp_path, run(results, inputs))
    assert str(refused.value).startswith(f"Gain: reference run step: {message}")


def test_tunable_parameters_may_be_among_the_inputs(tmp_path: Path) -> None:
    inputs = b"time,u,k[2]\n0,1,3\n0.1,1,4\n"
    assert built(tmp_path, run(inputs=inputs))[f"{FOLDER}/step_in.csv"] == inputs


def test_an_incomplete_experiment_is_refused() -> None:
    with pytest.raises(DefinitionError, match="Reference run step: the experiment states no tolerance"):
        run(experiment=Experiment(start_time=0.0, stop_time=0.2, step_size=0.1))


@pytest.mark.parametrize("name", ["", "../step", "a b", ".hidden", "é"])
def test_names_of_files_are_plain(name: str) -> None:
    with pytest.raises(DefinitionError, match=r"use letters, digits and _\.- only"):
        ParameterSet(name, {})
    with pytest.raises(DefinitionError, match=r"use letters, digits and _\.- only"):
        ReferenceRun(name, EXPERIMENT, RESULTS)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"K": 1.0}, "the model has no parameter K; there are sample_time, k[1], k[2], n, on."),
        ({"u": 1.0}, "the model has no parameter u; "),
        ({"k": np.ones(3)}, "the model has no parameter k[3]; did you mean "),
        ({"k[1]": -1.0}, "k[1] -1.0 must be at least 1e-12 N/m."),
        ({"k[1]": float("inf")}, "k[1] inf is not of type Real; a finite number is needed."),
        ({"n": 1.5}, "n 1.5 is not of type Integer; "),
        ({"on": 2}, "on 2.0 is not of type Boolean; True or False is needed."),
    ],
)
def test_impossible_values_are_refused(values: Mapping[str, Any], message: str, tmp_path: Path) -> None:
    with pytest.raises(DefinitionError) as refused:
        built(tmp_path, sets=(ParameterSet("soft", values),))
    assert str(refused.value).startswith(f"Gain: parameter set soft: {message}")


def test_two_references_of_one_name_are_refused(tmp_path: Path) -> None:
    """Also where only a file system that ignores case would take them for one."""
    with pytest.raises(DefinitionError, match="Gain has two reference runs or parameter sets STEP; give one another"):
        built(tmp_path, run(), sets=(ParameterSet("STEP", {"n": 1}),))
