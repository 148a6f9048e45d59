"""Says how much each connection of a system matters for its stability.

The factor of one connection is changed a little, and the spectral radius of a step answers::

    influence = |d radius / d factor|
"""

import numpy as np

from orchestration.analysis.stability.step_limit import radius_of
from orchestration.analysis.stability.step_map import Coupled
from orchestration.master.algorithm import Algorithm
from orchestration.system.component import Connection

GAIN = 1e-6  # change of a connection's factor for a difference quotient
DIGITS = 4  # that agree between machines: rounding of the radius, about 1e-15, counts 1/GAIN times


def influences(coupled: Coupled, algorithm: Algorithm, h: float) -> tuple[tuple[Connection, float], ...]:
    """Return the connections with their influence, the largest first, equal ones in the order of the links.

    In a loop of two connections both influences are equal but for rounding, which differs between machines.

    Parameters
    ----------
    h
        Step, s.
    """
    base, n = radius_of(coupled, algorithm, h), len(coupled.links)
    found = []
    for j, link in enumerate(coupled.links):
        gains = np.ones(n)
        gains[j] += GAIN
        found.append((link.connection, abs(radius_of(coupled, algorithm, h, gains) - base) / GAIN))
    return tuple(sorted(found, key=lambda pair: -float(f"{pair[1]:.{DIGITS}g}")))
