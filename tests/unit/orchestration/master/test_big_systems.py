"""Tests of systems of thousands of components and connections; their outputs can be predicted exactly."""

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import System, simulate
from orchestration.errors import SystemDescriptionError
from orchestration.master import initialization, memory
from orchestration.master.feedthrough import chain_of_feedthrough
from orchestration.master.simulate import UnconnectedInputWarning, prepare
from tests.benchmarks.wide import STEP, Size, connections, wide_fmu, wide_system

WIDTH = 3
LOOP = [f"c{i}" for i in range(30, 40)]


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


def test_an_algebraic_loop_is_solved_without_what_settles(
    fmus: dict[bool, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """c0 to c29 are a chain; c30 to c39 a ring that multiplies a value by -1 each time round, so it never settles."""
    chain = [c for c in connections("chain", Size(40, WIDTH)) if c.target not in LOOP]
    ring = [
        replace(c, source=f"c{30 + int(c.source[1:])}", target=f"c{30 + int(c.target[1:])}", factor=2.0)
        for c in connections("ring", Size(10, WIDTH))
    ]
    ring = [replace(c, factor=-2.0) if c.target == "c30" else c for c in ring]
    system = replace(wide_system(fmus[True], "chain", Size(40, WIDTH)), connections=(*chain, *ring))
    sizes = []
    solve = np.linalg.lstsq
    monkeypatch.setattr(np.linalg, "lstsq", lambda a, b, rcond: (sizes.append(a.shape), solve(a, b, rcond))[1])
    rows = []
    for most in (500, 50):
        monkeypatch.setattr(initialization, "MOST_WHOLE", most)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UnconnectedInputWarning)
            rows.append(simulate(system, stop_time=STEP).rows[0].reshape(40, WIDTH))
    assert {sizes[0][0], sizes[-1][0]} == {WIDTH * 39, WIDTH * 10}
    # y[30] = -y[39] + o and y[i] = y[i - 1] + o for o = i / n: y[39] = y[30] + 9 o, so y[30] = -4 o.
    offset = np.arange(WIDTH) / WIDTH
    for row in rows:
        expected = offset * (np.arange(10)[:, None] - 4)
        # The solver leaves residuals of 1e-12 (1 + |y|) at ten components of one loop, which add up.
        np.testing.assert_allclose(row[30:], expected, rtol=0, atol=1e-12 * 10 * 5)


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
