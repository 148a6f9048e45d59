"""Evidence that every FMU is usable elsewhere: it loads and steps in fmpy, ecos and libcosim.

With its default parameters and inputs every FMU runs alone; each tool must show finite outputs, and
the two engines exactly what our own master shows.
"""

import warnings
from pathlib import Path

import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi2 import FMU2Slave

from fmus.catalog import MODELS, VARIANTS
from orchestration import Component, Result, System, UnconnectedInputWarning, simulate
from orchestration.fmi.description import read_description
from tests.interop.peers import run_ecospy, run_libcosim, unavailable
from tests.variant_files import file_of

STEP, STEP_NS = 1e-4, 100_000
STEPS = 20

SPATIAL = [name for name in VARIANTS if name.endswith("Puma560")]


@pytest.fixture(params=[*MODELS, *SPATIAL])
def fmu(request: pytest.FixtureRequest, fmu_folder: Path) -> Path:
    """The file of each FMU in turn; those of the arm in space are variants."""
    return file_of(request.param) if request.param in SPATIAL else fmu_folder / f"{request.param}.fmu"


def alone(fmu: Path) -> System:
    """A system of one FMU with one start value: ecos wants a parameter set to apply."""
    description = read_description(fmu)
    name = "sample_time" if "sample_time" in description.variables else "dt_max"
    return System("alone", (Component("unit", description, {name: STEP}),))


def ours(system: System, times: np.ndarray | None = None) -> Result:
    """What our Jacobi master shows; every input is unconnected on purpose."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnconnectedInputWarning)
        return simulate(system, STEPS * STEP, STEP, "jacobi", times=times)


def test_fmpy_simulates(fmu: Path) -> None:
    result = simulate_fmu(str(fmu), stop_time=STEPS * STEP, output_interval=STEP, step_size=STEP)
    columns = [name for name in result.dtype.names or () if name != "time"]
    outputs = [v.name for v in read_model_description(str(fmu)).modelVariables if v.causality == "output"]
    assert columns == outputs
    assert len(result) == STEPS + 1
    assert all(np.isfinite(result[name].astype(float)).all() for name in columns)


def test_fmpy_steps_one_instance(fmu: Path, tmp_path: Path) -> None:
    folder = extract(str(fmu), unzipdir=str(tmp_path))
    description = read_model_description(folder)
    assert description.coSimulation is not None
    slave = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="alone",
    )
    slave.instantiate()
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    reals = [v for v in description.modelVariables if v.causality == "output" and v.type == "Real"]
    references = [v.valueReference for v in reals]
    rows = [slave.getReal(references)]
    for k in range(STEPS):
        slave.doStep(currentCommunicationPoint=k * STEP, communicationStepSize=STEP)
        rows.append(slave.getReal(references))
    slave.terminate()
    slave.freeInstance()
    names = [f"unit.{v.name}" for v in reals]
    result = ours(alone(fmu))
    expected = np.column_stack([result[name] for name in names])  # the same calls, so the same bits
    np.testing.assert_array_equal(np.array(rows), expected)


@pytest.mark.skipif(bool(unavailable("ecospy")), reason=str(unavailable("ecospy")))
def test_ecos_steps(fmu: Path, tmp_path: Path) -> None:
    system = alone(fmu)
    result = ours(system)
    values = run_ecospy(system.write(tmp_path / "alone.ssp"), STEP, STEPS, result.names)
    assert values.shape == result.rows.shape
    np.testing.assert_array_equal(values, result.rows)


@pytest.mark.skipif(bool(unavailable("libcosimpy")), reason=str(unavailable("libcosimpy")))
def test_libcosim_steps(fmu: Path, tmp_path: Path) -> None:
    system = alone(fmu)
    result = ours(system, np.array([(k * STEP_NS) / 1e9 for k in range(STEPS + 1)]))
    values = run_libcosim(system.write(tmp_path / "alone.ssp"), STEP_NS, STEPS, result.names)
    np.testing.assert_array_equal(values, result.rows[1:])
