"""Arms in space in the turned coordinates of a task, at many states: equations of the joints, and angles in NumPy.

    x = T' (p, phi),   J = T' diag(I, E^-1) J_g,   F = T' (f, E' m),   T = diag(R_c, R_c)

Matrices of the joints come from `fmus.mechanics.spatial_arm`, which is held against Pinocchio elsewhere. Angles, E and
its rate are formed here. All arrays have a sample per row.
"""

from dataclasses import dataclass
from functools import cache, cached_property

import casadi as ca
import numpy as np
from scipy.spatial.transform import Rotation

from fmus.mechanics.spatial_arm import SpatialArm
from fmus.mechanics.spatial_model import SpatialArmModel
from tests.property.samples import evaluate
from tests.property.spatial_robots import robot
from tests.property.task_space import TaskSpace, apply


@dataclass(frozen=True)
class SpatialChains(TaskSpace):
    """An arm by its name: q and dq of shape (size, n), angles of two frames, rad, and gravity, m/s2, (size, 3)."""

    name: str
    q: np.ndarray
    dq: np.ndarray
    gravity: np.ndarray
    coulomb_velocity: np.ndarray
    reference_rpy: np.ndarray
    task_rpy: np.ndarray

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.q.shape[1]

    @property
    def rates(self) -> np.ndarray:
        """Rates of the joints."""
        return self.dq

    @property
    def size_of_p(self) -> int:
        """Thirteen for each joint, and ten of the payload."""
        return 13 * self.n + 10

    @cached_property
    def turned(self) -> np.ndarray:
        """The matrix T, shape (size, 6, 6)."""
        return _twice(Rotation.from_euler("xyz", self.task_rpy).as_matrix())

    def in_task(self, v: np.ndarray) -> np.ndarray:
        """T' v."""
        return np.einsum("kji,kj->ki", self.turned, v)

    def in_base(self, v: np.ndarray) -> np.ndarray:
        """T v."""
        return np.einsum("kij,kj->ki", self.turned, v)

    @cached_property
    def phi(self) -> np.ndarray:
        """Roll, pitch and yaw of the tip from its reference orientation, rad."""
        R = evaluate(_of_frame(self.name), self.q.T)
        reference = Rotation.from_euler("xyz", self.reference_rpy)
        return (Rotation.from_matrix(R[:, :3]) * reference.inv()).as_euler("xyz")

    @cached_property
    def x(self) -> np.ndarray:
        """Turned coordinates of the tip, m and rad."""
        position = evaluate(_of_frame(self.name), self.q.T)[:, 3]
        return self.in_task(np.hstack([position, self.phi]))

    @cached_property
    def E(self) -> np.ndarray:
        """E with w = E dphi, shape (size, 3, 3): its columns are the axes that roll, pitch and yaw turn about."""
        yaw = Rotation.from_euler("z", self.phi[:, 2:]).as_matrix()
        both = yaw @ Rotation.from_euler("y", self.phi[:, 1:2]).as_matrix()
        return np.stack([both[:, :, 0], yaw[:, :, 1], np.tile([0.0, 0.0, 1.0], (len(self.q), 1))], axis=2)

    @cached_property
    def geometric(self) -> tuple[np.ndarray, np.ndarray]:
        """Geometric Jacobian and its rate, shape (size, 6, n)."""
        arm = _arm(self.name)
        return evaluate(arm.jacobian, self.q.T), evaluate(arm.jacobian_rate, self.q.T, self.dq.T)

    @cached_property
    def J(self) -> np.ndarray:
        """Jacobian of x."""
        J = self.geometric[0]
        analytic = np.concatenate([J[:, :3], np.linalg.solve(self.E, J[:, 3:])], axis=1)
        return self.turned.transpose(0, 2, 1) @ analytic

    @cached_property
    def dJ(self) -> np.ndarray:
        """Rate of the Jacobian: E dphi = w gives E ddphi = dw - dE dphi, for every column."""
        (J, dJ), (_, pitch, yaw) = self.geometric, self.phi.T
        turning = np.linalg.solve(self.E, J[:, 3:])
        _, dpitch, dyaw = apply(turning, self.dq).T
        sin, cos = np.sin, np.cos
        zero = np.zeros_like(yaw)
        of_roll = np.stack(
            [
                -sin(yaw) * cos(pitch) * dyaw - cos(yaw) * sin(pitch) * dpitch,
                cos(yaw) * cos(pitch) * dyaw - sin(yaw) * sin(pitch) * dpitch,
                -cos(pitch) * dpitch,
            ],
            axis=1,
        )
        of_pitch = np.stack([-cos(yaw) * dyaw, -sin(yaw) * dyaw, zero], axis=1)
        dE = np.stack([of_roll, of_pitch, np.zeros_like(of_roll)], axis=2)
        analytic = np.concatenate([dJ[:, :3], np.linalg.solve(self.E, dJ[:, 3:] - dE @ turning)], axis=1)
        return self.turned.transpose(0, 2, 1) @ analytic

    @cached_property
    def wrench_map(self) -> np.ndarray:
        """The force of a wrench in the axes of the base."""
        size = len(self.q)
        whole = np.zeros((size, 6, 6))
        whole[:, :3, :3], whole[:, 3:, 3:] = np.eye(3), self.E.transpose(0, 2, 1)
        return self.turned.transpose(0, 2, 1) @ whole

    def H(self, p: np.ndarray) -> np.ndarray:
        """Inertia matrix."""
        return evaluate(_arm(self.name).inertia, self.q.T, self._loaded(p))

    def C(self, p: np.ndarray) -> np.ndarray:
        """Coriolis matrix."""
        return evaluate(_arm(self.name).coriolis, self.q.T, self.dq.T, self._loaded(p))

    def rest(self, p: np.ndarray) -> np.ndarray:
        """Torque g + f."""
        arm, loaded = _arm(self.name), self._loaded(p)
        g = evaluate(arm.gravity_torque, self.q.T, loaded, self.gravity.T)
        f = evaluate(arm.friction_torque, self.dq.T, loaded, self.coulomb_velocity[None])
        return (g + f)[..., 0]

    def _loaded(self, p: np.ndarray) -> np.ndarray:
        """Parameters of the chain with the payload, shape (13 n, size)."""
        return evaluate(_of_load(self.name), p.T)[..., 0].T


def _twice(R: np.ndarray) -> np.ndarray:
    """The matrices diag(R, R)."""
    whole = np.zeros((len(R), 6, 6))
    whole[:, :3, :3] = whole[:, 3:, 3:] = R
    return whole


def _arm(name: str) -> SpatialArm:
    return robot(name).arm


@cache
def _of_frame(name: str) -> ca.Function:
    """Rotation and below it the position of the tip, shape (4, 3)."""
    q = ca.SX.sym("q", robot(name).n)
    R, position = _arm(name).tip_frame(q)
    return ca.Function("frame", [q], [ca.vertcat(R, position.T)])


@cache
def _of_load(name: str) -> ca.Function:
    """Parameters of the chain for those of the chain and the payload."""
    model = SpatialArmModel(_arm(name), ca.SX(3, 1), ca.SX(1), ca.SX.eye(3))
    p = ca.SX.sym("p", 13 * model.n + 10)
    return ca.Function("loaded", [p], [model.loaded(p)])
