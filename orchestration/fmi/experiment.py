"""Start, stop, tolerance and step of an experiment, as an FMU suggests them and as a host tells them to it."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Experiment:
    """What is known of an experiment; None where nothing is.

    Attributes
    ----------
    start_time, stop_time
        First and last time, s.
    tolerance
        Relative tolerance of the solver within the FMU.
    step
        Communication step, s.
    """

    start_time: float | None = None
    stop_time: float | None = None
    tolerance: float | None = None
    step: float | None = None

    @property
    def told(self) -> tuple[tuple[int, float], tuple[int, float]]:
        """Whether tolerance and stop time are known, and their values, as fmi2SetupExperiment takes them."""
        tolerance, stop_time = ((0, 0.0) if value is None else (1, value) for value in (self.tolerance, self.stop_time))
        return tolerance, stop_time


UNKNOWN = Experiment()
"""Nothing is known of the experiment."""
