"""Closed-form model of a planar arm with two joints and point masses at the ends of its links, and of a wall.

    H(q) ddq + C(q, dq) dq + g(q) + f(dq) = tau - J' F_ext                                                    (1)

Lu and Meng (1991), eqs. (1)-(2). Angles are relative (the absolute angle of link 2 is q1 + q2), gravity acts along
-x2, f(dq) = viscous dq + coulomb tanh(dq / coulomb_velocity). ``F_ext`` is the force of the tip ON the environment;
the wall normal ``n`` points INTO the wall and ``gap = n.x - offset`` is positive in penetration.

Everything here is written from these formulas, without code generation. So this module can be an oracle for models that
are derived symbolically.
"""

from math import cos, sin, tanh
from typing import NamedTuple

import numpy as np

from .compiled import compiled


class Arm(NamedTuple):
    """Known numbers of the arm: link lengths `l1`, `l2` (m), `gravity` (m/s2), `coulomb_velocity` (rad/s)."""

    l1: float
    l2: float
    gravity: float
    coulomb_velocity: float


class Wall(NamedTuple):
    """Wall as a half-plane: normal (`n1`, `n2`) of length 1, `offset` (m), and the numbers of the contact law.

    `K_f` (N/m) is the stiffness, `D_f` (s/m) the damping, `mu` the friction, `friction_velocity` (m/s) its smoothing.
    """

    n1: float
    n2: float
    offset: float
    K_f: float
    D_f: float
    mu: float
    friction_velocity: float


class Plant(NamedTuple):
    """An arm, its parameters p = (m1, m2, viscous1, viscous2, coulomb1, coulomb2) in SI units, and a wall."""

    arm: Arm
    p: np.ndarray
    wall: Wall


@compiled
def acceleration(plant, q, dq, tau, F):
    """Solve the equation of motion (1) for the joint acceleration.

    Parameters
    ----------
    plant : Plant
    q, dq, tau : ndarray, shape (2,)
        Joint angles (rad), rates (rad/s) and torques (N.m).
    F : tuple of 2 floats
        Force of the tip on the environment (N).

    Returns
    -------
    tuple of 2 floats
        ddq (rad/s2).
    """
    arm, p = plant.arm, plant.p
    h11, h12, h22 = inertia_entries(arm, p, q[1])
    g1, g2 = gravity_torque(arm, p, q)
    f1, f2 = friction_torque(arm, p, dq)
    j11, j12, j21, j22 = jacobian_entries(arm, q)
    c = p[1] * arm.l1 * arm.l2 * sin(q[1])
    r1 = tau[0] + c * dq[1] * (2.0 * dq[0] + dq[1]) - g1 - f1 - (j11 * F[0] + j21 * F[1])
    r2 = tau[1] - c * dq[0] * dq[0] - g2 - f2 - (j12 * F[0] + j22 * F[1])
    det = h11 * h22 - h12 * h12
    return (h22 * r1 - h12 * r2) / det, (h11 * r2 - h12 * r1) / det


@compiled
def contact_force(wall, gap, dx1, dx2):
    """Return the force on a loaded wall: K_f gap (1 + D_f gap_rate) along the normal, and friction along the sliding.

    The caller must know that the wall is loaded (gap > 0 and 1 + D_f gap_rate > 0). The law is smooth in its arguments.

    Returns
    -------
    tuple of 2 floats
        Force of the tip on the wall (N).
    """
    normal = wall.K_f * gap * (1.0 + wall.D_f * (wall.n1 * dx1 + wall.n2 * dx2))
    sliding = -wall.n2 * dx1 + wall.n1 * dx2
    tangential = wall.mu * normal * tanh(sliding / wall.friction_velocity)
    return normal * wall.n1 - tangential * wall.n2, normal * wall.n2 + tangential * wall.n1


@compiled
def external_force(plant, q, dq):
    """Return F_ext at a state (tuple of 2 floats, N), with the unilateral law max(gap, 0) max(0, 1 + D_f gap_rate)."""
    wall = plant.wall
    dx1, dx2 = tip_velocity(plant.arm, q, dq)
    gap = wall_gap(plant, q)
    if gap <= 0.0 or 1.0 + wall.D_f * (wall.n1 * dx1 + wall.n2 * dx2) <= 0.0:
        return 0.0, 0.0
    return contact_force(wall, gap, dx1, dx2)


@compiled
def wall_gap(plant, q):
    """Return the signed distance n.x - offset (m) of the tip, which is positive inside the wall."""
    x1, x2 = tip_position(plant.arm, q)
    return plant.wall.n1 * x1 + plant.wall.n2 * x2 - plant.wall.offset


@compiled
def tip_position(arm, q):
    """Return the position of the tip (tuple of 2 floats, m)."""
    s = q[0] + q[1]
    return arm.l1 * cos(q[0]) + arm.l2 * cos(s), arm.l1 * sin(q[0]) + arm.l2 * sin(s)


@compiled
def tip_velocity(arm, q, dq):
    """Return the velocity J dq of the tip (tuple of 2 floats, m/s)."""
    j11, j12, j21, j22 = jacobian_entries(arm, q)
    return j11 * dq[0] + j12 * dq[1], j21 * dq[0] + j22 * dq[1]


@compiled
def jacobian_entries(arm, q):
    """Return the entries J11, J12, J21, J22 of the Jacobian of the tip (m/rad)."""
    s = q[0] + q[1]
    a1, a2 = arm.l2 * cos(s), arm.l2 * sin(s)
    return -arm.l1 * sin(q[0]) - a2, -a2, arm.l1 * cos(q[0]) + a1, a1


@compiled
def jacobian(arm, q):
    """Return the Jacobian J of the tip, shape (2, 2) (m/rad), with dx = J dq."""
    j11, j12, j21, j22 = jacobian_entries(arm, q)
    return np.array([[j11, j12], [j21, j22]])


@compiled
def jacobian_rate(arm, q, dq):
    """Return the rate dJ/dt of the Jacobian, shape (2, 2) (m/(rad s))."""
    s, ds = q[0] + q[1], dq[0] + dq[1]
    a1, a2 = -arm.l2 * cos(s) * ds, -arm.l2 * sin(s) * ds
    b1, b2 = -arm.l1 * cos(q[0]) * dq[0], -arm.l1 * sin(q[0]) * dq[0]
    return np.array([[a1 + b1, a1], [a2 + b2, a2]])


@compiled
def inertia_entries(arm, p, q2):
    """Return the entries H11, H12, H22 of the inertia matrix (kg m2)."""
    coupling = p[1] * arm.l1 * arm.l2 * cos(q2)
    h22 = p[1] * arm.l2**2
    return (p[0] + p[1]) * arm.l1**2 + h22 + 2.0 * coupling, h22 + coupling, h22


@compiled
def inertia(arm, p, q):
    """Return the inertia matrix H, shape (2, 2) (kg m2)."""
    h11, h12, h22 = inertia_entries(arm, p, q[1])
    return np.array([[h11, h12], [h12, h22]])


@compiled
def coriolis(arm, p, q, dq):
    """Return the Coriolis matrix C, shape (2, 2) (N.m.s), in the form for which dH/dt - 2 C is skew-symmetric."""
    c = p[1] * arm.l1 * arm.l2 * sin(q[1])
    return np.array([[-c * dq[1], -c * (dq[0] + dq[1])], [c * dq[0], 0.0]])


@compiled
def gravity_torque(arm, p, q):
    """Return the gravity torque g(q) (tuple of 2 floats, N.m), the gradient of the potential energy."""
    g2 = p[1] * arm.gravity * arm.l2 * cos(q[0] + q[1])
    return (p[0] + p[1]) * arm.gravity * arm.l1 * cos(q[0]) + g2, g2


@compiled
def friction_torque(arm, p, dq):
    """Return the joint friction f(dq) (tuple of 2 floats, N.m): viscous plus smoothed Coulomb friction."""
    f1 = p[2] * dq[0] + p[4] * tanh(dq[0] / arm.coulomb_velocity)
    f2 = p[3] * dq[1] + p[5] * tanh(dq[1] / arm.coulomb_velocity)
    return f1, f2


@compiled
def regressor(arm, q, dq, v, a):
    """Return the joint regressor Y(q, dq, v, a), with Y p = H(q) a + C(q, dq) v + g(q) + f(dq).

    Parameters
    ----------
    arm : Arm
    q, dq : ndarray, shape (2,)
        Joint angles (rad) and rates (rad/s). Friction is taken at dq.
    v, a : ndarray, shape (2,)
        Velocity that C multiplies (rad/s), and acceleration that H multiplies (rad/s2).

    Returns
    -------
    ndarray, shape (2, 6)
        Columns in the order m1, m2, viscous1, viscous2, coulomb1, coulomb2.
    """
    l1, l2 = arm.l1, arm.l2
    k, c = l1 * l2 * cos(q[1]), l1 * l2 * sin(q[1])
    g1, g12 = arm.gravity * l1 * cos(q[0]), arm.gravity * l2 * cos(q[0] + q[1])
    Y = np.zeros((2, 6))
    Y[0, 0] = l1 * l1 * a[0] + g1
    Y[0, 1] = (l1 * l1 + l2 * l2 + 2.0 * k) * a[0] + (l2 * l2 + k) * a[1] + g1 + g12
    Y[0, 1] -= c * (dq[1] * v[0] + (dq[0] + dq[1]) * v[1])
    Y[1, 1] = (l2 * l2 + k) * a[0] + l2 * l2 * a[1] + c * dq[0] * v[0] + g12
    for i in range(2):
        Y[i, 2 + i] = dq[i]
        Y[i, 4 + i] = tanh(dq[i] / arm.coulomb_velocity)
    return Y
