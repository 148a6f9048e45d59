"""Judges the stability of a run when somebody asks for it, and warns of a run that is judged unstable before it."""

from collections.abc import Mapping
from dataclasses import dataclass

from orchestration.errors import warn_caller
from orchestration.fmi.isolation import Isolation
from orchestration.master.algorithm import Algorithm
from orchestration.results.prediction import Prediction
from orchestration.system.registry import analysis
from orchestration.system.system import System


class StabilityWarning(UserWarning):
    """Warning that the algorithm of a run is unstable at its step, with the words of ``adaptimp run``.

    Examples
    --------
    >>> import warnings
    >>> from orchestration import StabilityWarning, scenario, simulate
    >>> late = scenario("fig2").with_sample_time(1.0)  # s
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always", StabilityWarning)
    ...     result = simulate(late, verdict=True)
    >>> result.status, len(caught), str(caught[0].message) == str(result.verdict)
    ('complete', 1, True)
    """


@dataclass(frozen=True)
class Judge:
    """Predicts the stability of a run near its start, when it is called.

    Attributes
    ----------
    system
        System that is run.
    inputs
        Values that time series give to inputs at the start, by ``component.variable``.
    step
        Communication step, s.
    algorithm
        Co-simulation algorithm.
    isolation
        Components whose FMUs live in processes of their own; none if it is None.
    """

    system: System
    inputs: Mapping[str, float]
    step: float
    algorithm: Algorithm
    isolation: Isolation | None

    def __call__(self) -> Prediction:
        """Make the prediction."""
        system = self.system.set(self.inputs) if self.inputs else self.system
        return analysis("prediction")(system, self.step, self.algorithm, self.isolation)


def report_prediction(prediction: Prediction) -> None:
    """Warn of a run that is predicted to be unstable."""
    if prediction.stable is False:
        warn_caller(prediction.text, StabilityWarning)
