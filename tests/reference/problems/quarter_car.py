"""A quarter car on a harmonic road, with an FMU for the body and another for the wheel.

    body:   m_s z_s'' = -F,  F = k_s (z_s - z_wheel) + c_s (z_s' - v_wheel)   in: z_wheel, v_wheel   out: z, v, F
    wheel:  m_u z_u'' = F - k_t (z_u - r(t))                                  in: F                  out: z, v, r
            r(t) = (R / 2) (1 - cos(w t))

F acts on the wheel, -F on the body. Upwards is positive, and lengths are counted from static equilibrium. The road
starts flat, r(0) = r'(0) = 0. The FMU of the wheel holds the road as a function of time, so the integration of the
wheel sees the road exactly. body.F has direct feedthrough, the outputs of the wheel do not. The order is wheel, body.
The numbers have the size of those in D. Hrovat, "Survey of advanced suspension developments and related optimal control
applications", Automatica 33(10), 1997.

The exact solution is exp(A t) of (z_s, v_s, z_u, v_u, cos(w t), sin(w t), 1).
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, ContinuousModel
from orchestration.system.system import System
from tests.reference.problems.problem import Part, Problem, assemble, free_motion

# The wheel hops at sqrt((k_s + k_t) / m_u) = 69 rad/s. At 1e-4 s Runge-Kutta 4 misses (w dt)^4 / 120 = 2e-11 of the
# phase.
DT_MAX = 1e-4  # s
# See `Problem`. The damper of the suspension moves the hop, 70 rad/s, by c_s / (2 m_u) = 14/s. So y = 14 70 tau T,
# which asks for 2.7e-4 s.
SPAN = (0.5, 2.5e-4)  # s
WIRES = [("body", "F", "wheel", "F"), ("wheel", "z", "body", "z_wheel"), ("wheel", "v", "body", "v_wheel")]


@dataclass(frozen=True)
class Numbers:
    """Numbers of the quarter car: masses kg, stiffnesses N/m, damping N.s/m, road m and rad/s, starts m and m/s."""

    m_s: float = 300.0
    m_u: float = 35.0
    k_s: float = 16e3
    c_s: float = 1e3
    k_t: float = 160e3
    R: float = 0.05
    w: float = 12.0
    z_s: float = 0.02
    v_s: float = 0.0
    z_u: float = 0.0
    v_u: float = 0.0

    @property
    def matrix(self) -> np.ndarray:
        """A of (z_s, v_s, z_u, v_u, cos(w t), sin(w t), 1), shape (7, 7)."""
        force = np.array([self.k_s, self.c_s, -self.k_s, -self.c_s, 0, 0, 0])
        tyre = self.k_t * np.array([0, 0, 1, 0, self.R / 2, 0, -self.R / 2])
        A = np.zeros((7, 7))
        A[0, 1] = A[2, 3] = 1
        A[1], A[3] = -force / self.m_s, (force - tyre) / self.m_u
        A[4, 5], A[5, 4] = -self.w, self.w
        return A


def body() -> ContinuousModel:
    """Declare the body: the sprung mass with its suspension."""
    model = ContinuousModel("CarBody", "Sprung mass with its suspension", dt_max=DT_MAX)
    m = model.parameter("m", 300.0, unit="kg", limits=POSITIVE, description="Sprung mass")
    k = model.parameter("k", 16e3, unit="N/m", limits=NOT_NEGATIVE, description="Stiffness of the suspension")
    c = model.parameter("c", 1e3, unit="N.s/m", limits=NOT_NEGATIVE, description="Damping of the suspension")
    z_wheel = model.input("z_wheel", 0.0, unit="m", description="Height of the wheel")
    v_wheel = model.input("v_wheel", 0.0, unit="m/s", description="Velocity of the wheel")
    z, v = _moving(model)
    F = k * (z - z_wheel) + c * (v - v_wheel)
    model.derivative(v, -F / m)
    model.output("F", F, unit="N", description="Force of the suspension on the wheel", scalar=True)
    return model


def wheel() -> ContinuousModel:
    """Declare the wheel: the unsprung mass with its tyre on the road."""
    model = ContinuousModel("CarWheel", "Unsprung mass with its tyre on a harmonic road", dt_max=DT_MAX)
    m = model.parameter("m", 35.0, unit="kg", limits=POSITIVE, description="Unsprung mass")
    k = model.parameter("k", 160e3, unit="N/m", limits=NOT_NEGATIVE, description="Stiffness of the tyre")
    R = model.parameter("R", 0.05, unit="m", limits=NOT_NEGATIVE, description="Height of the road's waves")
    w = model.parameter("w", 12.0, unit="rad/s", limits=NOT_NEGATIVE, description="Angular frequency of the road")
    F = model.input("F", 0.0, unit="N", description="Force on the wheel")
    z, v = _moving(model)
    r = 0.5 * R * (1 - ca.cos(w * model.time))
    model.derivative(v, (F - k * (z - r)) / m)
    model.output("r", r, unit="m", description="Height of the road", scalar=True)
    return model


def system(step: float, stop_time: float, **numbers: float) -> System:
    """Return the coupled system; step and stop time in s, `Numbers` by name."""
    n = Numbers(**numbers)
    on_road = {"m": n.m_u, "k": n.k_t, "R": n.R, "w": n.w, "z_start": n.z_u, "v_start": n.v_u}
    on_spring = {"m": n.m_s, "k": n.k_s, "c": n.c_s, "z_start": n.z_s, "v_start": n.v_s}
    parts = {"wheel": Part(wheel, on_road), "body": Part(body, on_spring)}
    return assemble("quarter car", parts, WIRES, step, stop_time)


def exact(t: np.ndarray, **numbers: float) -> dict[str, np.ndarray]:
    """Return all outputs of the monolithic system at the times t, s."""
    n = Numbers(**numbers)
    start = [n.z_s, n.v_s, n.z_u, n.v_u, 1, 0, 1]
    z_s, v_s, z_u, v_u, cosine, _, _ = free_motion(n.matrix, start, t)
    F = n.k_s * (z_s - z_u) + n.c_s * (v_s - v_u)
    r = 0.5 * n.R * (1 - cosine)
    return {"wheel.z": z_u, "wheel.v": v_u, "wheel.r": r, "body.z": z_s, "body.v": v_s, "body.F": F}


def _moving(model: ContinuousModel) -> tuple[ca.SX, ca.SX]:
    """Declare the states z and v with z' = v, and outputs of the same names."""
    z = model.state("z", model.parameter("z_start", 0.0, unit="m", description="Height at the start"))
    v = model.state("v", model.parameter("v_start", 0.0, unit="m/s", description="Velocity at the start"))
    model.derivative(z, v)
    model.output("z", z, unit="m", description="Height", scalar=True)
    model.output("v", v, unit="m/s", description="Velocity", scalar=True)
    return z, v


PROBLEM = Problem("quarter car", system, exact, SPAN, (("body.F", "wheel.v"),))
