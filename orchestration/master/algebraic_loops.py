"""Algebraic loops in initialization mode.

There, outputs are functions y(u) of the inputs, and the connections ask for u = y(u). Newton's method
with the Jacobian from differences (of one unit's outputs at a time, since its outputs depend on its own
inputs only), and a step that is halved while it makes the residual larger.
"""

from collections.abc import Callable

import numpy as np

from orchestration.errors import InitializationError
from orchestration.master.flatten import Assembly
from orchestration.master.kernel.codes import Column

MAX_ITERATIONS, MAX_HALVINGS = 50, 20
TOLERANCE = 1e-12  # of u - y(u), over 1 + |y|: some hundred roundings
DISPLACEMENT = 1e-7  # of an input, over 1 + |u|: near the root of the rounding error

Evaluate = Callable[[int | None], None]  # hand over the inputs, fetch the outputs, of one component or of all


def solve_loops(name: str, assembly: Assembly, evaluate: Evaluate) -> None:
    """Find inputs that equal their sources; afterwards all buffers and units have them.

    Parameters
    ----------
    name
        Of the system.
    evaluate
        Sets the inputs in the plan's buffers and gets the outputs, of a component or of all (None).

    Raises
    ------
    InitializationError
        Naming the connection with the largest residual.
    """
    reals, links = assembly.plan.reals, assembly.plan.real_links.astype(np.int64)
    sources, targets = links[:, 0], links[:, 1]

    def residual() -> np.ndarray:
        evaluate(None)
        return (reals[sources] - reals[targets]) / (1 + np.abs(reals[sources]))

    found = residual()
    for _ in range(MAX_ITERATIONS):
        if _size(found) <= TOLERANCE:
            return
        direction = _direction(assembly, evaluate)
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
        f" {assembly.real_connections[worst]} ends with {reals[sources[worst]]:.9g} at its source and"
        f" {reals[targets[worst]]:.9g} at its target. Give other start values, or break the loop with a"
        " component whose outputs do not depend on its inputs."
    )
    raise InitializationError(msg)


def _size(residual: np.ndarray) -> float:
    """The largest element, 0 if there is none; infinite if one is no number."""
    return float(np.abs(residual).max(initial=0.0)) if np.isfinite(residual).all() else np.inf


def _direction(assembly: Assembly, evaluate: Evaluate) -> np.ndarray:
    """Newton's correction of the inputs, from outputs that have been evaluated; shape (n_links,)."""
    plan = assembly.plan
    reals, links = plan.reals, plan.real_links.astype(np.int64)
    sources, targets = links[:, 0], links[:, 1]
    base = reals.copy()
    jacobian = -np.eye(len(links))
    for i, row in enumerate(plan.table):
        for j in range(row[Column.FIRST_REAL], row[Column.END_REAL]):
            value = base[targets[j]]
            reals[targets[j]] = value + DISPLACEMENT * (1 + abs(value))
            evaluate(i)
            jacobian[:, j] += (reals[sources] - base[sources]) / (reals[targets[j]] - value)
            reals[:] = base
        evaluate(i)
    right = -(base[sources] - base[targets])
    return np.linalg.lstsq(np.nan_to_num(jacobian), np.nan_to_num(right), rcond=None)[0]
