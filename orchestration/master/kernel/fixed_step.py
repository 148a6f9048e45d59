"""The compiled loop of the fixed-step algorithms: it takes operations and arrays, and returns the failed call.

    for k = first, ..., last - 1:                       t = times[k], h = steps[k] or steps[0]
        every operation of the list (orchestration/master/kernel/step_program.py)
        after every n-th step: a row = the present outputs

The loop neither allocates memory nor raises errors nor sees a Python object. `run` is compiled. Without compilation
(NUMBA_DISABLE_JIT=1) the same source calls FMUs through ctypes, as a slow oracle of itself.
"""

import numpy as np

from orchestration.fmi.codes import WORST_ACCEPTED
from orchestration.fmi.native_calls import raw_do_step, raw_transfer
from orchestration.master.kernel.codes import Kind
from orchestration.master.kernel.compiled import compiled, compiled_for_callers
from orchestration.master.kernel.flat_system import Plan, record
from orchestration.master.kernel.records import Operation, Records


@compiled
def run(
    operations: Records[Operation],
    plan: Plan,
    grid: tuple[np.ndarray, np.ndarray],
    span: tuple[int, int],
    rows: np.ndarray,
    every: int,
) -> tuple[int, int, int]:
    """Make the steps span[0] to span[1] - 1.

    Parameters
    ----------
    operations
        Operations of a step, see `orchestration.master.kernel.step_program.operations_of_step`.
    grid
        Communication points, s, shape (n_steps + 1,), and step sizes, s, shape (n_steps,), or (1,)
        if all are equal.
    rows
        Receives the recorded outputs after each step k for which k + 1 is a multiple of `every`, one
        row after the other, shape (n_rows, n_columns).

    Returns
    -------
    tuple
        (step, operation, status) of the call that failed; step is span[1] if none did. The status is as unsigned as
        that of `raw_transfer`.
    """
    times, steps = grid
    reals, discretes = plan.reals, plan.discretes
    n = np.uint64(operations.shape[0])  # signed, each index would be tested for < 0
    until_record, row = every - span[0] % every, np.uint64(0)
    for k in range(span[0], span[1]):
        t = times[k]
        h = steps[k] if steps.size > 1 else steps[0]
        for j in range(n):
            operation = operations[j]
            if operation.kind == Kind.STEP:
                status = raw_do_step(operation.function, operation.instance, t, h)
            elif operation.kind == Kind.TRANSFER:
                status = raw_transfer(
                    operation.function,
                    operation.instance,
                    operation.first,
                    operation.count,
                    operation.place,
                )
            elif operation.kind == Kind.COPY_REALS:
                copy_values(operation, reals)
                continue
            else:
                copy_values(operation, discretes)
                continue
            if status > WORST_ACCEPTED:
                return k, j, status
        until_record -= 1
        if until_record == 0:
            record(plan, rows, row)
            until_record, row = every, row + np.uint64(1)
    return span[1], 0, 0


@compiled_for_callers
def copy_values(operation: Operation, values: np.ndarray) -> None:
    """Copy neighbouring values to other places of their buffer."""
    source, target = np.uint64(operation.first), np.uint64(operation.place)
    for i in range(np.uint64(operation.count)):
        values[target + i] = values[source + i]
