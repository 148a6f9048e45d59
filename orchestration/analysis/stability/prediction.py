"""A prediction in words for a run: whether its algorithm is stable at its step, and if not, what to do.

The prediction takes some tenths of a second. Systems of very many connections are not judged.
"""

from orchestration.analysis.stability import verdict
from orchestration.analysis.stability.step_limit import DOUBLING
from orchestration.errors import OrchestrationError, SystemDescriptionError
from orchestration.fmi.isolation import Isolation
from orchestration.master.algorithm import Algorithm
from orchestration.results.prediction import Prediction
from orchestration.system.system import System

MOST_JUDGED = 100  # connections: the verdict takes up to 5 s there, and grows with the cube of their number
MOST_EXPLAINED = 60  # connections: the search for a stable step and for the culprit takes up to 15 s there


def predict(system: System, step: float, algorithm: Algorithm, isolation: Isolation | None = None) -> Prediction:
    """Predict the stability of a run near its start; what cannot be judged in short time has no verdict.

    Parameters
    ----------
    system
        System with its start values, those included that time series give to inputs.
    step
        Communication step, s.
    algorithm
        Co-simulation algorithm.
    isolation
        Components whose FMUs live in processes of their own; none if it is None.
    """
    n = len(system.connections)
    run = f"{system.name}: {algorithm.name} with a step of {step:g} s"
    try:
        _require_few(n)
        if verdict.is_stable(system, step, algorithm, isolation=isolation):
            return Prediction(True, f"{run} is stable at the start.")
        if n <= MOST_EXPLAINED and _is_rough(system, step, algorithm, isolation):
            advice = "a small deviation more than doubles in each step; use a much shorter step."
            return Prediction(False, f"{run} is UNSTABLE at the start: {advice}")
        if n > MOST_EXPLAINED:
            advice = "System.stability searches for a stable step, which takes long."
            return Prediction(False, f"{run} is UNSTABLE at the start; {advice}")
        return Prediction(False, str(verdict.stability(system, step, algorithm, isolation=isolation)))
    except OrchestrationError as error:
        return Prediction(None, f"no verdict on stability: {error}")


def _is_rough(system: System, step: float, algorithm: Algorithm, isolation: Isolation | None) -> bool:
    """Whether the growth is known so roughly that a search for a stable step would take long and say little."""
    return verdict.judged(system, step, algorithm, isolation=isolation).threshold > DOUBLING


def _require_few(n_connections: int) -> None:
    if n_connections > MOST_JUDGED:
        msg = f"it would take long with {n_connections} connections; System.stability gives one."
        raise SystemDescriptionError(msg)
