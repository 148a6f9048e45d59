"""Tests of fmus/reference: the committed trajectories are those of the FMUs, complete, small and informative."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu import Model
from fmus.catalog import MODELS
from orchestration.errors import OrchestrationError
from orchestration.paper.built_fmus import built_model
from orchestration.paper.parameter_sets import write_parameter_sets
from orchestration.paper.reference_data import FOLDER, write_reference
from orchestration.paper.scenarios import SCENARIOS, VARIANTS
from orchestration.paper.stimuli import STIMULI
from tests.conformance.binary import Binary
from tests.conformance.replay import assert_reproduces, options, table
from tests.conformance.units import REALS
from tests.driver import Driver

LARGEST = 30_000  # bytes per FMU
IN_RUNS = {model for run in (*SCENARIOS.values(), *VARIANTS.values()) for model in run.models.values()}
"""FMUs that take part in the paper's runs."""


@pytest.fixture(params=list(MODELS))
def identifier(request: pytest.FixtureRequest) -> str:
    """Name of each FMU in turn; the container has no reference of its own."""
    return request.param


def test_every_unit_has_a_reference() -> None:
    assert set(STIMULI) == set(MODELS)
    assert {path.name for path in FOLDER.iterdir() if path.is_dir()} == set(MODELS)


def test_unit_reproduces_its_reference(identifier: str, fmu: Path, open_fmu: Callable[..., Driver]) -> None:
    assert_reproduces(identifier.removeprefix(REALS), fmu, open_fmu)


@pytest.mark.parametrize("identifier", MODELS)
def test_files_are_complete_and_small(identifier: str, binary: Binary) -> None:
    folder = FOLDER / identifier
    inputs, outputs = binary.names("input"), binary.names("output")
    expected = [f"{identifier}_in.csv"] * bool(inputs) + [f"{identifier}_ref.csv", f"{identifier}_ref.opt"]
    expected += [f"{identifier}_sets.csv"] * (identifier in IN_RUNS)
    assert sorted(path.name for path in folder.iterdir()) == expected
    assert sum(path.stat().st_size for path in folder.iterdir()) <= LARGEST
    driven = (table(identifier, "in").dtype.names or ())[1:]
    assert set(inputs) <= set(driven)
    assert set(driven) <= {*inputs, *binary.names("parameter", variability="tunable")}
    assert list(table(identifier, "ref").dtype.names or ()) == ["time", *outputs]


@pytest.mark.parametrize("identifier", MODELS)
def test_times_are_those_of_the_options(identifier: str) -> None:
    experiment = options(identifier)
    assert experiment["StartTime"] == 0
    for suffix in ("in", "ref"):
        time = table(identifier, suffix)["time"]
        # ten digits of a time of at most 2 s: 5e-10
        np.testing.assert_allclose(time, experiment["StepSize"] * np.arange(time.size), rtol=0, atol=1e-9)
        assert time[-1] == experiment["StopTime"]


@pytest.mark.parametrize("identifier", MODELS)
def test_generator_reproduces_the_files(identifier: str, tmp_path: Path) -> None:
    """Through fmpy's own loop, to the last byte."""
    write_reference(identifier, tmp_path)
    write_parameter_sets(identifier, tmp_path)
    written, kept = ({p.name: p.read_bytes() for p in (at / identifier).iterdir()} for at in (tmp_path, FOLDER))
    assert written == kept


def test_generator_needs_no_references_that_fit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A model whose outputs have new names cannot carry its old results, but they can be computed anew."""
    sensor = MODELS["ForceSensor"]

    def renamed() -> Model:
        model = sensor()
        model.variables = [replace(v, name=v.name.replace("F_hat", "force")) for v in model.variables]
        model.terminals = {}
        return model

    monkeypatch.setitem(MODELS, "ForceSensor", renamed)
    with pytest.raises(OrchestrationError, match=r"have a column F_hat\[1\], which is not an output"):
        built_model(renamed())
    write_reference("ForceSensor", tmp_path)
    assert list(table("ForceSensor", "ref", tmp_path).dtype.names or ()) == ["time", "force[1]", "force[2]"]


@pytest.mark.parametrize("identifier", ["Plant", "Plant3R"])
def test_the_plants_touch_the_wall_and_leave_it(identifier: str) -> None:
    touching = table(identifier, "ref")["penetration"] > 0
    assert touching.any()
    assert not touching[0]
    assert not touching[-1]


@pytest.mark.parametrize("identifier", ["Actuator", "Actuator3R"])
def test_the_actuators_saturate_both_ways(identifier: str) -> None:
    reference, driven = table(identifier, "ref"), table(identifier, "in")
    for name in (n for n in reference.dtype.names or () if n.startswith("tau")):
        limit = driven[name.replace("tau", "tau_max")][0]
        assert reference[name].max() == limit
        assert reference[name].min() == -limit
        assert 0 < reference[name.replace("tau", "saturated")].sum() < reference.size


def test_the_sensor_is_noisy_in_contact_only() -> None:
    """Row k + 1 shows the last tick of the step from row k, whose inputs it had."""
    driven, reference = table("ForceSensor", "in")[:-1], table("ForceSensor", "ref")[1:]
    error = np.hypot(*(reference[f"F_hat[{i}]"] - driven[f"F_ext[{i}]"] for i in (1, 2)))
    noisy = (driven["noise_std"] > 0) & (driven["F_ext[1]"] != 0)
    assert 10 < noisy.sum() < noisy.size
    assert np.all(error[noisy] > 0)
    assert np.all(error <= driven["noise_bound"] + 1e-6)  # ten digits of 800 N: 5e-8 N
    assert np.all(error[~noisy] == 0)


def test_the_trajectory_follows_its_straight_segment() -> None:
    on_segment = table("VirtualTrajectory", "ref")["x_v[1]"] == -1.46
    assert 3 < on_segment.sum() < on_segment.size


@pytest.mark.parametrize("identifier", [name for name in MODELS if "Adaptive" in name])
def test_the_adaptive_controllers_adapt_and_reject_noise(identifier: str) -> None:
    reference = table(identifier, "ref")
    assert np.ptp(reference["p_hat[2]"]) > 1e-3
    if "gamma" in (reference.dtype.names or ()):
        assert 0 < np.count_nonzero(reference["gamma"]) < reference.size
