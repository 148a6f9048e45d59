"""Measures the errors of runs in which the force sensor fails, or the torques are far too small.

Section IV-A of the paper asks what becomes of the error when a large external force or a sensor failure saturates the
controller.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from orchestration.errors import SimulationError
from orchestration.paper.laboratory import Job, Runner
from orchestration.paper.measure import ESTIMATE, at_ticks, norms
from orchestration.paper.numbers import FAILURES, PERIOD

WEAK = 0.2  # share of the limits of Fig. 6 at which the force of the contact saturates both algorithms
SINCE = 0.4 * PERIOD  # s, after the first adaptation and before the contact
HEALTHY, WEAK_TORQUES = "healthy", "torques too small"
TROUBLES = (HEALTHY, *FAILURES, WEAK_TORQUES)
"""Names of what befalls a run; the first one is that of runs without any trouble."""
ENDS = {1: "-craig", 2: ""}
"""Ends of the names of the scenarios with a sensor that fails, by the number of the algorithm."""
ERROR = ("controller.e[1]", "controller.e[2]")
_NO_FAILURE = {"sensor.failure": 0.0}


@dataclass(frozen=True)
class Errors:
    """What is left of a run: errors in m, which are infinite if the run ended with an error.

    Attributes
    ----------
    largest
        Largest |e| from `SINCE` on.
    end
        |e| at the end.
    least
        Smallest m2_hat, kg.
    """

    largest: float
    end: float
    least: float = np.nan

    @property
    def finished(self) -> bool:
        """Whether the run reached its end."""
        return bool(np.isfinite(self.end))


def troubled_jobs(
    algorithm: int,
    changes: Mapping[str, float],
    limits: Sequence[float],
    seeds: Sequence[int],
    sample_time: float | None = None,
) -> Mapping[str, list[Job]]:
    """The runs of an algorithm with each of `TROUBLES`, one for each seed of the noise, by the name of the trouble.

    Parameters
    ----------
    algorithm
        1 or 2.
    changes
        Start values that all runs have besides.
    limits
        The torques, N.m, shape (2,), of which a share of `WEAK` is far too small.
    sample_time
        Sampling period, s; that of the scenarios if None.
    """
    first = f"sensor-dropout{ENDS[algorithm]}"
    weak = {f"actuator.tau_max[{i}]": WEAK * limit for i, limit in enumerate(limits, start=1)}
    troubles: dict[str, tuple[str, Mapping[str, float]]] = {HEALTHY: (first, _NO_FAILURE)}
    troubles |= {kind: (f"sensor-{kind}{ENDS[algorithm]}", {}) for kind in FAILURES}
    troubles[WEAK_TORQUES] = (first, {**_NO_FAILURE, **weak})
    return {
        name: [Job(scenario, {**changes, **trouble, "sensor.seed": float(seed)}, sample_time) for seed in seeds]
        for name, (scenario, trouble) in troubles.items()
    }


def errors_of(laboratory: Runner, job: Job) -> Errors:
    """Make a run, and measure its errors."""
    try:
        result = laboratory.run(job, (*ERROR, ESTIMATE))
    except SimulationError:
        return Errors(np.inf, np.inf)
    e = norms(at_ticks(result, "controller.e"))
    largest = float(e[result.tick_times(ERROR[0]) >= SINCE].max())
    return Errors(largest, float(e[-1]), float(result.at_ticks(ESTIMATE).min()))
