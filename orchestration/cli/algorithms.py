"""Makes the co-simulation algorithm that the options of a command line describe."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from orchestration.cli.settings import numbers
from orchestration.errors import SystemDescriptionError
from orchestration.master.algorithm import Algorithm, Tolerance, find_algorithm


@dataclass(frozen=True)
class AlgorithmRequest:
    """A co-simulation algorithm by name, with options that replace its own."""

    name: str
    exchange: str | None = None
    order: int | None = None
    tolerance: float | None = None
    absolute: Sequence[str] = ()

    def algorithm(self) -> Algorithm:
        """Make the requested algorithm.

        Raises
        ------
        SystemDescriptionError
            If there is no such choice, or the algorithm has no tolerance.
        """
        found = find_algorithm(self.name)
        changes = {"exchange": self.exchange, "order": self.order}
        found = replace(found, **{name: value for name, value in changes.items() if value is not None})
        if self.tolerance is None and not self.absolute:
            return found
        given = found.control or found.correction
        if given is None:
            msg = f"Algorithm {self.name} has no tolerance; iterative, newton and adaptive have."
            raise SystemDescriptionError(msg)
        absolute = numbers("--absolute", self.absolute, float)
        tolerance = Tolerance(given.tolerance.relative if self.tolerance is None else self.tolerance, absolute)
        changed = replace(given, tolerance=tolerance)
        return replace(found, control=changed) if found.control else replace(found, correction=changed)
