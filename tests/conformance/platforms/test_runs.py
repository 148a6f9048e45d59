"""The FMUs step on every platform that runs here, and show the same bits.

A C driver steps them: on this machine bit for bit what Python gets, on other platforms bit for bit what this machine
gets. No function of a platform's C library takes part, so nothing is left in which two platforms could differ
(docs/same-bits.md). Each FMU alone gets random inputs and steps of several lengths; Fig. 2 couples five of them.
`same_bits` does the same with all figures.
"""

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fmus.catalog import MODELS
from orchestration import Component, System, simulate
from orchestration.fmi.description import read_description
from orchestration.paper.scenarios import SCENARIOS
from tests.conformance.binary import OK, Binary, Instance
from tests.conformance.platforms.machines import Machine
from tests.conformance.platforms.plan import Plan
from tests.conformance.scenes import STEPS, H, random_inputs, scene
from tests.property.mathematics.library import HASHED, ZIG, compile_functions, hashes

Outputs = dict[str, np.ndarray]
SEED = 20
ROWS = 500  # of each FMU alone


@pytest.fixture(scope="module")
def binaries(portable: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Binary]:
    """Each FMU's binary for this machine, from the FMU for all."""
    return {name: Binary(portable / f"{name}.fmu", tmp_path_factory.mktemp(name)) for name in MODELS}


@pytest.fixture(scope="module")
def fig2(portable: Path) -> Plan:
    """The five FMUs of Fig. 2 for 2 s: free motion, contact from 0.92 s to 1.08 s, free motion."""
    scenario = SCENARIOS["fig2"]
    system = scenario.system({identifier: portable / f"{identifier}.fmu" for identifier in scenario.models.values()})
    steps = round(system.run_stop_time() / system.run_step())
    return Plan(system, np.full(steps, system.step), passes=len(system.components))


@pytest.fixture(scope="module")
def alone(portable: Path, binaries: dict[str, Binary]) -> Plan:
    """Every FMU without the others: its scene, with random inputs and steps of several lengths."""
    rng = np.random.default_rng(SEED)
    units = [Component(n, read_description(portable / f"{n}.fmu"), scene(binary)) for n, binary in binaries.items()]
    rows = [
        {f"{n}.{k}": v for n, binary in binaries.items() for k, v in random_inputs(binary, rng).items()}
        for _ in range(ROWS)
    ]
    given = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return Plan(System("alone", tuple(units)), H * rng.choice(STEPS, ROWS), given)


@pytest.fixture(scope="module")
def run(native: Machine, tmp_path_factory: pytest.TempPathFactory) -> Callable[[Plan], Outputs]:
    """Runs a plan on this machine."""
    return lambda plan: native.run(plan, tmp_path_factory.mktemp("native"))


@pytest.fixture(scope="module")
def fig2_outputs(run: Callable[[Plan], Outputs], fig2: Plan) -> Outputs:
    """Fig. 2 on this machine."""
    return run(fig2)


@pytest.fixture(scope="module")
def alone_outputs(run: Callable[[Plan], Outputs], alone: Plan) -> Outputs:
    """Each FMU alone on this machine."""
    return run(alone)


def test_10_driver_is_the_master_bit_for_bit(fig2: Plan, fig2_outputs: Outputs) -> None:
    result = simulate(fig2.system)
    assert np.abs(fig2_outputs["plant.F_ext[1]"]).max() > 100, "no contact"
    for name, values in fig2_outputs.items():
        assert values.tobytes() == np.ascontiguousarray(result[name]).tobytes(), name


@pytest.mark.parametrize("identifier", MODELS)
def test_10_driver_is_ctypes_bit_for_bit(
    alone: Plan, alone_outputs: Outputs, binaries: dict[str, Binary], identifier: str
) -> None:
    inputs = {name: alone.given[f"{identifier}.{name}"] for name in binaries[identifier].names("input")}
    instance = Instance(binaries[identifier], start=scene(binaries[identifier]))
    with instance.initialize():
        rows = [instance.outputs()]
        for k, (t, h) in enumerate(zip(alone.times, alone.lengths, strict=True)):
            assert instance.set({name: values[k] for name, values in inputs.items()}) == OK
            assert instance.step(h, t) == OK, instance.last
            rows.append(instance.outputs())
    for name, values in zip(binaries[identifier].names("output"), np.transpose(rows), strict=True):
        assert alone_outputs[f"{identifier}.{name}"].tobytes() == values.tobytes(), name


def test_10_platforms_agree_on_fig2(fig2: Plan, fig2_outputs: Outputs, foreign: Machine, tmp_path: Path) -> None:
    check(foreign.run(fig2, tmp_path), fig2_outputs)


def test_10_platforms_agree_on_each_unit(alone: Plan, alone_outputs: Outputs, foreign: Machine, tmp_path: Path) -> None:
    check(foreign.run(alone, tmp_path), alone_outputs)


def test_10_platforms_agree_on_the_mathematics(foreign: Machine, tmp_path: Path) -> None:
    here, there = tmp_path / "here", tmp_path / ("there.exe" if foreign.platform.name == "win64" else "there")
    compile_functions(here, ZIG, "-O2", f"-DHASHES={HASHED}")
    compile_functions(there, (*ZIG, "-target", foreign.platform.target), "-O2", f"-DHASHES={HASHED}")
    assert hashes(there, foreign.launcher, os.environ | foreign.environment) == hashes(here)


def check(found: Outputs, expected: Outputs) -> None:
    """Hold each output against this machine's."""
    assert [name for name, values in expected.items() if found[name].tobytes() != values.tobytes()] == []
