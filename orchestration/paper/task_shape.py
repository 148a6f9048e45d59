"""What the task of a run is: a position in the plane, or position and orientation in space.

A run tells it by its columns. In space the coordinates are x = (p, phi) of docs/spatial-arms.md, three positions, m,
and three angles, rad. Where a norm joins them, an angle counts L: an error e has the size |S e| and a force F the
size |S^-1 F| with S = diag(1, 1, 1, L, L, L) (docs/decisions/019-lengths-of-positions-and-angles.md).
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from orchestration.paper.spatial_numbers import LENGTH, POSITIONS, TEN
from orchestration.results.result import Result

PLANAR, SPATIAL = 2, 6  # task coordinates
ERROR, COMMAND, ESTIMATES = "controller.e", "controller.tau_cmd", "controller.p_hat"


@dataclass(frozen=True)
class TaskShape:
    """How many coordinates and joints the loop of a run has, and which parameter it looks for.

    Attributes
    ----------
    size
        Number of task coordinates, 2 or 6.
    joints
        Number of joints.
    estimate
        Column of the estimated mass.
    symbol
        This mass in a formula.
    """

    size: int
    joints: int
    estimate: str
    symbol: str

    @property
    def positions(self) -> int:
        """Number of positions among the coordinates; the others are angles."""
        return min(self.size, POSITIONS)


PLANAR_SHAPE = TaskShape(PLANAR, 2, f"{ESTIMATES}[2]", r"\hat m_2")


def shape_of(result: Result) -> TaskShape:
    """The task of a run, by the elements of ``controller.e``, ``controller.tau_cmd`` or ``plant.x``.

    A run without these columns, or with another number of coordinates, is taken for a planar one.
    """
    size = next((found for name in (ERROR, "plant.x") if (found := count(result, name))), PLANAR)
    if size != SPATIAL:
        return PLANAR_SHAPE
    joints = next((n for name in (COMMAND, "actuator.tau", "plant.q") if (n := count(result, name))), SPATIAL)
    return TaskShape(size, joints, f"{ESTIMATES}[{payload_number(joints)}]", r"\hat m")


def payload_number(joints: int) -> int:
    """The number of the payload's mass among the parameters of an arm in space; it follows thirteen for each joint."""
    return (TEN + 3) * joints + 1


def count(result: Result, name: str) -> int:
    """How many elements of an array a run has, from the first one on; 0 if it has none."""
    number = 0
    while f"{name}[{number + 1}]" in result:
        number += 1
    return number


def scales(size: int) -> np.ndarray:
    """The diagonal of S for so many coordinates, 1 for a position and L, m, for an angle, shape (size,)."""
    return np.where(np.arange(size) < POSITIONS, 1.0, LENGTH) if size == SPATIAL else np.ones(size)


def norms(vectors: np.ndarray) -> np.ndarray:
    """Euclidean norms of the rows of an array, shape (n, m); of two columns with the bits of ``np.linalg.norm``."""
    squares = vectors[:, 0] * vectors[:, 0]
    for column in vectors.T[1:]:
        squares = squares + column * column
    return np.sqrt(squares)


def lengths(vectors: np.ndarray) -> np.ndarray:
    """Sizes |S e| of errors or rates of the task coordinates, in m or m/s, shape (n,), from shape (n, m)."""
    return norms(vectors * scales(vectors.shape[1]))


def forces(vectors: np.ndarray) -> np.ndarray:
    """Sizes |S^-1 F| of forces and moments, N, shape (n,), from shape (n, m)."""
    return norms(vectors / scales(vectors.shape[1]))


Size = Callable[[np.ndarray], np.ndarray]
"""`lengths` or `forces`."""
