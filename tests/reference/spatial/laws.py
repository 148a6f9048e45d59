"""Impedance controllers of an arm in space: torque and adaptation from Pinocchio's rigid-body algorithms.

Lu and Meng (1991), for the task x = (p, phi) of position and angles, R = Rz(yaw) Ry(pitch) Rx(roll) R_0, which SciPy
computes. The angular velocity is w = E dphi. The columns of E are the axes about which the angles turn: roll about
Rz Ry e_x, pitch about Rz e_y, yaw about e_z. So the rate of a column is the cross product of the angular velocity of
the turns that carry it with the column itself. A wrench (f, m) is the force F = (f, E' m).

    HoganImpedance               tau = H ddq* + C dq + g + f + J' F_hat                                 (6), (7)
    CraigAdaptiveImpedance       tau = the same with p_hat,  dp_hat/dt = -Gamma Y' H^-1 J' S^2 e*      (10), (19)
    SlotineLiAdaptiveImpedance   tau = Y(q, dq, dq_r, ddq_r) p_hat + J' (F_hat - K_d s)                     (36)
                                 dp_hat/dt = -Gamma Y' J^-1 s                                               (33)

With the rotation T = diag(R_c, R_c) of `task_rpy`, x is T' (p, phi) and F is T' (f, E' m): gains are diagonal along
the turned axes. S = diag(1, 1, 1, L, L, L) turns radians into metres. Coriolis torques of two velocities come from
those of one by polarization: C(q, dq) v = (c(dq + v) - c(dq - v)) / 4 with c(u) = C(q, u) u. So no law has an equation
of the project. The ten parameters p_hat are those of the
payload at the tip.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from .arm import JOINTS, MOVED, hold, pin

HOGAN, CRAIG, SLOTINE_LI = "HoganImpedance", "CraigAdaptiveImpedance", "SlotineLiAdaptiveImpedance"
LAWS = (HOGAN, CRAIG, SLOTINE_LI)
LAST = slice(10 * (JOINTS - 1), 10 * JOINTS)  # columns of the last body in Pinocchio's regressor


@dataclass(frozen=True)
class Tip:
    """Kinematics of the tip at a state of the joints.

    R turns from the axes of the tip to those of the base; x and dx are task coordinates and their rates, shape (6,); J
    is their Jacobian and dJ its rate, shape (6, 6); E is that of the angles, shape (3, 3).
    """

    R: np.ndarray
    x: np.ndarray
    dx: np.ndarray
    J: np.ndarray
    dJ: np.ndarray
    E: np.ndarray

    def force(self, wrench):
        """Return F = (f, E' m) of a wrench (f, m) in the axes of the base, shape (6,)."""
        return np.concatenate([wrench[:3], self.E.T @ wrench[3:]])

    def turned(self, turn):
        """Return the tip in coordinates T' x, for a rotation T, shape (6, 6), of the axes of the task."""
        return Tip(self.R, turn.T @ self.x, turn.T @ self.dx, turn.T @ self.J, turn.T @ self.dJ, self.E)


@dataclass(frozen=True)
class Sample:
    """What a controller knows at a tick.

    q rad, dq rad/s, ddq rad/s2, shape (6,), and the tip there; the measured force F, shape (6,); `virtual` has the rows
    x_v, dx_v, ddx_v; x_t, dx_t is the reference trajectory.
    """

    q: np.ndarray
    dq: np.ndarray
    ddq: np.ndarray
    tip: Tip
    F: np.ndarray
    virtual: np.ndarray
    x_t: np.ndarray
    dx_t: np.ndarray


class Kinematics:
    """Finds the tip of an arm whose angles count from a reference orientation (roll, pitch, yaw in rad)."""

    def __init__(self, model, reference_rpy):
        self.model, self.data, self.frame = model, model.createData(), model.getFrameId("tip")
        self.reference = Rotation.from_euler("xyz", reference_rpy).as_matrix()

    def tip(self, q, dq):
        """Return the tip at a state of the joints."""
        axes = pin.LOCAL_WORLD_ALIGNED
        pin.computeJointJacobiansTimeVariation(self.model, self.data, q, dq)
        placement = pin.updateFramePlacement(self.model, self.data, self.frame)
        J = pin.getFrameJacobian(self.model, self.data, self.frame, axes)
        dJ = pin.getFrameJacobianTimeVariation(self.model, self.data, self.frame, axes)
        phi = Rotation.from_matrix(placement.rotation @ self.reference.T).as_euler("xyz")
        E = turning_axes(phi)
        inverse = np.linalg.inv(E)
        dphi = inverse @ (J[3:] @ dq)
        analytic = np.vstack([J[:3], inverse @ J[3:]])
        rate = np.vstack([dJ[:3], inverse @ (dJ[3:] - turning_axes_rate(E, dphi) @ analytic[3:])])
        x = np.concatenate([placement.translation, phi])
        return Tip(placement.rotation.copy(), x, analytic @ dq, analytic, rate, E)


class Law:
    """One controller; gains per axis of the task, shape (6,), as the fields of `tests.reference.spatial.loop.Setup`.

    Parameters
    ----------
    setup : Setup
    model : pinocchio.Model
        The arm without its payload, which the controller knows.
    """

    def __init__(self, setup, model):
        self.setup, self.model, self.data = setup, model, model.createData()
        self.M, self.B, self.K, self.Psi, self.K_d = (
            np.array(gain) for gain in (setup.M, setup.B, setup.K, setup.Psi, setup.K_d)
        )
        self.Gamma, self.turn = np.array(setup.Gamma), np.zeros((6, 6))
        self.turn[:3, :3] = self.turn[3:, 3:] = Rotation.from_euler("xyz", setup.task_rpy).as_matrix()
        self.weights = np.array([1.0] * 3 + [setup.L**2] * 3)
        self.viscous, self.coulomb = np.array(setup.assumed_viscous), np.array(setup.assumed_coulomb)

    def torque(self, sample, p_hat):
        """Return the commanded torque, N.m, shape (6,)."""
        q, dq, tip, F = sample.q, sample.dq, sample.tip, sample.F
        if self.setup.controller == SLOTINE_LI:
            s = self.augmented_error(sample)
            return self.model_torque(p_hat, q, dq, *self.joint_reference(sample)) + tip.J.T @ (F - self.K_d * s)
        ddx = self.impedance_acceleration(tip.x, tip.dx, sample.virtual, F)
        ddq = np.linalg.solve(tip.J, ddx - tip.dJ @ dq)
        return self.model_torque(p_hat, q, dq, dq, ddq) + tip.J.T @ F

    def adaptation_rate(self, sample, p_hat):
        """Return dp_hat/dt, shape (10,)."""
        q, dq, J, error = sample.q, sample.dq, sample.tip.J, self.augmented_error(sample)
        if self.setup.controller == HOGAN:
            return np.zeros(10)
        if self.setup.controller == SLOTINE_LI:
            Y, direction = self.regressor(q, dq, *self.joint_reference(sample)), np.linalg.solve(J, error)
        else:
            Y = self.regressor(q, dq, dq, sample.ddq)
            direction = np.linalg.solve(self.inertia(p_hat, q), J.T @ (self.weights * error))
        return -self.Gamma * (Y.T @ direction)

    def joint_reference(self, sample):
        """Return dq_r and ddq_r of Slotine-Li: dx_r = dx_t - Psi e, ddx_r = ddx_t - Psi de, with ddx_t by (11)."""
        tip, x_t, dx_t = sample.tip, sample.x_t, sample.dx_t
        ddx_t = self.impedance_acceleration(x_t, dx_t, sample.virtual, sample.F)
        dq_r = np.linalg.solve(tip.J, dx_t - self.Psi * (tip.x - x_t))
        return dq_r, np.linalg.solve(tip.J, ddx_t - self.Psi * (tip.dx - dx_t) - tip.dJ @ dq_r)

    def impedance_acceleration(self, x, dx, virtual, F):
        """Return the acceleration of the target impedance (3): ddx_v - M^-1 [B (dx - dx_v) + K (x - x_v) + F]."""
        return virtual[2] - (self.B * (dx - virtual[1]) + self.K * (x - virtual[0]) + F) / self.M

    def augmented_error(self, sample):
        """Return de + Psi e, which is e* of (14) and s of (30), m/s and rad/s, shape (6,)."""
        return sample.tip.dx - sample.dx_t + self.Psi * (sample.tip.x - sample.x_t)

    def model_torque(self, p_hat, q, dq, v, a):
        """Return H a + C(q, dq) v + g + f(dq) of the arm with a payload p_hat, N.m, shape (6,)."""
        holding = hold(self.model, p_hat)
        data, rest = holding.createData(), np.zeros(JOINTS)
        inertial = pin.rnea(holding, data, q, rest, a).copy()
        both = [pin.rnea(holding, data, q, u, rest).copy() for u in (dq + v, dq - v)]
        return inertial + (both[0] - both[1]) / 4.0 + friction(dq, self.viscous, self.coulomb, self.setup)

    def inertia(self, p_hat, q):
        """Return H of the arm with a payload p_hat, kg.m2, shape (6, 6)."""
        holding = hold(self.model, p_hat)
        upper = np.triu(pin.crba(holding, holding.createData(), q))
        return upper + np.triu(upper, 1).T

    def regressor(self, q, dq, v, a):
        """Return the ten columns of the payload in Y(q, dq, v, a), shape (6, 10)."""
        rest = np.zeros(JOINTS)

        def columns(rate, acceleration):
            return pin.computeJointTorqueRegressor(self.model, self.data, q, rate, acceleration)[:, LAST].copy()

        return (columns(rest, a) + (columns(dq + v, rest) - columns(dq - v, rest)) / 4.0) @ MOVED


def turning_axes(phi):
    """Return E of angles rad, shape (3, 3): w = E dphi."""
    _, pitch, yaw = phi
    about_y, about_z = (Rotation.from_euler(axis, angle).as_matrix() for axis, angle in (("y", pitch), ("z", yaw)))
    return np.stack([about_z @ about_y[:, 0], about_z[:, 1], np.array([0.0, 0.0, 1.0])], axis=1)


def turning_axes_rate(E, dphi):
    """Return dE/dt, 1/s, shape (3, 3): yaw and pitch carry roll's axis, yaw carries pitch's, nothing carries yaw's."""
    by_yaw = dphi[2] * E[:, 2]
    by_both = by_yaw + dphi[1] * E[:, 1]
    return np.stack([pin.skew(by_both) @ E[:, 0], pin.skew(by_yaw) @ E[:, 1], np.zeros(3)], axis=1)


def friction(dq, viscous, coulomb, setup):
    """Return the friction torque of the joints, N.m, shape (6,)."""
    return viscous * dq + coulomb * np.tanh(dq / setup.coulomb_velocity)
