"""The numbers of the runs with the PUMA 560, each once, and the rules by which they follow from the paper's arm.

The rules were fixed before the claims were measured:

- What section V states carries over as it is: the masses of the payload that is there and of the one that the
  controller believes, the stiffness of the environment, the time of a turn, and the shares of noise and torque.
- The paper's time constants carry over: K/M, B/M, Psi, and K_d/M of the calibration ``section-v``.
- M is close to the inertia that the arm shows at its tip, as the paper's is. Angles are as positions, turned into
  lengths by L (docs/decisions/019-lengths-of-positions-and-angles.md).
- The wall cuts off the same share of the ellipse, and K depth is the force of the paper's runs, some 60 N.
- Gamma lets the estimate of the mass settle as fast as in the plane. Gamma of a first moment has the factor l^2, and
  that of a moment of inertia l^4, where l is a length of the payload: errors count by their sizes m l and m l^2.
"""

import math

from fmus import start
from orchestration.paper.calibrations import CHOSEN_CALIBRATION
from orchestration.paper.numbers import (
    ADAPTIVE_DAMPING,
    PERIOD,
    SEMI_AXIS,
    TARGET_INERTIA,
    TARGET_STIFFNESS,
    TRUE_M2,
    WRONG_M2,
)

_CHOSEN = CHOSEN_CALIBRATION.values

JOINTS = 6
POSITIONS = 3  # of the six task coordinates; the others are angles
LENGTH = 0.15  # m, L: turns angles into lengths
TEN = 10  # parameters of a body
FIRST_OF_PAYLOAD = 13 * JOINTS + 1  # number of the payload's mass among the elements of p

# The payload: a body whose mass is the paper's m2, assumed elsewhere.
TRUE_PAYLOAD, BELIEVED_PAYLOAD = TRUE_M2, WRONG_M2  # kg, V
PAYLOAD_CENTER = (0.02, 0.0, -0.05)  # m, in the frame of the tip: beside and behind it
PAYLOAD_INERTIA = (2e-3, 0.0, 2e-3, 0.0, 0.0, 1e-3)  # kg.m2 about its centre: 11, 12, 22, 13, 23, 33
PAYLOAD_LENGTH = 0.1  # m, l: how far its parts are from the tip

# The table and the way of the tip, assumed.
TABLE_NORMAL = (0.0, 0.0, -1.0)
TABLE_OFFSET = 0.044  # m below the base: cuts off the ellipse where the paper's wall does
ELLIPSE = (0.15, 0.2)  # m
ELLIPSE_CENTER = (0.5, 0.15, 0.1)  # m
Q_START = (-0.000200006, -1.4145161888, 3.0933945381, 0.0, 1.4627143043, -0.000200006)  # rad, tip on the ellipse
DQ_START = (-1.2567124664, -0.4377172924, 0.505694161, 0.0, -0.0679768686, -1.2567124664)  # rad/s, moving with it
DEPTH = 4e-3  # m: K depth = 64 N, 60 N in the plane
TILT = (0.2, -0.15, 0.3)  # rad, by which the tool has turned at the table: 11, 9 and 17 deg

# The impedance.
INERTIA = 8.0  # kg: the arm shows 4 to 10 kg along the way
ANGULAR_INERTIA = INERTIA * LENGTH**2  # kg.m2, 0.18; the arm shows 0.14 to 0.41 kg.m2
STIFFNESS_RATE = TARGET_STIFFNESS / TARGET_INERTIA  # 1/s2, V: K/M
DAMPING_RATE = ADAPTIVE_DAMPING / TARGET_INERTIA  # 1/s, V: B/M

# Sampling and noise.
STEP = 5e-5  # s
NOISE_HOLD = 1e-4  # s
NOISE_BOUND = 23.25  # N, 15 % of the largest |F_ext| of puma-craig without noise
TORQUE_LIMITS = (22.75, 129.81, 36.94, 7.81, 7.78, 7.43)  # N.m, 75 % of the largest commands in puma-craig
EFFORT = (97.6, 186.4, 89.4, 24.2, 20.1, 21.3)
"""Largest torques of the motors of the PUMA 560, N.m: Armstrong, Khatib and Burdick (1986), table of the motors."""

# The gains of both algorithms.
_LIFTED = SEMI_AXIS[0] * (2 * math.pi / PERIOD) ** 2 / 9.81  # the paper's largest acceleration over that of gravity
_HEAVIER = INERTIA / TARGET_INERTIA
PSI_1, PSI_2 = _CHOSEN["Psi_1"], _CHOSEN["Psi_2"]  # 1/s
GAMMA_1 = round(_CHOSEN["Gamma_1"] * (_LIFTED * _HEAVIER) ** 2)  # the estimate settles at Gamma |W/H_x|^2 psi/k
GAMMA_2 = round(_CHOSEN["Gamma_2"] * _LIFTED**2 * _HEAVIER)  # and here at Gamma W^2/K_d
K_D = _CHOSEN["K_d"] * _HEAVIER  # N.s/m
GAMMA_MARGIN, GAMMA_EPS = _CHOSEN["gamma_margin"], _CHOSEN["gamma_eps"]
ACC_FILTER_TIME = _CHOSEN["acc_filter_time"]  # s

COULOMB_VELOCITY = start.COULOMB_VELOCITY  # rad/s


def by_coordinate(length: float, angle: float) -> tuple[float, ...]:
    """A number for each of the six task coordinates: one for positions and one for angles."""
    return (length,) * POSITIONS + (angle,) * (JOINTS - POSITIONS)


def payload_gains(of_mass: float) -> tuple[float, ...]:
    """Gamma of the payload's ten parameters, from that of its mass."""
    of_moment = of_mass * PAYLOAD_LENGTH**2
    return (of_mass, *((of_moment,) * 3), *((of_moment * PAYLOAD_LENGTH**2,) * 6))


def payload_parameters() -> tuple[float, ...]:
    """The payload's ten parameters in the frame of the tip: m, kg, m c, kg.m, and I about the tip, kg.m2."""
    m, (x, y, z) = TRUE_PAYLOAD, PAYLOAD_CENTER
    steiner = (y * y + z * z, -x * y, x * x + z * z, -x * z, -y * z, x * x + y * y)
    about_tip = (own + m * more for own, more in zip(PAYLOAD_INERTIA, steiner, strict=True))
    return (m, m * x, m * y, m * z, *about_tip)
