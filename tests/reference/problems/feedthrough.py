"""A linear feedback loop of two components with direct feedthrough: an algebraic loop where d g != 0.

    plant:  x' = a x + b u,  y = c x + d u           gain:  y = g u + r

Closed, u = (g c x + r) / (1 - d g) and x' = A x + B with A = a + b g c / (1 - d g), B = b r / (1 - d g).
Each repetition of the loop multiplies the error by d g. So repetition settles for |d g| < 1 (`CONTRACTING`) and
diverges for |d g| > 1 (`EXPANDING`). The loop is linear, so Newton's method needs one step. With d = 0, the default,
there is no algebraic loop. Both components show the left limit at a communication point: y from the input that was held
over the step. The order is plant, gain.
"""

from dataclasses import dataclass

import numpy as np

from adaptimp_fmu import ContinuousModel
from orchestration.system.system import System
from tests.reference.problems.problem import Part, Problem, assemble

DT_MAX = 1e-3  # s; a = -1/s with u held: Runge-Kutta 4 errs by 1e-15 / 120 of x in a step
CONTRACTING = {"d": 0.25, "g": -2.0}  # d g = -1/2
EXPANDING = {"d": 1.5, "g": -2.0}  # d g = -3
SPAN = (2.0, 1e-2)  # s, see `Problem`: a real mode of 3/s with e = b g c = 2/s, so y = 6 tau T / s^2 asks for 1.1e-2 s
WIRES = [("gain", "y", "plant", "u"), ("plant", "y", "gain", "u")]


@dataclass(frozen=True)
class Numbers:
    """Coefficients of the loop: a and b in 1/s, the others dimensionless; x is the state at the start."""

    a: float = -1.0
    b: float = 1.0
    c: float = 1.0
    d: float = 0.0
    g: float = -2.0
    r: float = 1.0
    x: float = 1.0


def plant() -> ContinuousModel:
    """Declare a first-order linear system with direct feedthrough."""
    model = ContinuousModel("FirstOrder", "First-order linear system with feedthrough", dt_max=DT_MAX)
    a = model.parameter("a", -1.0, unit="1/s", description="Rate of the state")
    b = model.parameter("b", 1.0, unit="1/s", description="Gain from the input to the state's rate")
    c = model.parameter("c", 1.0, description="Gain from the state to the output")
    d = model.parameter("d", 0.0, description="Gain from the input to the output")
    u = model.input("u", 0.0, description="Input")
    x = model.state("x", model.parameter("x_start", 0.0, description="State at the start"))
    model.derivative(x, a * x + b * u)
    model.output("x", x, description="State", scalar=True)
    model.output("y", c * x + d * u, description="Output", scalar=True)
    return model


def gain() -> ContinuousModel:
    """Declare a static gain with an offset, without a state."""
    model = ContinuousModel("StaticGain", "Static gain with an offset", dt_max=DT_MAX)
    g = model.parameter("g", 1.0, description="Gain")
    r = model.parameter("r", 0.0, description="Offset")
    u = model.input("u", 0.0, description="Input")
    model.output("y", g * u + r, description="Output", scalar=True)
    return model


def system(step: float, stop_time: float, **numbers: float) -> System:
    """Return the coupled system; step and stop time in s, `Numbers` by name."""
    n = Numbers(**numbers)
    parts = {
        "plant": Part(plant, {"a": n.a, "b": n.b, "c": n.c, "d": n.d, "x_start": n.x}),
        "gain": Part(gain, {"g": n.g, "r": n.r}),
    }
    return assemble("feedthrough", parts, WIRES, step, stop_time)


def exact(t: np.ndarray, **numbers: float) -> dict[str, np.ndarray]:
    """Return all outputs of the closed loop at the times t, s.

    Raises
    ------
    ValueError
        If d g = 1, where the algebraic loop has no solution.
    """
    n = Numbers(**numbers)
    if n.d * n.g == 1:
        msg = f"d g = {n.d:g} * {n.g:g} = 1: the algebraic loop has no solution."
        raise ValueError(msg)
    loop = 1 / (1 - n.d * n.g)
    A, B = n.a + n.b * n.g * n.c * loop, n.b * n.r * loop
    t = np.asarray(t, dtype=float)
    forced = B * (np.expm1(A * t) / A if A else t)
    x = np.exp(A * t) * n.x + forced
    u = (n.g * n.c * x + n.r) * loop
    return {"plant.x": x, "plant.y": n.c * x + n.d * u, "gain.y": u}


PROBLEM = Problem("feedthrough", system, exact, SPAN)
