"""Every figure and a run of an arm in space in node: all outputs in all rows have the bits of the master's run."""

from pathlib import Path

import pytest

from orchestration import Options, scenario, simulate
from tests.interop.wasm.node import assert_bitwise, kept, module_of, needs_node, node

pytestmark = needs_node
# The earlier calibration of Figs. 5 to 7: the same programs with other start values and half the steps.
FIGURES = ("fig2", "fig3", "fig4", "fig5-first", "fig6-first", "fig7-first")
RUNS = (
    *((figure, algorithm) for figure in FIGURES for algorithm in ("gauss-seidel", "jacobi")),
    ("puma", "gauss-seidel"),
)
WHOLE = """
const run = system.create();
run.initialize();
keep("rows", run.run(STEPS, { columns: NAMES }));
"""


def run_in_node(folder: Path, steps: int, names: tuple[str, ...]) -> None:
    node(folder, WHOLE.replace("STEPS", str(steps)).replace("NAMES", str(list(names))))


@pytest.mark.parametrize(("figure", "algorithm"), RUNS)
def test_all_rows_are_those_of_the_master(figure: str, algorithm: str, tmp_path: Path) -> None:
    system = scenario(figure)
    result = simulate(system, algorithm=algorithm)
    assert {f"{c.name}.{v.name}" for c in system.components for v in c.description.of_causality("output")} == {
        *result.names
    }
    run_in_node(module_of(system, tmp_path, algorithm), len(result.time) - 1, result.names)
    assert_bitwise(kept(tmp_path / "rows", 1 + len(result.names)), result)


def test_the_two_orders_differ(tmp_path: Path) -> None:
    """Else the comparison would not tell them apart."""
    system = scenario("fig5")
    result = simulate(system, 0.01)
    run_in_node(module_of(system, tmp_path, "jacobi"), len(result.time) - 1, result.names)
    assert (kept(tmp_path / "rows", 1 + len(result.names))[:, 1:] != result.rows).any()


def test_each_seventh_row_is_that_of_the_master(tmp_path: Path) -> None:
    """100 steps leave two behind the last row, which are made as well."""
    system = scenario("fig5")
    result = simulate(system, 0.005, options=Options(every=7))
    script = """
    const run = system.create();
    run.initialize();
    keep("rows", run.run(STEPS, { columns: outputs, every: 7 }));
    console.log(run.time);
    """
    steps = round(0.005 / system.run_step())
    time = node(module_of(system, tmp_path), script.replace("STEPS", str(steps)))
    assert_bitwise(kept(tmp_path / "rows", 1 + len(result.names)), result)
    assert steps % 7 != 0
    assert time == 0.005
