"""Two masses, coupled by force and displacement: mass 1 receives the force; mass 2, with the spring, the motion.

    left:   m1 x1'' = -k1 x1 - d1 x1' + F                            in: F             out: x, v
    right:  m2 x2'' = -k2 x2 - d2 x2' - F                            in: x_left, v_left  out: x, v, F
            F = k_c (x2 - x_left) + d_c (x2' - v_left)

right.F has direct feedthrough. The outputs of left do not, so there is no algebraic loop. The order is left, right.

With the inputs of right held, a step is linear in (x1, v1, x2, v2, F), where F is the output of right: `step_map`. For
small h and d_c = 0 the held force on mass 1 belongs, on average, to an x1 that is older by g h and to an x2 that is
older by h/2. The held position in right is older by e h. With Gauss-Seidel, right starts from x1 at the end of the
step, so e = -1/2 and g = 1/2. With Jacobi, e = 1/2 and g = 3/2. The energy of `two_masses` then grows by

    dE/dt = h k_c (g v1^2 - v1 v2 / 2) - h k_c e v1 v2

that is h k_c v1^2 / 2 for Gauss-Seidel, h k_c (3/2 v1^2 - v1 v2) for Jacobi: `energy_drift`.
"""

import casadi as ca
import numpy as np

from adaptimp_fmu import ContinuousModel
from orchestration.system.system import System
from tests.reference.problems.problem import Part, Problem, assemble, held
from tests.reference.problems.two_masses import (
    DT_MAX,
    SPAN,
    Numbers,
    coupling,
    energy,
    left_start,
    mass_on_spring,
    motion,
    right_start,
)

WIRES = [("right", "F", "left", "F"), ("left", "x", "right", "x_left"), ("left", "v", "right", "v_left")]


def pushed_mass() -> ContinuousModel:
    """Declare a mass on its own spring, pushed by a force."""
    model = ContinuousModel("PushedMass", "Mass on a spring, pushed by a force", dt_max=DT_MAX)
    F = model.input("F", 0.0, unit="N", description="Force on the mass")
    mass_on_spring(model, lambda _x, _v: F)
    return model


def pulling_mass() -> ContinuousModel:
    """Declare a mass on its own spring, with the coupling spring to another mass."""
    model = ContinuousModel("PullingMass", "Mass with a coupling spring to a moving end", dt_max=DT_MAX)
    pull: ca.SX = mass_on_spring(model, coupling(model, "left"))
    model.output("F", -pull, unit="N", description="Force on the other mass", scalar=True)
    return model


def system(step: float, stop_time: float, **numbers: float) -> System:
    """Return the coupled system; step and stop time in s, `Numbers` by name."""
    n = Numbers(**numbers)
    parts = {
        "left": Part(pushed_mass, left_start(n)),
        "right": Part(pulling_mass, right_start(n) | {"k_c": n.k_c, "d_c": n.d_c}),
    }
    return assemble("force-displacement", parts, WIRES, step, stop_time)


def exact(t: np.ndarray, **numbers: float) -> dict[str, np.ndarray]:
    """Return all outputs of the monolithic system at the times t, s."""
    return motion(t, Numbers(**numbers))


def step_map(algorithm: str, h: float, **numbers: float) -> np.ndarray:
    """Return the map of (x1, v1, x2, v2, right.F) over a step h, s, shape (5, 5), with exactly integrated components.

    `algorithm` is "gauss-seidel", in the order left, right, or "jacobi".
    """
    n = Numbers(**numbers)
    own_1 = np.array([[0, 1], [-n.k1 / n.m1, -n.d1 / n.m1]])
    own_2 = np.array([[0, 1], [-(n.k2 + n.k_c) / n.m2, -(n.d2 + n.d_c) / n.m2]])
    Phi_1, Gamma_1 = held(own_1, np.array([[0], [1 / n.m1]]), h)
    Phi_2, Gamma_2 = held(own_2, np.array([[0, 0], [n.k_c / n.m2, n.d_c / n.m2]]), h)
    K = np.array([[n.k_c, n.d_c]])
    new_1 = np.hstack([Phi_1, np.zeros((2, 2)), Gamma_1])
    seen = {"gauss-seidel": new_1, "jacobi": np.eye(2, 5)}[algorithm]  # (x1, v1) that right is given
    new_2 = Gamma_2 @ seen
    new_2[:, 2:4] += Phi_2
    return np.vstack([new_1, new_2, K @ (new_2 - seen)])


def energy_drift(algorithm: str, h: float, t: np.ndarray, **numbers: float) -> float:
    """Return the energy, J, that the undamped system gains over equidistant times t, s, to first order in h."""
    n, z = Numbers(**numbers), exact(t, **numbers)
    v1, v2 = z["left.v"], z["right.v"]
    power = {"gauss-seidel": v1**2 / 2, "jacobi": 1.5 * v1**2 - v1 * v2}[algorithm]
    return float(np.trapezoid(h * n.k_c * power, t))


PROBLEM = Problem("force-displacement", system, exact, SPAN, (("right.F", "left.v"),), energy)
