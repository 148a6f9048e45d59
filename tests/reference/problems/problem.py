"""What a known problem is, and the little algebra that all of them share.

A linear problem is z' = A z monolithically, so z(t) = exp(A t) z(0). A unit of it, with inputs u, is
z' = A z + B u; with u held over h it moves by z+ = Phi z + Gamma u,

    exp([A B; 0 0] h) = [Phi Gamma; 0 1]

(K. J. Astrom, B. Wittenmark, "Computer-Controlled Systems", 3rd ed., section 2.3).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Protocol

import numpy as np
from scipy.linalg import expm

from adaptimp_fmu import Model, build
from orchestration.fmi.description import Description, read_description
from orchestration.system.system import Component, Connection, System


class Columns(Protocol):
    """Outputs by ``component.variable``: a `Result`, or what `exact` returns."""

    def __getitem__(self, name: str, /) -> np.ndarray:
        """One output over time."""
        ...


@dataclass(frozen=True)
class Problem:
    """A coupled system with its exact solution.

    Attributes
    ----------
    system
        ``system(step, stop_time, **numbers)``, s: the FMUs with their connections and start values,
        components in the problem's default order.
    exact
        ``exact(t, **numbers)``: every output by ``component.variable`` at the times t, s, any shape.
    span
        (stop time, step), s: up to this step, the next term of the error at the stop time of a coupling that
        holds its inputs is at most a tenth of the first. A delay tau = 3 h / 2 (Jacobi's, the larger)
        of a coupling force that moves an eigenvalue by e moves it by e |lambda| tau more, so a mode
        of frequency w, e = w / 2, is wrong by exp(y) - 1 = y + y^2 / 2 + ..., y = w^2 tau T / 2; the demand
        is y / 2 <= 0.1, or step <= 0.27 / (w^2 T).
    bonds
        Power bonds as (force output, velocity output), both ``component.variable``: each is an input
        of the other's component, and their product is the power, W, through the coupling.
    energy
        ``energy(columns, **numbers)``: total energy, J, from the outputs; None where there is none.
    """

    name: str
    system: Callable[..., System]
    exact: Callable[..., dict[str, np.ndarray]]
    span: tuple[float, float]
    bonds: tuple[tuple[str, str], ...] = ()
    energy: Callable[..., np.ndarray] | None = None


@dataclass(frozen=True)
class Part:
    """A component to be: what declares its model, and its start values."""

    declare: Callable[[], Model]
    start: Mapping[str, float]


def assemble(
    name: str,
    parts: Mapping[str, Part],
    wires: Sequence[tuple[str, str, str, str]],
    step: float,
    stop_time: float,
) -> System:
    """Build the FMUs and connect them.

    Parameters
    ----------
    parts
        By component name, in the default order.
    wires
        (source, output, target, input) of each connection.
    step, stop_time
        s.
    """
    components = tuple(Component(n, _described(part.declare), dict(part.start)) for n, part in parts.items())
    return System(name, components, tuple(Connection(*wire) for wire in wires), step, stop_time)


def free_motion(A: np.ndarray, start: Sequence[float], t: np.ndarray) -> np.ndarray:
    """exp(A t) z(0): shape (n, n), (n,) and any shape s of times, s; returns shape (n, *s)."""
    t = np.asarray(t, dtype=float)
    motion = expm(A * t[..., None, None]) @ np.asarray(start, dtype=float)
    return np.moveaxis(motion, -1, 0)


def held(A: np.ndarray, B: np.ndarray, h: float) -> tuple[np.ndarray, np.ndarray]:
    """Phi, shape (n, n), and Gamma, shape (n, m), of a step of h, s, with the inputs held."""
    n, m = B.shape
    augmented = np.zeros((n + m, n + m))
    augmented[:n, :n], augmented[:n, n:] = A, B
    motion = expm(augmented * h)
    return motion[:n, :n], motion[:n, n:]


@cache
def _described(declare: Callable[[], Model]) -> Description:
    """The FMU of a model, built once per session."""
    return read_description(build(declare()))
