"""A free mass in one FMU and a compliant wall in another; positive x is into the wall.

    wall:   F = -k x - d v   where x > 0, or everywhere if `bilateral`; else 0     in: x, v   out: F, gap = -x
    mass:   m x'' = F                                                              in: F      out: x, v

With F held, x is a parabola. Runge-Kutta 4 integrates the mass exactly, whatever dt_max is, so the only error is that
of the coupling. The wall has direct feedthrough, the mass does not. The order is wall, mass. The order mass, wall gives
the same motion, because the wall has no memory. With q = k h^2 / m, a step of the bilateral, undamped system is

    Gauss-Seidel   F = -k x(t):       x+ = x + h v - q x / 2       v+ = v - (q / h) x
    Jacobi         F = -k x(t - h):   x+ = x + h v - q x_p / 2     v+ = v - (q / h) x_p     x_p+ = x

(row 0 shows F = -k x(0), so the first x_p is x(0)). The characteristic polynomials in z are

    Gauss-Seidel   (z - 1)^2 + q (z + 1) / 2            |z|^2 = 1 + q / 2
    Jacobi         z (z - 1)^2 + q (z + 1) / 2

With z = exp(s) the polynomials read 4 sinh(s/2)^2 = -q cosh(s/2) exp(-j s/2), where j is 1 and 3. So, to first orders,
s = +-i sqrt(q) + j q / 4. The amplitude grows in a step by k h^2 / (4 m) and by 3 k h^2 / (4 m), as under a delay of
h/2 and of 3h/2.

At a one-sided wall, a mass that comes from the gap with speed v0 bounces. Contact lasts half a period pi / w of the
damped spring, where w = sqrt(k/m - (d / 2 m)^2). The mass leaves with the speed v0 exp(-d pi / (2 m w)).
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from adaptimp_fmu import NOT_NEGATIVE, ContinuousModel, Type
from orchestration.system.system import System
from tests.reference.problems.force_displacement import pushed_mass
from tests.reference.problems.problem import Columns, Part, Problem, assemble, free_motion

BOUNCE = {"bilateral": False, "x": -0.05, "v": 1.0}  # a case of the one-sided wall
SPAN = (1.0, 2.5e-3)  # s, see `Problem`: w^2 = 100/s^2
WIRES = [("mass", "x", "wall", "x"), ("mass", "v", "wall", "v"), ("wall", "F", "mass", "F")]


@dataclass(frozen=True)
class Numbers:
    """Numbers of mass and wall: mass kg, stiffness N/m, damping N.s/m, starts m, m/s; a bilateral wall also pulls."""

    m: float = 1.0
    k: float = 100.0
    d: float = 0.0
    x: float = 0.1
    v: float = 0.0
    bilateral: float = True  # a truth value; numbers are handed on as floats

    @property
    def matrix(self) -> np.ndarray:
        """A of (x, v) in contact, shape (2, 2)."""
        return np.array([[0, 1], [-self.k / self.m, -self.d / self.m]])


def wall() -> ContinuousModel:
    """Declare the wall: a spring and a damper, without a state."""
    model = ContinuousModel("CompliantWall", "Spring and damper against a wall")
    k = model.parameter("k", 100.0, unit="N/m", limits=NOT_NEGATIVE, description="Stiffness of the wall")
    d = model.parameter("d", 0.0, unit="N.s/m", limits=NOT_NEGATIVE, description="Damping of the wall")
    bilateral = model.parameter("bilateral", True, type=Type.BOOLEAN, description="Whether the wall also pulls")
    x = model.input("x", 0.0, unit="m", description="Position of the mass, positive in the wall")
    v = model.input("v", 0.0, unit="m/s", description="Velocity of the mass")
    touching = ca.logic_or(bilateral, x > 0)
    model.output("F", ca.if_else(touching, -k * x - d * v, 0), unit="N", description="Force on the mass", scalar=True)
    model.output("gap", -x, unit="m", description="Distance from the wall", scalar=True)
    return model


def system(step: float, stop_time: float, **numbers: float) -> System:
    """Return the coupled system; step and stop time in s, `Numbers` by name."""
    n = Numbers(**numbers)
    parts = {
        "wall": Part(wall, {"k": n.k, "d": n.d, "bilateral": float(n.bilateral)}),
        "mass": Part(pushed_mass, {"m": n.m, "x_start": n.x, "v_start": n.v}),
    }
    return assemble("wall", parts, WIRES, step, stop_time)


def exact(t: np.ndarray, **numbers: float) -> dict[str, np.ndarray]:
    """Return all outputs at the times t, s; with a one-sided wall, through the bounce.

    Raises
    ------
    ValueError
        If the wall is one-sided and the mass does not come from the gap and bounce.
    """
    n, t = Numbers(**numbers), np.asarray(t, dtype=float)
    if n.bilateral:
        x, v = free_motion(n.matrix, [n.x, n.v], t)
        F = -n.k * x - n.d * v
    else:
        x, v, F = _bounce(n, t)
    return {"wall.F": F, "wall.gap": -x, "mass.x": x, "mass.v": v}


def energy(columns: Columns, **numbers: float) -> np.ndarray:
    """Return the kinetic energy plus the energy of the spring of the wall, J."""
    n = Numbers(**numbers)
    x, v = columns["mass.x"], columns["mass.v"]
    depth = x if n.bilateral else np.maximum(x, 0)
    return 0.5 * (n.m * v**2 + n.k * depth**2)


def step_map(algorithm: str, h: float, m: float, k: float) -> np.ndarray:
    """Return the map over a step h, s, of the bilateral, undamped system, derived by hand.

    Parameters
    ----------
    algorithm
        "gauss-seidel" or "jacobi".
    h
        Communication step, s.
    m, k
        Mass, kg, and stiffness, N/m.

    Returns
    -------
    ndarray
        Map of (x, v) for "gauss-seidel", shape (2, 2); map of (x, v, x_p) for "jacobi", shape (3, 3).

    Raises
    ------
    ValueError
        If the algorithm is another.
    """
    q = k * h**2 / m
    if algorithm == "gauss-seidel":
        return np.array([[1 - q / 2, h], [-q / h, 1]])
    if algorithm == "jacobi":
        return np.array([[1, h, -q / 2], [0, 1, -q / h], [1, 0, 0]])
    msg = f"There is no step map of {algorithm!r}; there are gauss-seidel and jacobi."
    raise ValueError(msg)


def growth(algorithm: str, h: float, m: float, k: float) -> float:
    """Return the factor by which the amplitude grows in a step h, s: the spectral radius of `step_map`."""
    return float(np.abs(np.linalg.eigvals(step_map(algorithm, h, m, k))).max())


def _bounce(n: Numbers, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return x, v and F of free flight, half a period of contact, and free flight again."""
    decay = n.d / (2 * n.m)
    squared = n.k / n.m - decay**2
    if n.x > 0 or n.v <= 0 or squared <= 0:
        msg = f"A bounce needs x <= 0 m, v > 0 m/s and an underdamped wall, not x = {n.x:g}, v = {n.v:g}, d = {n.d:g}."
        raise ValueError(msg)
    begin, contact = -n.x / n.v, np.pi / np.sqrt(squared)
    leaving = -n.v * np.exp(-decay * contact)
    inside = np.clip(t - begin, 0, contact)
    x, v = free_motion(n.matrix, [0, n.v], inside)
    before, after = t < begin, t > begin + contact
    F = np.where(before | after, 0, -n.k * x - n.d * v)
    x = np.where(before, n.x + n.v * t, np.where(after, leaving * (t - begin - contact), x))
    return x, np.where(after, leaving, v), F


PROBLEM = Problem("wall", system, exact, SPAN, (("wall.F", "mass.v"),), energy)
