"""The FMUs step on every platform that runs here, and show the same numbers up to rounding.

A C driver steps them: on this machine bit for bit what Python gets. Elsewhere the C library's functions
differ by a unit in the last place: with MinGW, which brings sin, cos, exp and log with it, in 1 to 4 % of
the values of VirtualTrajectory; glibc on ARM and on x86-64 gave the same bits throughout. In Fig. 2 contact
multiplies a position's rounding by K_f = 1e5 N/m. Measured, win64 against linux64 and aarch64-linux against
linux64, largest over the 2 s of Fig. 2, contact included, and over 500 random steps of each FMU alone:

    Fig. 2    x 2e-15 m of 1.5, q 9e-16 rad of 5.6, dx 9e-14 m/s of 4.7, F_ext 9e-11 N of 557,
              tau 7e-11 N.m of 327, e 2e-15 m of 1.3e-4: 5 units of rounding; ARM: 0
    alone     e 7e-16 m of 0.2, tau_cmd of the controllers 6e-10 N.m of 3e4: 1.3 units; ARM: 0

A unit is what a 2^-52 in every function changes, see `condition`; ROUNDINGS of them are allowed.

That holds for loops that forget a rounding error. The loop of Fig. 5 does not: its robust force switches within
gamma_eps and chatters on the sensor's noise, and after contact the two platforms' torques are as far apart as
they are large, e by 5e-6 m of 2.4e-3 m. Before contact they agree as above (tau within 4e-12 N.m).
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fmus.catalog import MODELS
from orchestration import Component, System, simulate
from orchestration.fmi.description import read_description
from orchestration.paper.scenarios import SCENARIOS
from tests.conformance.binary import OK, Binary, Instance
from tests.conformance.container import of_models
from tests.conformance.platforms.condition import rounding_effects
from tests.conformance.platforms.machines import Machine
from tests.conformance.platforms.plan import Plan
from tests.conformance.scenes import STEPS, H, random_inputs, scene

Outputs = dict[str, np.ndarray]
SEED = 20
ROWS = 500  # of each FMU alone
# Units of rounding allowed: x, and with it e = x - x_t, is a sum of products of two sines and two cosines each in
# plant and controller, of RK4's four stages; two results that are within one unit each differ by two.
ROUNDINGS = 16


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


@pytest.fixture(scope="module")
def fig2_rounding(
    fig2: Plan, fig2_outputs: Outputs, native: Machine, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, float]:
    """What one unit of rounding changes in Fig. 2."""
    return rounding_effects(fig2, fig2_outputs, native, tmp_path_factory.mktemp("fig2"))


@pytest.fixture(scope="module")
def alone_rounding(
    alone: Plan, alone_outputs: Outputs, native: Machine, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, float]:
    """What one unit of rounding changes in each unit alone."""
    return rounding_effects(alone, alone_outputs, native, tmp_path_factory.mktemp("alone"))


def test_10_driver_is_the_master_bit_for_bit(fig2: Plan, fig2_outputs: Outputs) -> None:
    result = simulate(fig2.system)
    assert np.abs(fig2_outputs["plant.F_ext[1]"]).max() > 100, "no contact"
    for name, values in fig2_outputs.items():
        assert values.tobytes() == np.ascontiguousarray(result[name]).tobytes(), name


@of_models
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


def test_10_platforms_agree_on_fig2(
    fig2: Plan, fig2_outputs: Outputs, fig2_rounding: dict[str, float], foreign: Machine, tmp_path: Path
) -> None:
    check(foreign.run(fig2, tmp_path), fig2_outputs, fig2_rounding)


def test_10_platforms_agree_on_each_unit(
    alone: Plan, alone_outputs: Outputs, alone_rounding: dict[str, float], foreign: Machine, tmp_path: Path
) -> None:
    check(foreign.run(alone, tmp_path), alone_outputs, alone_rounding)


def check(found: Outputs, expected: Outputs, rounding: dict[str, float]) -> None:
    """Hold each output against this machine's."""
    apart = {name: float(np.abs(found[name] - values).max()) for name, values in expected.items()}
    assert {name: d for name, d in apart.items() if not d <= ROUNDINGS * rounding[name]} == {}
