"""A light mass on a spring and a heavy free mass, joined by a stiff damper; the FMUs of `force_displacement`.

    left:   m1 v1' = -k1 x1 + F              right:  m2 v2' = -F,   F = d_c (v2 - v1)

With q = d_c h / m1, E = exp(-d_c h / m2), and k1 = 0 (slow beside the damper), the closed forms of the components give

    v1+ = v1 + q F / d_c       v2+ = u + (v2 - u) E       F+ = d_c (v2+ - u)

where u = v1+ (Gauss-Seidel, order left, right) or v1 (Jacobi). One step thus multiplies w = v2 - v1 by (1 - q) E with
Gauss-Seidel, and the pair (w, F / d_c) by [E -q; E 0] with Jacobi. With m2 = 10 m1 Gauss-Seidel is stable for
q < 2.25, and again for q > 35.4. There the heavy mass takes the velocity of the light mass within h, and the force that
is left to show is zero: the coupling is stable and wrong. Jacobi is stable for q < 1.12 and q > 35.8. `step_map`
includes the spring.
"""

import numpy as np

from orchestration.system.system import System
from tests.reference.problems import force_displacement
from tests.reference.problems.problem import Problem
from tests.reference.problems.two_masses import energy as energy_of_two_masses

DAMPED = {"m1": 1.0, "m2": 10.0, "k1": 20.0, "k2": 0.0, "k_c": 0.0, "d_c": 1e3, "v1": 1.0, "v2": -0.2}
# The stiffest mode is d_c (1/m1 + 1/m2) = 1100/s. Runge-Kutta 4 of y' = -r y errs by (r dt)^5 / 120 of y in a step.
# At 1e-4 s this is 1.3e-7 at first, and vanishes with the mode. In `right` alone the mode is 100/s: 8e-14.
DT_MAX = 1e-4  # s
# See `Problem`. The stiff mode, r = 1100/s, has vanished before the end. Its error y = r^2 tau t exp(-r t) is at most
# r tau / e, which asks for a step of 3e-4 s. The first step must be small too, q <= 0.1, which asks for less.
SPAN = (0.05, 5e-5)  # s


def system(step: float, stop_time: float, **numbers: float) -> System:
    """Return the coupled system; step and stop time in s, `Numbers` of `two_masses` by name on top of `DAMPED`."""
    made = force_displacement.system(step, stop_time, **(DAMPED | numbers))
    return made.set({"left.dt_max": DT_MAX, "right.dt_max": DT_MAX})


def exact(t: np.ndarray, **numbers: float) -> dict[str, np.ndarray]:
    """Return all outputs of the monolithic system at the times t, s."""
    return force_displacement.exact(t, **(DAMPED | numbers))


def energy(columns: dict[str, np.ndarray], **numbers: float) -> np.ndarray:
    """Return the kinetic energy plus the energy of the spring, J, which never grows in the exact solution."""
    return energy_of_two_masses(columns, **(DAMPED | numbers))


def step_map(algorithm: str, h: float, **numbers: float) -> np.ndarray:
    """Return the map of (x1, v1, x2, v2, right.F) over a step h, s, shape (5, 5); see `force_displacement.step_map`."""
    return force_displacement.step_map(algorithm, h, **(DAMPED | numbers))


PROBLEM = Problem("damper pair", system, exact, SPAN, force_displacement.PROBLEM.bonds, energy)
