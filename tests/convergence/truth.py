"""An independent solution for an arm that hits a wall, by which the errors of the FMU `Plant` are measured.

The right-hand side is written in closed form. DOP853 integrates it from one contact event to the next.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.integrate import solve_ivp

RTOL, ATOL = 3e-14, 1e-16
INSTANT = 1e-12  # s; events that are closer together happen at one instant
MAX_STEP = 2e-4  # s; keeps the dense output, on which events are found, as accurate as the steps


class Thrown(Protocol):
    """An arm in motion near what it may hit."""

    @property
    def start(self) -> np.ndarray:
        """State (q, dq) at t = 0, rad and rad/s, shape (2 n,)."""
        ...

    @property
    def indicators(self) -> Mapping[str, Callable[[np.ndarray], float]]:
        """Functions of the state whose changes of sign are the events, by the name of the mode that each changes."""
        ...

    def derivative(self, state: np.ndarray, modes: Mapping[str, bool]) -> np.ndarray:
        """Return the derivative of the state in given modes of the force laws."""
        ...


@dataclass(frozen=True)
class Throw:
    """A tip thrown at the wall n.x >= offset, with all numbers in SI units.

    The other attributes are the parameters of the FMU `Plant` of the same names.

    Attributes
    ----------
    v
        Velocity of the tip at the start, m/s.
    q
        Joint angles at the start, rad.
    distance
        Distance of the tip from the wall at the start, m.
    turn
        Angle by which the normal n of the wall is turned from (-1, 0), rad.
    tau
        Constant joint torque, N.m.
    """

    v: tuple[float, float]
    q: tuple[float, float] = (2.2, 1.1)
    distance: float = 0.012
    turn: float = 0.0
    tau: tuple[float, float] = (0.0, 0.0)
    m: tuple[float, float] = (2.0, 1.0)
    l: tuple[float, float] = (1.0, 0.8)
    viscous: tuple[float, float] = (0.0, 0.0)
    gravity: float = 9.81
    K_f: float = 1e5
    D_f: float = 0.0
    mu: float = 0.0
    friction_velocity: float = 0.1

    @property
    def normal(self) -> np.ndarray:
        """Normal into the wall, of length 1, shape (2,)."""
        return np.array([-np.cos(self.turn), -np.sin(self.turn)])

    @property
    def offset(self) -> float:
        """Distance of the wall from the origin along the normal, m."""
        return float(self.normal @ self.tip(np.array(self.q))) + self.distance

    @property
    def start(self) -> np.ndarray:
        """State (q, dq) at t = 0, rad and rad/s, shape (4,)."""
        q = np.array(self.q)
        return np.concatenate([q, np.linalg.solve(self.jacobian(q), self.v)])

    def tip(self, q: np.ndarray) -> np.ndarray:
        """Return the position of the tip, m, shape (2,)."""
        (l1, l2), a, b = self.l, q[0], q[0] + q[1]
        return np.array([l1 * np.cos(a) + l2 * np.cos(b), l1 * np.sin(a) + l2 * np.sin(b)])

    def jacobian(self, q: np.ndarray) -> np.ndarray:
        """Return the Jacobian of the tip, m/rad, shape (2, 2)."""
        (l1, l2), a, b = self.l, q[0], q[0] + q[1]
        s, c = l2 * np.sin(b), l2 * np.cos(b)
        return np.array([[-l1 * np.sin(a) - s, -s], [l1 * np.cos(a) + c, c]])

    def inertia(self, q: np.ndarray) -> np.ndarray:
        """Return the inertia matrix, kg.m2, shape (2, 2)."""
        (m1, m2), (l1, l2), c2 = self.m, self.l, np.cos(q[1])
        off = m2 * l2**2 + m2 * l1 * l2 * c2
        return np.array([[(m1 + m2) * l1**2 + m2 * l2**2 + 2 * m2 * l1 * l2 * c2, off], [off, m2 * l2**2]])

    def energy(self, state: np.ndarray) -> float:
        """Return the kinetic and potential energy, with that of the spring of the wall, J."""
        q, dq = state[:2], state[2:]
        (m1, m2), (l1, _) = self.m, self.l
        height = m1 * l1 * np.sin(q[0]) + m2 * self.tip(q)[1]
        spring = 0.5 * self.K_f * max(self.gap(state), 0) ** 2
        return float(0.5 * dq @ self.inertia(q) @ dq + self.gravity * height + spring)

    def gap(self, state: np.ndarray) -> float:
        """Return the depth of the tip in the wall, m, negative outside."""
        return float(self.normal @ self.tip(state[:2]) - self.offset)

    def factor(self, state: np.ndarray) -> float:
        """Return the damping factor 1 + D_f d(gap)/dt of Hunt and Crossley's contact law."""
        return float(1 + self.D_f * self.normal @ self.jacobian(state[:2]) @ state[2:])

    def force(self, state: np.ndarray) -> np.ndarray:
        """Return the force of the tip on a wall that is in contact and pushes, N, shape (2,)."""
        along = np.array([-self.normal[1], self.normal[0]])
        sliding = np.tanh(along @ self.jacobian(state[:2]) @ state[2:] / self.friction_velocity)
        return self.K_f * self.gap(state) * self.factor(state) * (self.normal + self.mu * sliding * along)

    @property
    def indicators(self) -> dict[str, Callable[[np.ndarray], float]]:
        """Functions of the state whose changes of sign are the events, by the name of the mode that each changes."""
        return {"contact": self.gap, "pushing": self.factor}

    def derivative(self, state: np.ndarray, modes: Mapping[str, bool]) -> np.ndarray:
        """Return the derivative of the state (q, dq), shape (4,), in given modes of the force law."""
        q, dq = state[:2], state[2:]
        (_, m2), (l1, l2), J = self.m, self.l, self.jacobian(q)
        F = np.zeros(2)
        if modes["contact"] and modes["pushing"]:
            F = self.force(state)
        c = m2 * l1 * l2 * np.sin(q[1])
        coriolis = c * np.array([-dq[1] * dq[0] - (dq[0] + dq[1]) * dq[1], dq[0] ** 2])
        g2 = m2 * self.gravity * l2 * np.cos(q[0] + q[1])
        gravity = np.array([sum(self.m) * self.gravity * l1 * np.cos(q[0]) + g2, g2])
        torque = np.array(self.tau) - coriolis - gravity - np.array(self.viscous) * dq - J.T @ F
        return np.concatenate([dq, np.linalg.solve(self.inertia(q), torque)])


def solve(throw: Thrown, T: float) -> tuple[np.ndarray, list[str]]:
    """Return the state at T, s, and the events on the way, such as ``["+contact", "-pushing"]``."""
    indicators, t, state, log = throw.indicators, 0.0, throw.start, []
    flipped: dict[str, float] = {}  # when a mode changed last, s
    modes = {name: z(state) > 0 for name, z in indicators.items()}
    while True:
        events = [crossing(z, rising=not modes[name]) for name, z in indicators.items()]

        def rhs(_: float, y: np.ndarray, fixed: Mapping[str, bool] = dict(modes)) -> np.ndarray:
            return throw.derivative(y, fixed)

        piece = solve_ivp(rhs, (t, T), state, "DOP853", events=events, rtol=RTOL, atol=ATOL, max_step=MAX_STEP)
        t, state = piece.t[-1], piece.y[:, -1]
        if piece.status == 0:
            return state, log
        crossed = [n for n, times in zip(indicators, piece.t_events, strict=True) if times.size and times[-1] == t]
        # Rounding may have moved the crossing of another indicator to just before this one, where it is not seen again.
        settled = [name for name in indicators if t - flipped.get(name, -1.0) > INSTANT and name not in crossed]
        crossed += [name for name in settled if (indicators[name](state) > 0) != modes[name]]
        for name in crossed:
            flipped[name], modes[name] = t, not modes[name]
            log.append(("+" if modes[name] else "-") + name)


def crossing(indicator: Callable[[np.ndarray], float], *, rising: bool) -> Callable[[float, np.ndarray], float]:
    """Return a terminal event for `solve_ivp`."""

    def event(_: float, y: np.ndarray) -> float:
        return indicator(y)

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = 1 if rising else -1  # type: ignore[attr-defined]
    return event
