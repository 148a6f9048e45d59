"""Start values shared by the units: the paper's arm at the start of its ellipse.

Inputs start where Plant and VirtualTrajectory are at t0, so that each FMU initialized alone shows
finite outputs (at q = 0 the arm is singular).
"""

import math

import casadi as ca
import numpy as np

from fmus.arm import PlanarArm

MASSES = (2.0, 1.0)  # kg, V: m1, and m2 with payload
LINK_LENGTHS = (1.0, 1.0)  # m, V
SEMI_AXIS = (1.5, 1.0)  # m, V
PERIOD = 2.0  # s, V: one turn in 0 <= t <= 2 s
WALL_NORMAL = (-1.0, 0.0)  # assumed: a vertical wall on the left
WALL_OFFSET = 1.45  # m, assumed
COULOMB_VELOCITY = 1e-2  # rad/s, assumed: smooths Coulomb friction at rest

# Tip at (1.5, 0) moving at (0, pi) m/s, elbow bent by q2 > 0: q2 = arccos(1.5^2/2 - 1), q1 = -q2/2.
JOINT_ANGLES = (-0.7227342478, 1.4454684956)  # rad
JOINT_RATES = (2.0943951024, 0.0)  # rad/s

X_V = (SEMI_AXIS[0], 0.0)  # m
DX_V = (0.0, SEMI_AXIS[1] * 2 * math.pi / PERIOD)  # m/s
DDX_V = (-SEMI_AXIS[0] * (2 * math.pi / PERIOD) ** 2, 0.0)  # m/s2


def joint_accelerations() -> tuple[float, ...]:
    """Accelerations of the paper's arm at the start without torque, rad/s2: -H^-1 C dq."""
    arm = PlanarArm(2)
    q, dq = ca.DM(JOINT_ANGLES), ca.DM(JOINT_RATES)
    H = np.array(arm.inertia(q, MASSES, LINK_LENGTHS))
    C = np.array(arm.coriolis(q, dq, MASSES, LINK_LENGTHS))
    return tuple(float(a) for a in np.linalg.solve(H, -C @ np.array(JOINT_RATES)))
