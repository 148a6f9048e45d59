"""Two masses, coupled by displacements: both FMUs hold the coupling spring and receive the motion of the other mass.

    left:   m1 x1'' = -k1 x1 - d1 x1' + k_c (x_right - x1) + d_c (v_right - x1')
    right:  m2 x2'' = -k2 x2 - d2 x2' + k_c (x_left - x2) + d_c (v_left - x2')

Each component shows x, v and the force F that acts on it from the coupling. F is not connected. Between communication
points the two forces are not opposite. No connected output has direct feedthrough. No force crosses the coupling, so
there is no power bond. The order is left, right.
"""

import numpy as np

from adaptimp_fmu import ContinuousModel
from orchestration.system.system import System
from tests.reference.problems.problem import Part, Problem, assemble
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

WIRES = [
    ("right", "x", "left", "x_other"),
    ("right", "v", "left", "v_other"),
    ("left", "x", "right", "x_other"),
    ("left", "v", "right", "v_other"),
]


def tied_mass() -> ContinuousModel:
    """Declare a mass on its own spring, tied by a second spring to another mass, whose motion is an input."""
    model = ContinuousModel("TiedMass", "Mass tied by a spring to a moving end", dt_max=DT_MAX)
    F = mass_on_spring(model, coupling(model, "other"))
    model.output("F", F, unit="N", description="Force of the coupling on this mass", scalar=True)
    return model


def system(step: float, stop_time: float, **numbers: float) -> System:
    """Return the coupled system; step and stop time in s, `Numbers` by name."""
    n = Numbers(**numbers)
    tie = {"k_c": n.k_c, "d_c": n.d_c}
    parts = {"left": Part(tied_mass, left_start(n) | tie), "right": Part(tied_mass, right_start(n) | tie)}
    return assemble("displacement-displacement", parts, WIRES, step, stop_time)


def exact(t: np.ndarray, **numbers: float) -> dict[str, np.ndarray]:
    """Return all outputs of the monolithic system at the times t, s."""
    z = motion(t, Numbers(**numbers))
    return z | {"left.F": z["right.F"], "right.F": -z["right.F"]}


PROBLEM = Problem("displacement-displacement", system, exact, SPAN, energy=energy)
