"""Tests of systems of thousands of components and connections; their outputs can be predicted exactly."""

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import System, simulate
from orchestration.errors import SystemDescriptionError
from orchestration.master import memory
from orchestration.master.feedthrough import chain_of_feedthrough
from orchestration.master.simulate import UnconnectedInputWarning, prepare
from tests.benchmarks.wide import STEP, Size, connections, wide_fmu, wide_system

WIDTH = 3


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[bool, Path]:
    """The FMU of three inputs and outputs, by whether outputs depend on inputs at the same instant."""
    folder = tmp_path_factory.mktemp("wide")
    return {direct: wide_fmu(folder, WIDTH, direct=direct) for direct in (False, True)}


def predicted(n: int, width: int, steps: int, *, factor: float = 1.0) -> np.ndarray:
    """Last outputs of a ring in the sequential order, shape (n, width)."""
    y, offset = np.zeros((n, width)), np.arange(width) / width
    for _ in range(steps):
        for i in range(n):
            y[i] = 0.5 * (factor * y[i - 1]) + offset
    return y


def test_three_thousand_components_of_one_fmu_run(fmus: dict[bool, Path]) -> None:
    n = 3000
    result = simulate(wide_system(fmus[False], "ring", Size(n, WIDTH)), stop_time=2 * STEP)
    assert result.rows[-1].tobytes() == predicted(n, WIDTH, 2).ravel().tobytes()


def test_a_package_of_many_components_is_the_same_system(fmus: dict[bool, Path], tmp_path: Path) -> None:
    system = wide_system(fmus[False], "scattered", Size(300, WIDTH))
    again = System.read(system.write(tmp_path / "many.ssp"))
    assert again.connections == system.connections
    assert list(again) == list(system)


@pytest.mark.parametrize("backwards", [False, True])
def test_a_long_chain_settles_before_the_first_step(fmus: dict[bool, Path], *, backwards: bool) -> None:
    n = 100
    system = wide_system(fmus[True], "chain", Size(n, WIDTH))
    order = list(system)[:: -1 if backwards else 1]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnconnectedInputWarning)
        first = simulate(system, stop_time=STEP, order=order).rows[0].reshape(n, WIDTH)[:: -1 if backwards else 1]
    y, offset = np.zeros(WIDTH), np.arange(WIDTH) / WIDTH
    for row in first:
        y = 0.5 * y + offset
        assert row.tobytes() == y.tobytes()


def test_a_chain_is_passed_through_in_its_order(fmus: dict[bool, Path]) -> None:
    system = wide_system(fmus[True], "chain", Size(5, WIDTH)).ordered([f"c{i}" for i in (3, 1, 4, 0, 2)])
    assert chain_of_feedthrough(system, shortest=5) == [3, 1, 4, 0, 2]
    assert chain_of_feedthrough(system, shortest=6) == []
    assert chain_of_feedthrough(wide_system(fmus[True], "ring", Size(5, WIDTH)), shortest=5) == []
    assert chain_of_feedthrough(wide_system(fmus[False], "chain", Size(5, WIDTH)), shortest=2) == []


def test_an_algebraic_loop_among_components_that_settle(fmus: dict[bool, Path]) -> None:
    ring, chain = (connections(wiring, Size(40, WIDTH)) for wiring in ("ring", "chain"))
    first = {c for c in ring if c.target == "c0"}
    loop = [replace(c, source="c9") for c in first]  # c0 to c9 are a loop, c10 to c39 follow it
    system = replace(wide_system(fmus[True], "chain", Size(40, WIDTH)), connections=(*chain, *loop))
    row = simulate(system, stop_time=STEP).rows[0].reshape(40, WIDTH)
    # y = y / 2 + offset at a fixed point; the solver leaves residuals of 1e-12 (1 + |y|), which a loop that halves
    # them at every component at most doubles.
    assert row == pytest.approx(np.tile(2 * np.arange(WIDTH) / WIDTH, (40, 1)), abs=2e-12 * 3)


def test_scaled_inputs_get_their_own_factor_whatever_their_order(tmp_path: Path) -> None:
    width = 40
    system = wide_system(wide_fmu(tmp_path, width), "ring", Size(2, width))
    scaled = [replace(c, factor=float(k % 7 + 1)) for k, c in enumerate(system.connections) if k % 3]
    system = replace(system, connections=tuple(scaled[::-1]))
    factor = {(c.target, c.input): c.factor for c in scaled}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnconnectedInputWarning)
        last = simulate(system, stop_time=2 * STEP).rows[-1].reshape(2, width)
    y = np.zeros((2, width))
    for _ in range(2):
        for i in range(2):
            u = [y[i - 1, j] * factor.get((f"c{i}", f"u[{j + 1}]"), 0.0) for j in range(width)]
            y[i] = 0.5 * np.array(u) + np.arange(width) / width
    assert last.tobytes() == y.tobytes()


def test_a_jacobian_that_does_not_fit_is_refused(fmus: dict[bool, Path], monkeypatch: pytest.MonkeyPatch) -> None:
    system = wide_system(fmus[False], "star", Size(20, WIDTH)).ordered([f"c{19 - i}" for i in range(20)])
    monkeypatch.setattr(memory, "machine_memory", lambda: 20e3)
    words = "the Jacobian of 57 corrected inputs needs 26.4 kB of memory, the machine has 20 kB"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnconnectedInputWarning)
        with pytest.raises(SystemDescriptionError, match=words), prepare(system, 4 * STEP, algorithm="newton"):
            pass
        simulate(system, stop_time=4 * STEP, algorithm="iterative", record=())
