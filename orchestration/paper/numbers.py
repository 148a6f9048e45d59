"""The numbers of the paper, each once: what section V states, and what it leaves open and is assumed here.

Behind each number stands ``V`` for one stated in section V, else that it is assumed. The reasons stand beside
the values in `orchestration.paper.scenarios`. Open values have the numbers of the chosen calibration
(`orchestration.paper.calibrations`). What the FMUs start with, the arm and its ellipse, they hold themselves
(`fmus.start`) and is read from there.
"""

from fmus import start
from orchestration.paper.calibrations import CHOSEN_CALIBRATION

# The arm, its wall and its way.
ARM = start.ARMS[2]
TRUE_MASSES = ARM.masses  # kg, V
TRUE_M2 = TRUE_MASSES[1]  # kg, V
WRONG_M2 = 2.5  # kg, V
SEMI_AXIS = start.SEMI_AXIS  # m, V
PERIOD = start.PERIOD  # s, V
TIP_START = start.X_V  # m, V: where the tip begins and ends
WALL_NORMAL = start.WALL_NORMAL  # assumed
WALL_OFFSET = CHOSEN_CALIBRATION.values["wall_offset"]  # m
WALL_STIFFNESS = 1e5  # N/m, V

# The impedance, V.
TARGET_INERTIA = 2.0  # kg
TARGET_STIFFNESS = 4000.0  # N/m
ADAPTIVE_DAMPING = 340.0  # N.s/m, of Figs. 5 to 7
LARGEST_PSI = ADAPTIVE_DAMPING / TARGET_INERTIA  # 1/s, III-C: algorithm 1 needs a smaller Psi

# Sampling, assumed.
CONVENTIONAL_STEP = 1e-4  # s, of Figs. 2 to 4

# Figs. 5 to 7.
SEED = 1  # assumed
NOISE_SHARE, TORQUE_SHARE = 0.15, 0.75  # V
NOISE_BOUND = CHOSEN_CALIBRATION.noise_bound  # N
TORQUE_LIMITS = CHOSEN_CALIBRATION.torque_limits  # N.m
NO_TORQUE_LIMIT = 1e9  # N.m, which switches an actuator's limit off

# What the theory names and section V does not run, assumed.
FAILURES = {"dropout": (1, 0.05), "stuck": (2, 0.05), "spike": (3, 5e-3)}
"""Kind of a failure of the force sensor, as `fmus.sensor_failure` counts them, and its duration, s, by name."""
SPIKE_FORCE = 1e3  # N, along the wall's normal
PAYLOAD = TRUE_M2 / 2  # kg, beyond the wrist sensor
PAYLOAD_THRESHOLD = 20.0  # N, of a contact with a payload; its force in free motion is below 8 N

# Of this project.
N_STATES = 1000  # random states at which equations are compared
