"""The program of a step: which FMI calls a step makes, in which order, and that copies change no value."""

from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu import SampledModel, build
from orchestration import System, simulate
from orchestration.master.flatten import assemble
from orchestration.master.initialization import initialize, opened
from orchestration.master.kernel import step_program
from orchestration.master.kernel.codes import Column, Kind
from orchestration.master.kernel.step_program import operations_of_step
from tests.unit.orchestration.small_models import H, mixed, system

WIDTH = 4


@pytest.fixture(scope="module")
def wide(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Build an FMU with `WIDTH` inputs and outputs: y = t - 2 u."""
    model = SampledModel("Wide", "Doubles its inputs", sample_time=H)
    u = model.input("u", [0.0] * WIDTH, description="Signals")
    model.output("y", model.time - 2 * u, description="t - 2 u")
    return {"Wide": build(model, tmp_path_factory.mktemp("wide"))}


def crossed(wide: dict[str, Path], sources: str) -> System:
    """Connect component a to its own outputs, in the order of the digits, and component b to a in natural order."""
    own = [f"a.y[{source}] -> a.u[{target}]" for target, source in enumerate(sources, 1)]
    straight = [f"a.y[{i}] -> b.u[{i}]" for i in range(1, WIDTH + 1)]
    return system(wide, {"a": "Wide", "b": "Wide"}, "\n".join([*own, *straight]))


def listed(made: System, sequential: bool) -> np.ndarray:
    """Return the operations of a step as records."""
    with opened(made) as instances:
        assembly = assemble(made, instances, None)
        initialize(made, instances, assembly, 0.0)
        return operations_of_step(assembly.plan, sequential=sequential)


@pytest.mark.parametrize(
    ("sources", "calls", "copies"),
    [("1234", 1, 0), ("3412", 1, 2), ("4321", 1, 4), ("2341", 1, 2), ("1111", 1, 4)],
)
def test_neighbours_are_set_in_one_call_without_a_copy(
    wide: dict[str, Path], sources: str, calls: int, copies: int
) -> None:
    rows = listed(crossed(wide, sources), sequential=True)
    of_a = rows[(rows["subject"] == 0) & (rows["call"] == Column.SET_REAL)]
    copied = of_a["kind"] == Kind.COPY_REALS
    assert (copied.sum(), (~copied).sum()) == (copies, calls)
    assert of_a["count"][~copied].sum() == WIDTH
    of_b = rows[(rows["subject"] == 1) & (rows["call"] == Column.SET_REAL)]
    assert len(of_b) == 1
    assert of_b[0]["kind"] not in (Kind.COPY_REALS, Kind.COPY_DISCRETES)


def test_many_inputs_from_few_sources_are_set_in_several_calls(wide: dict[str, Path], monkeypatch) -> None:
    monkeypatch.setattr(step_program, "COPIES_PER_CALL", 2)
    rows = listed(crossed(wide, "3412"), sequential=True)
    of_a = rows[(rows["subject"] == 0) & (rows["call"] == Column.SET_REAL)]
    assert of_a["count"].tolist() == [2, 2]
    assert (of_a["kind"] != Kind.COPY_REALS).all()


@pytest.mark.parametrize("sequential", [True, False])
def test_order_is_the_algorithm(small: dict[str, Path], sequential: bool) -> None:
    rows = listed(mixed(small), sequential)
    phase = {Column.DO_STEP: 1} | dict.fromkeys((Column.GET_REAL, Column.GET_INTEGER, Column.GET_BOOLEAN), 2)
    phases = [phase.get(call, 0) for call in rows["call"].tolist()]
    keys = list(zip(rows["subject"].tolist(), phases, strict=True))
    assert keys == sorted(keys, key=lambda key: key if sequential else key[::-1])
    assert set(rows["subject"].tolist()) == {0, 1, 2, 3}


@pytest.mark.parametrize("sequential", [True, False])
def test_series_add_one_operation_at_the_start_of_a_step(small: dict[str, Path], sequential: bool) -> None:
    """And without series the step consists of the same operations, in the same order, as if there were none."""
    made = mixed(small)
    with opened(made) as instances:
        assembly = assemble(made, instances, None)
        initialize(made, instances, assembly, 0.0)
        without = operations_of_step(assembly.plan, sequential=sequential)
        with_series = operations_of_step(assembly.plan, sequential=sequential, series=(11, 12))
    first = with_series[0]
    assert (first.kind, first.function, first.instance, first.subject) == (Kind.STEP, 11, 12, -1)
    assert with_series[1:].tobytes() == without.tobytes()


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
@pytest.mark.parametrize("sources", ["1234", "3412", "4321", "1111"])
def test_copies_and_calls_hand_over_the_same(wide: dict[str, Path], monkeypatch, algorithm: str, sources: str) -> None:
    made = crossed(wide, sources)
    rows = []
    # With 0, every run of neighbours takes a call; with 1000, every component with two runs takes copies.
    for copies_per_call in (0, 1000):
        monkeypatch.setattr(step_program, "COPIES_PER_CALL", copies_per_call)
        rows.append(simulate(made, algorithm=algorithm).rows)
    y = np.zeros(WIDTH)
    for k in range(len(rows[0]) - 1):
        y = k * H - 2 * y[[int(source) - 1 for source in sources]]
        np.testing.assert_array_equal(rows[0][k + 1, :WIDTH], y)
    np.testing.assert_array_equal(rows[0], rows[1])
