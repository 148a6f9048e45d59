"""Runs of a native library beside those of the master, which numpy reduces."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from orchestration import Result, SimulationError, System, simulate
from orchestration.containers.native.program import NativeProgram
from orchestration.results.measures.expression import Column, Reduction, walk
from orchestration.results.measures.parser import parse_formula
from orchestration.results.measures.reduction import reduced


def reductions_of(system: System, *formulas: str) -> tuple[Reduction, ...]:
    """The reductions of formulas about a system."""
    found = [parse_formula(formula).expanded(system.elements).reductions for formula in formulas]
    return tuple(dict.fromkeys(reduction for of_one in found for reduction in of_one))


def names_in(reductions: Sequence[Reduction]) -> set[str]:
    """Columns that reductions need."""
    return {node.name for reduction in reductions for node in walk(reduction) if isinstance(node, Column)}


def of_master(program: NativeProgram, row: np.ndarray, step: float, stop_time: float, order: str) -> Result | str:
    """The run of the master that a program has to repeat, with all columns that the program needs; or why it fails."""
    system = replace(program.system.set(dict(zip(program.varied, row.tolist(), strict=True))), step=step)
    names = sorted(names_in(program.reductions) | set(program.record))
    try:
        return simulate(system, stop_time=stop_time, algorithm=order, record=names)
    except SimulationError as error:
        return str(error)


def require_same_bits(
    program: NativeProgram, values: np.ndarray, steps: np.ndarray, stop_time: float, order: str = "gauss-seidel"
) -> None:
    """Compare reductions and recorded rows with those of the master, bit by bit, and the sentences of failures."""
    runs = program.runs(values, steps, stop_time)
    assert runs.rows is not None
    for i, row in enumerate(values):
        result = of_master(program, row, float(steps[i]), stop_time, order)
        if isinstance(result, str):
            assert runs.messages[i] == result
            assert np.isnan(runs.reduced[i]).all()
            continue
        assert runs.messages[i] == ""
        expected = np.array([reduced(reduction, result) for reduction in program.reductions])
        np.testing.assert_array_equal(runs.reduced[i], expected)
        rows = np.column_stack([result[name] for name in program.record])
        assert runs.rows[i, : len(rows)].tobytes() == rows.tobytes()
        assert np.isnan(runs.rows[i, len(rows) :]).all()
