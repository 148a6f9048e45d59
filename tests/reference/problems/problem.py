"""A co-simulation problem with an exact solution, and the linear algebra that all such problems share.

A linear problem is z' = A z as one monolithic system, so z(t) = exp(A t) z(0). A component with inputs u is
z' = A z + B u. With u held over h the component moves by z+ = Phi z + Gamma u, where

    exp([A B; 0 0] h) = [Phi Gamma; 0 1]

(K. J. Astrom, B. Wittenmark, "Computer-Controlled Systems", 3rd ed., section 2.3).
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from typing import Protocol

import numpy as np
from scipy.linalg import expm

from adaptimp_fmu import Model, build
from orchestration.fmi.description import Description, read_description
from orchestration.system.system import Component, Connection, System


class Columns(Protocol):
    """Outputs by ``component.variable``, such as a `Result` or the dictionary that `exact` returns."""

    def __getitem__(self, name: str, /) -> np.ndarray:
        """Return one output over time."""
        ...


@dataclass(frozen=True)
class Problem:
    """A coupled system with its exact solution.

    Attributes
    ----------
    name
        Name of the problem.
    system
        Function ``system(step, stop_time, **numbers)``, times in s, which returns the FMUs with their
        connections and start values. The components are in the default order of the problem.
    exact
        Function ``exact(t, **numbers)``, which returns every output by ``component.variable`` at the times
        t, s, of any shape.
    span
        Stop time and step, s. Up to this step, for a coupling that holds its inputs, the second term of the
        error at the stop time is at most a tenth of the first. Let a coupling force move an eigenvalue lambda
        by e. A delay tau of this force moves the eigenvalue by e |lambda| tau more. tau = 3 h / 2 with Jacobi,
        less with Gauss-Seidel. So a mode of frequency w, with e = w / 2, is wrong by
        exp(y) - 1 = y + y^2 / 2 + ..., where y = w^2 tau T / 2. The demand is y / 2 <= 0.1, or
        step <= 0.27 / (w^2 T).
    bonds
        Power bonds as pairs (force output, velocity output), both ``component.variable``. Each output of a
        pair is an input of the component of the other. The product of the two is the power through the
        coupling, W.
    energy
        Function ``energy(columns, **numbers)``, which returns the total energy, J, from the outputs. None if
        the problem has no energy.
    """

    name: str
    system: Callable[..., System]
    exact: Callable[..., dict[str, np.ndarray]]
    span: tuple[float, float]
    bonds: tuple[tuple[str, str], ...] = ()
    energy: Callable[..., np.ndarray] | None = None


@dataclass(frozen=True)
class Part:
    """Definition of a component: a function that declares the model of its FMU, and start values by name."""

    declare: Callable[[], Model]
    start: Mapping[str, float]


def assemble(
    name: str,
    parts: Mapping[str, Part],
    wires: Sequence[tuple[str, str, str, str]],
    step: float,
    stop_time: float,
) -> System:
    """Build the FMUs of a problem and connect them to a system.

    Parameters
    ----------
    name
        Name of the system.
    parts
        Definitions by component name, in the default order.
    wires
        Source, output, target and input of each connection.
    step, stop_time
        Communication step and stop time, s.
    """
    components = tuple(Component(n, _described(part.declare), dict(part.start)) for n, part in parts.items())
    return System(name, components, tuple(Connection(*wire) for wire in wires), step, stop_time)


def free_motion(A: np.ndarray, start: Sequence[float], t: np.ndarray) -> np.ndarray:
    """Return exp(A t) z(0), shape (n, *shape of t), for A of shape (n, n), z(0) of shape (n,) and times t, s."""
    A, t = np.asarray(A, dtype=float), np.asarray(t, dtype=float)
    motion = _exponentials(A.tobytes(), t.tobytes()).reshape(*t.shape, *A.shape) @ np.asarray(start, dtype=float)
    return np.moveaxis(motion, -1, 0)


@lru_cache(maxsize=64)
def _exponentials(matrix: bytes, times: bytes) -> np.ndarray:
    """Return exp(A t) for all times, shape (n_times, n, n); the same ones serve the runs of all algorithms."""
    A, t = np.frombuffer(matrix), np.frombuffer(times)
    n = math.isqrt(A.size)
    return expm(A.reshape(n, n) * t[:, None, None])


def held(A: np.ndarray, B: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray]:
    """Return Phi, shape (n, n), and Gamma, shape (n, m), of a step h, s, with the inputs held."""
    n, m = B.shape
    augmented = np.zeros((n + m, n + m))
    augmented[:n, :n], augmented[:n, n:] = A, B
    motion = expm(augmented * h)
    return motion[:n, :n], motion[:n, n:]


@cache
def _described(declare: Callable[[], Model]) -> Description:
    """Build the FMU of a model, once in each process, and return its description."""
    return read_description(build(declare()))
