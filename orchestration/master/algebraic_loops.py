"""Algebraic loops between components, solved in initialization mode by a damped Newton method.

In initialization mode, outputs are functions y(u) of the inputs, and the connections ask for u = y(u).
The Jacobian comes from differences. The outputs of a component depend on the inputs of that component
only, so each difference evaluates one component. A correction that makes the residual larger is halved.
"""

from collections.abc import Callable

import numpy as np

from orchestration.errors import InitializationError
from orchestration.master.flatten import Assembly
from orchestration.master.kernel.codes import Column

MAX_ITERATIONS, MAX_HALVINGS = 50, 20
TOLERANCE = 1e-12  # accepted |u - y(u)| / (1 + |y|); this is some hundred rounding errors
DISPLACEMENT = 1e-7  # displacement of an input for a difference, over 1 + |u|; near the root of the rounding error

Evaluate = Callable[[int | None], None]  # sets the inputs and gets the outputs, of one component or of all (None)


def solve_loops(name: str, assembly: Assembly, evaluate: Evaluate, chosen: np.ndarray) -> None:
    """Find inputs that equal the outputs which drive them, and hand these inputs to all components.

    Parameters
    ----------
    name
        Name of the system, for messages.
    assembly
        Buffers and links of the system. Afterwards the buffers hold the solution.
    evaluate
        Function that sets the inputs in the buffers and gets the outputs, of one component (by index) or
        of all components (None).
    chosen
        Places of the links whose inputs are sought, ascending, shape (n_chosen,); those of other links are right.

    Raises
    ------
    InitializationError
        If no solution is found near the start values. The message names the connection with the largest
        residual.
    """
    reals, links = assembly.plan.reals, assembly.plan.real_links[chosen].astype(np.int64)
    sources, targets = links[:, 0], links[:, 1]

    def residual() -> np.ndarray:
        evaluate(None)
        return (reals[sources] - reals[targets]) / (1 + np.abs(reals[sources]))

    found = residual()
    for _ in range(MAX_ITERATIONS):
        if _size(found) <= TOLERANCE:
            return
        direction = _direction(assembly, evaluate, chosen)
        start, before, factor = reals[targets].copy(), _size(found), 1.0
        for _ in range(MAX_HALVINGS):
            reals[targets] = start + factor * direction
            found = residual()
            if _size(found) < before:
                break
            factor *= 0.5
        else:
            break
    worst = int(np.argmax(np.where(np.isfinite(found), np.abs(found), np.inf)))
    msg = (
        f"System {name}: its connections close an algebraic loop that has no solution near the start values:"
        f" {assembly.real_connections[chosen[worst]]} ends with {reals[sources[worst]]:.9g} at its source and"
        f" {reals[targets[worst]]:.9g} at its target. Give other start values, or break the loop with a"
        " component whose outputs do not depend on its inputs."
    )
    raise InitializationError(msg)


def _size(residual: np.ndarray) -> float:
    """Return the largest magnitude: 0 for an empty array, infinity if an element is not finite."""
    return float(np.abs(residual).max(initial=0.0)) if np.isfinite(residual).all() else np.inf


def _direction(assembly: Assembly, evaluate: Evaluate, chosen: np.ndarray) -> np.ndarray:
    """Return Newton's correction of the inputs, shape (n_chosen,), from outputs that have been evaluated."""
    plan = assembly.plan
    reals, links = plan.reals, plan.real_links[chosen].astype(np.int64)
    sources, targets = links[:, 0], links[:, 1]
    base = reals.copy()
    jacobian = -np.eye(len(links))
    for i, row in enumerate(plan.table):
        first, end = np.searchsorted(chosen, (row[Column.FIRST_REAL], row[Column.END_REAL]))
        if first == end:
            continue
        for j in range(first, end):
            value = base[targets[j]]
            reals[targets[j]] = value + DISPLACEMENT * (1 + abs(value))
            evaluate(i)
            jacobian[:, j] += (reals[sources] - base[sources]) / (reals[targets[j]] - value)
            reals[:] = base
        evaluate(i)
    right = -(base[sources] - base[targets])
    return np.linalg.lstsq(np.nan_to_num(jacobian), np.nan_to_num(right), rcond=None)[0]
