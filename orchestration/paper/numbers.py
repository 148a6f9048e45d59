"""The numbers of the paper, each once: what section V states, and what it leaves open and is assumed here.

Behind each number stands ``V`` for one stated in section V, else that it is assumed. The reasons stand beside
the values in `orchestration.paper.scenarios`. What the FMUs start with, the arm and its ellipse, they hold
themselves (`fmus.start`) and is read from there.
"""

from fmus import start

# The arm, its wall and its way.
ARM = start.ARMS[2]
TRUE_MASSES = ARM.masses  # kg, V
TRUE_M2 = TRUE_MASSES[1]  # kg, V
WRONG_M2 = 2.5  # kg, V
SEMI_AXIS = start.SEMI_AXIS  # m, V
PERIOD = start.PERIOD  # s, V
TIP_START = start.X_V  # m, V: where the tip begins and ends
WALL_NORMAL = start.WALL_NORMAL  # assumed
WALL_OFFSET = start.WALL_OFFSET  # m, assumed
WALL_STIFFNESS = 1e5  # N/m, V
DEPTH = 0.01  # m, assumed

# The impedance, V.
TARGET_INERTIA = 2.0  # kg
TARGET_STIFFNESS = 4000.0  # N/m
ADAPTIVE_DAMPING = 340.0  # N.s/m, of Figs. 5 to 7
LARGEST_PSI = ADAPTIVE_DAMPING / TARGET_INERTIA  # 1/s, III-C: algorithm 1 needs a smaller Psi

# Sampling, assumed.
CONVENTIONAL_STEP = 1e-4  # s, of Figs. 2 to 4
ADAPTIVE_STEP = 2e-5  # s, of Figs. 5 to 7

# Figs. 5 to 7, assumed: one set of values for all three, chosen as docs/calibration.md says.
SEED = 1
PSI = 100.0  # 1/s
GAMMA_CRAIG = 5.0  # kg2.s2/m2
GAMMA_SLOTINE_LI = 4.0  # kg.s2/m2
K_D = 100.0  # N.s/m
GAMMA_MARGIN, GAMMA_EPS = 1.5, 1e-4  # 1 and m/s

# Computed by `python -m orchestration.paper.calibrate`: 15 % of the peak |F_ext| of fig5 without
# noise, and 75 % of each joint's largest |tau_cmd| of fig5.
NOISE_SHARE, TORQUE_SHARE = 0.15, 0.75  # V
NOISE_BOUND = 91.12  # N
TORQUE_LIMITS = (533.61, 306.83)  # N.m
NO_TORQUE_LIMIT = 1e9  # N.m, which switches an actuator's limit off
