"""Systems and algorithms that several tests run: every loop, with and without sampled FMUs and noise."""

from pathlib import Path

from orchestration import Options, System
from orchestration.master.algorithm import (
    NEWTON,
    PARALLEL,
    Algorithm,
    Correction,
    StepControl,
    Tolerance,
)
from orchestration.master.options import Crossings
from orchestration.paper.scenarios import SCENARIOS
from tests.unit.orchestration.small_models import H, mixed

# m; the tip starts at -n.x = 1.5, so it is in contact from the first step on, and a gated sensor is noisy
IN_CONTACT = {"plant.wall_offset": -1.501, "trajectory.wall_offset": -1.501}
# s; powers of two, so that every point k h and every half of a step is exact
SAMPLE_TIME = 2.0**-13

EXTRAPOLATED = Algorithm("extrapolated", order=1)
PARABOLIC = Algorithm("parabolic", PARALLEL, order=2)
ITERATIVE = Algorithm("iterative", PARALLEL, correction=Correction())
NEWTON_1 = Algorithm("newton", order=1, correction=Correction(NEWTON))
ADAPTIVE = Algorithm("adaptive", order=1, control=StepControl(Tolerance(1e-3)))
ALGORITHMS = {
    "gauss-seidel": Algorithm("gauss-seidel"),
    "jacobi": Algorithm("jacobi", PARALLEL),
    "extrapolated": EXTRAPOLATED,
    "parabolic": PARABOLIC,
    "iterative": ITERATIVE,
    "newton": NEWTON_1,
    "adaptive": ADAPTIVE,
}


def paper(fmu_folder: Path, name: str) -> System:
    """A system of the paper, in contact from the start; Figs. 5 to 7 with noise."""
    scenario = SCENARIOS[name]
    system = scenario.system({identifier: fmu_folder / f"{identifier}.fmu" for identifier in scenario.models.values()})
    return system.set(IN_CONTACT).with_sample_time(SAMPLE_TIME)


def falling(small: dict[str, Path], *, steps: int = 16) -> System:
    """`mixed`, with a plant that falls through zero: x' = 2 x - 4 with the input held over a step, x(0) = 1.

    One step multiplies 2 - x by 1 + 2 h, so x = 2 - 1.25^k after k steps of H: it changes its sign in the
    fourth, where 2 - x goes from 1.953 to 2.441 in a straight line.
    """
    return mixed(small, steps=steps).set({"relay.offset": -4.0})


def crossing(k: int = 3) -> float:
    """When `falling` passes zero, s: in the step from k H."""
    reached = 1.25**k
    return k * H + (2 - reached) / (2 * reached)


def at_zero() -> Options:
    """Locate that."""
    return Options(crossings=Crossings(("plant.x",)))
