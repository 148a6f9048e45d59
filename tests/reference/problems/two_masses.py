"""Two masses on springs between two walls: the mechanics that several problems cut into FMUs in different ways.

    m1 x1'' = -k1 x1 - d1 x1' + F            F = k_c (x2 - x1) + d_c (x2' - x1')
    m2 x2'' = -k2 x2 - d2 x2' - F

F acts on mass 1, -F on mass 2. This has been the test model of co-simulation since M. Busch, "Zur effizienten Kopplung
von Simulationsprogrammen" (Kassel, 2012). The default is undamped, with the energy

    E = (m1 x1'^2 + m2 x2'^2 + k1 x1^2 + k2 x2^2 + k_c (x2 - x1)^2) / 2
"""

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, ContinuousModel
from tests.reference.problems.problem import Columns, free_motion

# Runge-Kutta 4 misses a mode of w rad/s by (w dt)^4 / 120 of a radian per radian: 1e-10 at 10 rad/s.
DT_MAX = 1e-3  # s
SPAN = (1.0, 5e-3)  # s, see `Problem`: the faster mode has w^2 = 36.6/s^2, so 7e-3 s would do

Force = Callable[[ca.SX, ca.SX], ca.SX]  # N, of the own mass's position and velocity


@dataclass(frozen=True)
class Numbers:
    """Numbers of the two masses: masses kg, stiffnesses N/m, dampings N.s/m, starts m and m/s."""

    m1: float = 1.0
    m2: float = 2.0
    k1: float = 10.0
    k2: float = 5.0
    k_c: float = 20.0
    d1: float = 0.0
    d2: float = 0.0
    d_c: float = 0.0
    x1: float = 0.1
    x2: float = -0.05
    v1: float = 0.0
    v2: float = 0.2

    @property
    def matrix(self) -> np.ndarray:
        """A of z' = A z, z = (x1, v1, x2, v2), shape (4, 4)."""
        k, d = self.k_c, self.d_c
        acceleration_1 = np.array([-self.k1 - k, -self.d1 - d, k, d]) / self.m1
        acceleration_2 = np.array([k, d, -self.k2 - k, -self.d2 - d]) / self.m2
        return np.array([[0, 1, 0, 0], acceleration_1, [0, 0, 0, 1], acceleration_2])

    @property
    def start(self) -> tuple[float, float, float, float]:
        """The state z at t = 0."""
        return self.x1, self.v1, self.x2, self.v2


def motion(t: np.ndarray, n: Numbers) -> dict[str, np.ndarray]:
    """Return the exact motion at times t, s: ``left`` is mass 1, ``right`` mass 2, ``right.F`` the force on mass 1."""
    x1, v1, x2, v2 = free_motion(n.matrix, n.start, t)
    F = n.k_c * (x2 - x1) + n.d_c * (v2 - v1)
    return {"left.x": x1, "left.v": v1, "right.x": x2, "right.v": v2, "right.F": F}


def energy(columns: Columns, **numbers: float) -> np.ndarray:
    """Return the kinetic energy plus the energy of the three springs, J."""
    n = Numbers(**numbers)
    x1, v1 = columns["left.x"], columns["left.v"]
    x2, v2 = columns["right.x"], columns["right.v"]
    kinetic = n.m1 * v1**2 + n.m2 * v2**2
    return 0.5 * (kinetic + n.k1 * x1**2 + n.k2 * x2**2 + n.k_c * (x2 - x1) ** 2)


def mass_on_spring(model: ContinuousModel, force: Force) -> ca.SX:
    """Declare m x'' = -k x - d x' + force(x, v) with its parameters and the outputs x and v; return the force, N."""
    m = model.parameter("m", 1.0, unit="kg", limits=POSITIVE, description="Mass")
    k = model.parameter("k", 0.0, unit="N/m", limits=NOT_NEGATIVE, description="Stiffness of its own spring")
    d = model.parameter("d", 0.0, unit="N.s/m", limits=NOT_NEGATIVE, description="Damping of its own damper")
    x = model.state("x", model.parameter("x_start", 0.0, unit="m", description="Position at the start"))
    v = model.state("v", model.parameter("v_start", 0.0, unit="m/s", description="Velocity at the start"))
    F = force(x, v)
    model.derivative(x, v)
    model.derivative(v, (F - k * x - d * v) / m)
    model.output("x", x, unit="m", description="Position", scalar=True)
    model.output("v", v, unit="m/s", description="Velocity", scalar=True)
    return F


def coupling(model: ContinuousModel, other: str) -> Force:
    """Declare the coupling spring with its inputs; return its force on the own mass as a function of (x, v)."""
    k_c = model.parameter("k_c", 0.0, unit="N/m", limits=NOT_NEGATIVE, description="Stiffness of the coupling")
    d_c = model.parameter("d_c", 0.0, unit="N.s/m", limits=NOT_NEGATIVE, description="Damping of the coupling")
    x = model.input(f"x_{other}", 0.0, unit="m", description="Position of the other mass")
    v = model.input(f"v_{other}", 0.0, unit="m/s", description="Velocity of the other mass")
    return lambda own_x, own_v: k_c * (x - own_x) + d_c * (v - own_v)


def left_start(n: Numbers) -> dict[str, float]:
    """Return the start values of mass 1."""
    return {"m": n.m1, "k": n.k1, "d": n.d1, "x_start": n.x1, "v_start": n.v1}


def right_start(n: Numbers) -> dict[str, float]:
    """Return the start values of mass 2."""
    return {"m": n.m2, "k": n.k2, "d": n.d2, "x_start": n.x2, "v_start": n.v2}
