"""Evidence that a model may stay silent: an FMU without default experiment and owner runs in every tool."""

import warnings
from pathlib import Path

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.validation import validate_fmu

from adaptimp_fmu import SampledModel, build
from orchestration import Component, Result, System, UnconnectedInputWarning, simulate
from orchestration.check import check
from orchestration.fmi.description import read_description
from tests.interop.peers import run_ecospy, run_libcosim, unavailable

STEP, STEPS = 1e-2, 10


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """x[0] = u and x[k + 1] = 0.5 x[k] + u, with u = 1 by default; the output is x."""
    model = SampledModel("Silent", "States nothing but its equations", sample_time=STEP)
    u = model.input("u", 1.0, description="Input")
    x = model.state("x", u)
    model.update(x, 0.5 * x + u)
    model.output("y", x, description="Output", scalar=True)
    return build(model, tmp_path_factory.mktemp("silent"))


@pytest.fixture
def system(fmu: Path) -> System:
    """The FMU alone; ecos wants a parameter set to apply."""
    return System("alone", (Component("silent", read_description(fmu), {"sample_time": STEP}),))


def ours(system: System) -> Result:
    """What our master shows; the input is unconnected on purpose."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnconnectedInputWarning)
        return simulate(system, STEPS * STEP, STEP, "jacobi")


def test_our_master_runs_it(system: System) -> None:
    ticks = [sum(0.5**i for i in range(k + 1)) for k in range(STEPS)]
    np.testing.assert_array_equal(ours(system)["silent.y"], [ticks[0], *ticks])  # exact: sums of powers of two


def test_fmpy_validates_and_simulates_it(fmu: Path, system: System) -> None:
    assert validate_fmu(str(fmu)) == []
    result = simulate_fmu(str(fmu), stop_time=STEPS * STEP, step_size=STEP, output_interval=STEP)
    np.testing.assert_array_equal(result["y"], ours(system)["silent.y"])


@pytest.mark.skipif(bool(unavailable("ecospy")), reason=str(unavailable("ecospy")))
def test_ecos_runs_it(system: System, tmp_path: Path) -> None:
    values = run_ecospy(system.write(tmp_path / "alone.ssp"), STEP, STEPS, ["silent.y"])
    np.testing.assert_array_equal(values[:, 0], ours(system)["silent.y"])


@pytest.mark.skipif(bool(unavailable("libcosimpy")), reason=str(unavailable("libcosimpy")))
def test_libcosim_runs_it(system: System, tmp_path: Path) -> None:
    values = run_libcosim(system.write(tmp_path / "alone.ssp"), round(STEP * 1e9), STEPS, ["silent.y"])
    np.testing.assert_array_equal(values[:, 0], ours(system)["silent.y"][1:])


def test_check_finds_nothing(fmu: Path) -> None:
    assert not check(fmu).findings
