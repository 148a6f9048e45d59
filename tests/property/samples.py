"""Random arms and states, with fixed seeds; and numbers from CasADi functions."""

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

EPS = np.finfo(float).eps


@dataclass(frozen=True)
class Samples:
    """`size` arms of `n` joints, each with a state: every array has one column per sample.

    Attributes
    ----------
    q, dq, v, a
        Angles rad, rates rad/s, and a second pair of rates and accelerations rad/s2, shape (n, size).
    p, l
        Parameters (m, viscous, coulomb), shape (3 n, size), and link lengths m, shape (n, size).
    gravity, coulomb_velocity
        m/s2 and rad/s, shape (1, size).
    """

    q: np.ndarray
    dq: np.ndarray
    v: np.ndarray
    a: np.ndarray
    p: np.ndarray
    l: np.ndarray
    gravity: np.ndarray
    coulomb_velocity: np.ndarray

    @property
    def m(self) -> np.ndarray:
        """Masses kg, shape (n, size)."""
        return self.p[: len(self.q)]


def random_arms(n: int, size: int, *, seed: int, regular: bool = False) -> Samples:
    """Masses, lengths of 0.3 to 3, rates up to 5 rad/s, accelerations up to 30 rad/s2.

    With `regular`, every joint but the first is bent by 0.4 to 2.7 rad to either side, so that the
    Jacobian has full row rank.
    """
    rng = np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, (n, size))
    if regular:
        q[1:] = rng.uniform(0.4, 2.7, (n - 1, size)) * rng.choice([-1.0, 1.0], (n - 1, size))
    return Samples(
        q=q,
        dq=rng.uniform(-5, 5, (n, size)),
        v=rng.uniform(-5, 5, (n, size)),
        a=rng.uniform(-30, 30, (n, size)),
        p=rng.uniform(0.3, 3, (3 * n, size)),
        l=rng.uniform(0.3, 3, (n, size)),
        gravity=rng.uniform(0, 20, (1, size)),
        coulomb_velocity=rng.uniform(0.01, 1, (1, size)),
    )


def evaluate(function: ca.Function, *columns: np.ndarray) -> np.ndarray:
    """A CasADi function at every sample, shape (size, rows, columns)."""
    size = columns[0].shape[1]
    values: Any = function(*columns)
    return np.array(ca.DM(values)).reshape(function.size1_out(0), size, -1).transpose(1, 0, 2)
