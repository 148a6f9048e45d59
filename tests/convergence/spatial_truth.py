"""An independent solution for the PUMA 560 that hits a wall with its tool, or the stops of its joints.

The dynamics are Pinocchio's. DOP853 integrates them from one event to the next (`tests.convergence.truth.solve`).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from fmus.robots.puma560 import PUMA
from tests.reference.spatial.arm import hold, pin, puma, ten_of_body

N = 6
GRAVITY = (0.0, 0.0, -9.81)
AXES = pin.LOCAL_WORLD_ALIGNED
FREE = 1e9  # rad, a range without ends


@dataclass(frozen=True)
class SpatialThrow:
    """An arm in motion near a wall and near its stops, with all numbers in SI units.

    The other attributes are the parameters of the FMU `PlantPuma560` of the same names.

    Attributes
    ----------
    q, dq
        State at the start, rad and rad/s, shape (6,).
    distance
        Distance of the contact point from the wall at the start, m.
    tau
        Constant joint torque, N.m, shape (6,).
    """

    q: tuple[float, ...] = PUMA.start.q
    dq: tuple[float, ...] = (0.0,) * N
    distance: float = 1.0
    tau: tuple[float, ...] = (0.0,) * N
    contact_point: tuple[float, ...] = (0.0, 0.0, 0.0)
    wall_normal: tuple[float, ...] = (0.0, 0.0, -1.0)
    K_f: float = 1e5
    D_f: float = 0.0
    mu: float = 0.0
    friction_velocity: float = 0.3
    q_min: tuple[float, ...] = (-FREE,) * N
    q_max: tuple[float, ...] = (FREE,) * N
    stop_stiffness: tuple[float, ...] = (2e5,) * N
    stop_damping: tuple[float, ...] = (0.0,) * N
    model: Any = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Build Pinocchio's model with the payload."""
        body = PUMA.payload
        built = hold(puma(GRAVITY, self.contact_point), ten_of_body(body.mass, body.center, body.inertia))
        object.__setattr__(self, "model", built)

    @cached_property
    def data(self) -> Any:
        """Memory of Pinocchio."""
        return self.model.createData()

    @property
    def start(self) -> np.ndarray:
        """State (q, dq) at t = 0, rad and rad/s, shape (12,)."""
        return np.array([*self.q, *self.dq])

    @cached_property
    def offset(self) -> float:
        """Distance of the wall from the origin along the normal, m."""
        return float(np.dot(self.wall_normal, self.place(self.start)[0])) + self.distance

    @property
    def parameters(self) -> dict[str, float]:
        """Start values of the FMU, whose own p has ten digits only."""
        vectors = ("contact_point", "wall_normal", "q_min", "q_max", "stop_stiffness", "stop_damping", "tau")
        given = {name: getattr(self, name) for name in vectors} | {"q_start": self.q, "dq_start": self.dq}
        given["p"] = tuple(map(float, PUMA.chain.p))
        values = {f"{name}[{i + 1}]": value for name, vector in given.items() for i, value in enumerate(vector)}
        scalars = {name: getattr(self, name) for name in ("K_f", "D_f", "mu", "friction_velocity")}
        return values | scalars | {"wall_offset": self.offset}

    def place(self, state: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return position m and velocity m/s of the contact point, shape (3,), and its Jacobian, shape (3, 6)."""
        q, dq = state[:N], state[N:]
        frame = self.model.getFrameId("touch")
        J = pin.computeFrameJacobian(self.model, self.data, q, frame, AXES)[:3]
        return self.data.oMf[frame].translation.copy(), J @ dq, J

    def gap(self, state: np.ndarray) -> float:
        """Return the depth of the contact point in the wall, m, negative outside."""
        return float(np.dot(self.wall_normal, self.place(state)[0])) - self.offset

    def factor(self, state: np.ndarray) -> float:
        """Return the damping factor 1 + D_f d(gap)/dt of Hunt and Crossley's contact law."""
        return 1 + self.D_f * float(np.dot(self.wall_normal, self.place(state)[1]))

    def force(self, state: np.ndarray) -> np.ndarray:
        """Return the force of the contact point on a wall that is in contact and pushes, N, shape (3,)."""
        n, v = np.array(self.wall_normal), self.place(state)[1]
        slide = v - (n @ v) * n
        speed = np.linalg.norm(slide)
        direction = slide / speed if speed > 0 else np.zeros(3)
        pressed = self.K_f * self.gap(state) * self.factor(state)
        return pressed * (n + self.mu * np.tanh(speed / self.friction_velocity) * direction)

    def depth(self, joint: int, state: np.ndarray) -> float:
        """Return how far a joint is beyond the nearer end of its range, rad, negative within it."""
        return max(state[joint] - self.q_max[joint], self.q_min[joint] - state[joint])

    def stopping(self, joint: int, state: np.ndarray) -> float:
        """Return the torque of the stop on a joint that is beyond its range, N.m."""
        above = state[joint] - self.q_max[joint] > self.q_min[joint] - state[joint]
        out = 1.0 if above else -1.0
        u = self.stop_damping[joint] * out * state[N + joint]
        return -out * self.stop_stiffness[joint] * self.depth(joint, state) * np.exp(np.arcsinh(u))

    @property
    def indicators(self) -> dict[str, Callable[[np.ndarray], float]]:
        """Functions of the state whose changes of sign are the events, by the name of the mode that each changes."""
        stops = {f"stop{k + 1}": lambda state, k=k: self.depth(k, state) for k in range(N) if self.bounded(k)}
        return {"contact": self.gap, "pushing": self.factor, **stops}

    def bounded(self, joint: int) -> bool:
        """Whether a joint has a range."""
        return self.q_max[joint] < FREE or self.q_min[joint] > -FREE

    def derivative(self, state: np.ndarray, modes: Mapping[str, bool]) -> np.ndarray:
        """Return the derivative of the state (q, dq), shape (12,), in given modes of the force laws."""
        torque = np.array(self.tau)
        if modes["contact"] and modes["pushing"]:
            torque = torque - self.place(state)[2].T @ self.force(state)
        for k in range(N):
            if modes.get(f"stop{k + 1}"):
                torque[k] += self.stopping(k, state)
        return np.concatenate([state[N:], pin.aba(self.model, self.data, state[:N], state[N:], torque)])

    def energy(self, state: np.ndarray) -> float:
        """Return the kinetic and potential energy, with those of the springs of the wall and of the stops, J."""
        kinetic = pin.computeKineticEnergy(self.model, self.data, state[:N], state[N:])
        wall = 0.5 * self.K_f * max(self.gap(state), 0.0) ** 2
        stops = sum(0.5 * self.stop_stiffness[k] * max(self.depth(k, state), 0.0) ** 2 for k in range(N))
        return float(kinetic + pin.computePotentialEnergy(self.model, self.data, state[:N]) + wall + stops)
