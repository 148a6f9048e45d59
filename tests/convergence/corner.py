"""A throw into a corner of two walls, with a solution that is independent of the FMU `PlantCorner`."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from tests.convergence.truth import Throw


@dataclass(frozen=True)
class CornerThrow(Throw):
    """A tip thrown at a corner; the attributes ending with a 2 belong to the second wall, as in `Throw` for the first.

    Attributes
    ----------
    turn2
        Angle by which the normal of the second wall is turned from (-1, 0), rad.
    """

    turn2: float = np.pi / 2
    distance2: float = 0.012
    K_f2: float = 1e5
    D_f2: float = 0.0
    mu2: float = 0.0
    friction_velocity2: float = 0.1

    @property
    def second(self) -> Throw:
        """The same throw at the second wall alone."""
        numbers = {name: getattr(self, f"{name}2") for name in ("turn", "distance", "K_f", "D_f", "mu")}
        same = {name: getattr(self, name) for name in ("v", "q", "tau", "m", "l", "viscous", "gravity")}
        return Throw(**same, **numbers, friction_velocity=self.friction_velocity2)

    @property
    def indicators(self) -> dict[str, Callable[[np.ndarray], float]]:
        """Events of both walls."""
        second = self.second
        return {**super().indicators, "contact2": second.gap, "pushing2": second.factor}

    def derivative(self, state: np.ndarray, modes: Mapping[str, bool]) -> np.ndarray:
        """Return the derivative of the state: that with the first wall, and what the force of the second one adds."""
        change = super().derivative(state, modes)
        if modes["contact2"] and modes["pushing2"]:
            F, J = self.second.force(state), self.jacobian(state[:2])
            change[2:] -= np.linalg.solve(self.inertia(state[:2]), J.T @ F)
        return change

    def energy(self, state: np.ndarray) -> float:
        """Return the kinetic and potential energy, with those of the springs of both walls, J."""
        return super().energy(state) + 0.5 * self.K_f2 * max(self.second.gap(state), 0) ** 2
