"""Quantities that figures and claims read off a run."""

from dataclasses import dataclass

import numpy as np

from orchestration.result import Result


@dataclass(frozen=True)
class Contact:
    """When and where the tip touched the wall.

    Attributes
    ----------
    first, last
        First and last communication point with a force, s.
    enter, leave
        Tip position there, m, shape (2,).
    share
        Part of the communication points from first to last at which the force is not zero.
    phases
        Number of separate contacts; more than one means that the tip bounced.
    peak
        Largest norm of the force, N.
    """

    first: float
    last: float
    enter: np.ndarray
    leave: np.ndarray
    share: float
    phases: int
    peak: float


def contact(result: Result) -> Contact:
    """The contact of a run.

    Raises
    ------
    ValueError
        If the tip never touched the wall.
    """
    force = np.linalg.norm(result.vector("plant.F_ext"), axis=1)
    touching = force > 0
    if not touching.any():
        msg = "the tip never touched the wall"
        raise ValueError(msg)
    first, last = np.flatnonzero(touching)[[0, -1]]
    x = result.vector("plant.x")
    return Contact(
        first=float(result.time[first]),
        last=float(result.time[last]),
        enter=x[first],
        leave=x[last],
        share=float(touching[first : last + 1].mean()),
        phases=int((np.diff(touching.astype(int)) > 0).sum() + touching[0]),
        peak=float(force.max()),
    )


def at_ticks(result: Result, name: str) -> np.ndarray:
    """The columns ``name[1]``, ``name[2]`` at the controller's ticks, shape (n_ticks, 2)."""
    return np.column_stack([result.at_ticks(f"{name}[{i}]") for i in (1, 2)])


def largest_norm(vectors: np.ndarray) -> float:
    """Largest Euclidean norm among vectors of shape (n, 2)."""
    return float(np.linalg.norm(vectors, axis=1).max())
