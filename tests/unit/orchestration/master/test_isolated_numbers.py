"""A run with isolated components gives the bits of the run without, for every algorithm and with saved states."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import Options, Result, prepare, simulate
from orchestration.analysis.stability.verdict import stability
from orchestration.fmi.isolation import Isolation
from orchestration.master.algorithm import Algorithm
from tests.unit.orchestration.fmi.test_input_scaling import ALGORITHMS as SCALED
from tests.unit.orchestration.fmi.test_input_scaling import pair
from tests.unit.orchestration.runs import ALGORITHMS, at_zero, falling, paper
from tests.unit.orchestration.small_models import H, chain, mixed


def same(a: Result, b: Result) -> bool:
    """Whether two results agree in every bit, and in everything but who was isolated."""
    others = {key: value for key, value in b.metadata.items() if key != "isolated"}
    return a == replace(b, metadata=others)


@pytest.mark.parametrize("algorithm", ALGORITHMS.values(), ids=list(ALGORITHMS))
def test_the_robot_with_noise(fmu_folder: Path, algorithm: Algorithm) -> None:
    system = paper(fmu_folder, "fig5")
    stop = 60 * (system.step or 0.0)
    plain = simulate(system, stop, algorithm=algorithm)
    isolated = simulate(system, stop, algorithm=algorithm, isolate=True)
    assert same(plain, isolated)
    assert isolated.metadata["isolated"] == '["trajectory", "sensor", "controller", "actuator", "plant"]'
    assert np.ptp(plain["plant.F_ext"]) > 0


@pytest.mark.parametrize("algorithm", SCALED.values(), ids=list(SCALED))
def test_converted_inputs_and_derivatives(strange: dict[str, Path], algorithm: Algorithm) -> None:
    system = pair(strange, "FineDecay")
    assert same(simulate(system, 2.0, H, algorithm), simulate(system, 2.0, H, algorithm, isolate=["b"]))


@pytest.mark.parametrize("name", ["relay1", "relay2", "source"])
def test_integers_and_booleans(small: dict[str, Path], name: str) -> None:
    system = chain(small, 2)
    assert same(simulate(system), simulate(system, isolate=name))


def test_located_crossings(small: dict[str, Path]) -> None:
    assert same(simulate(falling(small), options=at_zero()), simulate(falling(small), options=at_zero(), isolate=True))


def test_snapshots_pass_between_isolated_and_plain_runs(small: dict[str, Path]) -> None:
    whole = simulate(mixed(small))
    for first, then in (((None, True)), ((True, None)), ((True, True))):
        with prepare(mixed(small), isolate=first) as run:
            run.run(until=1.0)
            snapshot = run.save()
        with prepare(mixed(small), options=Options(isolate=then)) as run:
            run.restore(snapshot)
            run.run()
            np.testing.assert_array_equal(run.result().rows, whole.rows)


def test_the_verdict_on_stability(small: dict[str, Path]) -> None:
    assert stability(mixed(small), isolation=Isolation()) == stability(mixed(small))


def test_a_failure_of_an_fmu_is_said_as_without_isolation(small: dict[str, Path]) -> None:
    from orchestration import SimulationError
    from tests.unit.orchestration.small_models import LAST_TICK, system

    fragile = system(small, {"fragile": "Fragile"}, steps=2 * LAST_TICK)
    said = []
    for isolate in (None, True):
        with pytest.raises(SimulationError) as failed:
            simulate(fragile, isolate=isolate)
        said.append(str(failed.value))
    assert said[0] == said[1]
    assert "k must stay small" in said[0]
