"""Co-simulation problems with an exact solution: small FMUs, their connections, and the motion of the coupled system.

    problem = PROBLEMS["quarter car"]
    result = simulate(problem.system(1e-3, 1.0), algorithm="jacobi")
    error = result["body.z"] - problem.exact(result.time)["body.z"]

Every number of a problem is a keyword of `system`, `exact` and `energy` alike. All components are continuous.
"""

from tests.reference.problems import (
    damper_pair,
    displacement_displacement,
    feedthrough,
    force_displacement,
    quarter_car,
    wall,
)
from tests.reference.problems.problem import Columns, Problem

_MODULES = (force_displacement, displacement_displacement, feedthrough, quarter_car, damper_pair, wall)
PROBLEMS: dict[str, Problem] = {module.PROBLEM.name: module.PROBLEM for module in _MODULES}

__all__ = ["PROBLEMS", "Columns", "Problem"]
