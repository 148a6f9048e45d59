"""Evidence for our Jacobi master: all outputs of fig2 are the same bits as in two independent engines.

Two seconds, contact included, 20,000 steps: ecos agrees from row 0 on, libcosim from row 1 on (it
shows no row 0). ecos has one step size, and sums its times, on whose last bits no value depends;
libcosim's times are t_k = (k ns) / 1e9 and its steps their differences (``engines.md``). Each is
compared with our run on its own clock, so no tolerance is needed.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from orchestration import Result, System, simulate
from orchestration.paper.scenarios import SCENARIOS
from tests.interop.peers import run_ecospy, run_libcosim, unavailable

STEP, STEP_NS = 1e-4, 100_000
STEPS = 20_000


class Case(NamedTuple):
    """The system, its package, and our runs on the clocks of ecos and libcosim."""

    system: System
    package: Path
    one_step: Result
    nanoseconds: Result


@pytest.fixture(scope="module")
def case(fmu_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Case:
    """Our runs of fig2."""
    scenario = SCENARIOS["fig2"]
    system = scenario.system({identifier: fmu_folder / f"{identifier}.fmu" for identifier in scenario.models.values()})
    times = np.array([(k * STEP_NS) / 1e9 for k in range(STEPS + 1)])
    return Case(
        system,
        system.write(tmp_path_factory.mktemp("fig2") / "fig2.ssp"),
        simulate(system, STEPS * STEP, STEP, "jacobi"),
        simulate(system, algorithm="jacobi", times=times),
    )


def assert_bitwise(values: np.ndarray, rows: np.ndarray, names: tuple[str, ...]) -> None:
    """Every bit of every column; the first difference is named. A zero's sign counts as well."""
    assert values.shape == rows.shape
    differs = values.view(np.int64) != rows.view(np.int64)
    if differs.any():
        k, j = np.argwhere(differs)[0]
        columns = [name for name, any_ in zip(names, differs.any(axis=0), strict=True) if any_]
        pytest.fail(f"{columns} differ, first at row {k}: {names[j]} {values[k, j]!r}, ours {rows[k, j]!r}")


def test_the_run_is_worth_comparing(case: Case) -> None:
    result = case.one_step
    assert np.abs(result["plant.F_ext[1]"]).max() > 100  # N, in contact
    assert result.rows.shape == (STEPS + 1, len(result.names))
    kinds = {v.type for c in case.system.components for v in c.description.of_causality("output")}
    assert {"Real", "Boolean"} <= kinds


@pytest.mark.skipif(bool(unavailable("ecospy")), reason=str(unavailable("ecospy")))
def test_all_rows_equal_those_of_ecos_bitwise(case: Case) -> None:
    values = run_ecospy(case.package, STEP, STEPS, case.one_step.names)
    assert_bitwise(values, case.one_step.rows, case.one_step.names)


@pytest.mark.skipif(bool(unavailable("libcosimpy")), reason=str(unavailable("libcosimpy")))
def test_rows_from_1_on_equal_those_of_libcosim_bitwise(case: Case) -> None:
    values = run_libcosim(case.package, STEP_NS, STEPS, case.nanoseconds.names)
    assert_bitwise(values, case.nanoseconds.rows[1:], case.nanoseconds.names)


def test_gauss_seidel_differs(case: Case) -> None:
    """Else the comparison would not tell the algorithms apart."""
    other = simulate(case.system, 0.01).rows
    assert (other != case.one_step.rows[: len(other)]).any()
