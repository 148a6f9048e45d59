"""Step maps of black-box units, by pulses from a saved state.

FMUs for co-simulation hide their states. So a unit makes 2 s + 1 steps from a saved state with its
inputs held at u_0, one input moved by +delta in the first step, and again by -delta; half the
difference over delta is a column of the Markov parameters (`eigensystem_realization`):

    H_j = (y_(j+1)(u_0 + delta) - y_(j+1)(u_0 - delta)) / (2 delta)

Curvature spoils it by a share of delta^2, rounding by eps |y| / delta. Delta goes up, or else down, in
decades for as long as neighbouring ones agree better; what they still disagree by is the noise. Where
inputs are polynomials, their first and second derivatives in time (fmi2SetRealInputDerivatives) are
further inputs. A sampled unit steps from tick to tick.

A unit that moves changes while it is probed: the same pulse, given s steps later, has another
response. States that show no more than this drift are not to be told from it.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from orchestration.analysis.stability.eigensystem_realization import Pulses, Realization, realize
from orchestration.analysis.stability.operating_point import SavedComponent
from orchestration.errors import SimulationError

BLOCKS, MOST_BLOCKS = 6, 24  # s at first, and at most: doubled while the states fill the Hankel matrix
FIRST_DECADE, LAST_DECADE, LEAST_DECADE = -2, 4, -9  # of delta over max(1, |u|)
PERFECT = 1e-13  # relative disagreement of responses that rounding alone explains
SEEN = 2  # times the noise: a response that stays below is none
EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class ComponentModel:
    """A unit's step map, linear about its operating point.

    Attributes
    ----------
    continuous
        See `orchestration.system.system.Component`.
    inputs, outputs
        Names of the connected Real variables.
    order
        Degree of the inputs' polynomials: columns of B and D are the inputs' values, then their first, then
        their second derivatives.
    pulses
        What the map was realized from.
    """

    name: str
    continuous: bool
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    order: int
    pulses: Pulses
    map: Realization

    def shaken(self, random: np.random.Generator) -> "ComponentModel":
        """A model with as many states that the noise allows as well."""
        return replace(self, map=realize(self.pulses.shaken(random), self.map.A.shape[0]))

    def later(self) -> "ComponentModel":
        """The model some steps later."""
        pulses = replace(self.pulses, H=self.pulses.later)
        return replace(self, map=realize(pulses, self.map.A.shape[0]))


def identify(saved: SavedComponent, h: float, order: int = 0) -> ComponentModel:
    """The map of a step of h, s, or of a tick if the unit is sampled.

    Parameters
    ----------
    order
        Degree of the inputs' polynomials, for a unit that interpolates; others hold their inputs.

    Raises
    ------
    SimulationError
        If the unit cannot be stepped from where it is.
    """
    period, order = saved.component.sample_time, order if saved.interpolates else 0
    blocks = BLOCKS
    while True:
        pulses = _pulses(saved, h if period is None else period, order, blocks)
        map_ = realize(pulses)
        if not map_.full or blocks >= MOST_BLOCKS:
            return ComponentModel(
                saved.name, saved.component.continuous, saved.inputs, saved.outputs, order, pulses, map_
            )
        blocks *= 2


def _pulses(saved: SavedComponent, h: float, order: int, blocks: int) -> Pulses:
    """Responses to pulses in all channels."""
    n_inputs, n = len(saved.inputs), 2 * blocks + 1
    H = np.zeros((n, len(saved.outputs), (order + 1) * n_inputs))
    later, noise = H.copy(), np.zeros((2, *H.shape[1:]))
    if H.size:
        held = np.zeros((n + blocks, order + 1, n_inputs))
        held[:, 0] = saved.u
        base = saved.run(h, held)
        if base is None:
            raise SimulationError(_failure(saved, h, "its inputs held"))
        for j in range(H.shape[2]):
            # a derivative moves the input, over the step, by about as much as its value does
            degree, i = divmod(j, n_inputs)
            scale = max(1.0, abs(saved.u[i])) * math.factorial(degree) / h**degree
            channel = _Channel(saved, h, held, (degree, i), scale, np.abs(base).max(axis=0))
            H[:, :, j], noise[:, :, j], later[:, :, j] = channel.column(blocks)
    return Pulses(H, noise, later)


@dataclass(frozen=True)
class _Channel:
    """One channel to be moved: derivative `place[0]` of input `place[1]`, by about `scale`."""

    saved: SavedComponent
    h: float
    held: np.ndarray
    place: tuple[int, int]
    scale: float
    size: np.ndarray  # of the outputs

    def column(self, blocks: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Columns of H, noise and later H, shapes (n_steps, n_outputs), (2, n_outputs) and as H."""
        n = 2 * blocks + 1
        found: dict[int, np.ndarray | None] = {}

        def response(decade: int) -> np.ndarray | None:
            if decade not in found:
                found[decade] = self.difference(decade, 0, n)
            return found[decade]

        best = _best_decade(lambda d: self.disagreement(d, response(d), response(d + 1)))
        H, neighbour = response(best), response(best + 1)
        if H is None:
            raise SimulationError(_failure(self.saved, self.h, f"{self.saved.inputs[self.place[1]]} moved"))
        noise = np.tile(self.rounding(best), (2, 1))
        if neighbour is not None:
            noise = np.maximum(noise, _largest(H - neighbour))
        shifted = self.difference(best, blocks, n + blocks)
        later = H.copy() if shifted is None else shifted[blocks:]
        direct, others = _largest(H) <= SEEN * noise
        for response_ in (H, later):
            response_[0, direct] = 0
            response_[1:, others] = 0
        return H, noise, later

    def difference(self, decade: int, when: int, n: int) -> np.ndarray | None:
        """Central difference of n steps by a pulse in step `when`; None if a step fails."""
        delta, runs = self.scale * 10.0**decade, []
        for sign in (1, -1):
            moved = self.held[:n].copy()
            moved[when, *self.place] += sign * delta
            runs.append(self.saved.run(self.h, moved))
            if runs[-1] is None:
                return None
        return (runs[0] - runs[1]) / (2 * delta)

    def rounding(self, decade: int) -> np.ndarray:
        """Rounding of the difference, shape (n_outputs,)."""
        return 2 * EPS * self.size / (self.scale * 10.0**decade)

    def disagreement(self, decade: int, small: np.ndarray | None, large: np.ndarray | None) -> float:
        """Largest difference of two responses in any output, beyond rounding, relative."""
        if small is None or large is None:
            return math.inf
        peak, rounding = _largest(small), self.rounding(decade)
        seen = peak > 10 * rounding
        beyond = np.maximum(0, _largest(large - small) - 4 * rounding)
        return float((beyond[seen] / peak[seen]).max(initial=0.0))


def _largest(H: np.ndarray) -> np.ndarray:
    """Largest magnitude of H_0 and of all others, shape (2, n_outputs)."""
    return np.stack([np.abs(H[0]), np.abs(H[1:]).max(axis=0)])


def _best_decade(disagreement: Callable[[int], float]) -> int:
    """The decade that agrees best with the next: upwards from the first, else downwards.

    Upwards, perfect agreement goes on: rounding still fades in outputs that do not yet show.
    """
    best, least = FIRST_DECADE, disagreement(FIRST_DECADE)
    while best + 1 < LAST_DECADE and (now := disagreement(best + 1)) <= max(least, PERFECT):
        best, least = best + 1, now
    if best > FIRST_DECADE:
        return best
    while best > LEAST_DECADE and ((now := disagreement(best - 1)) < least or math.isinf(now)):
        best, least = best - 1, now
    return best


def _failure(saved: SavedComponent, h: float, what: str) -> str:
    last = saved.instance.messages[-1] if saved.instance.messages else "it logged nothing"
    return f'{saved.name}: steps of {h:g} s from t = {saved.time:g} s fail with {what}; its last message: "{last}".'
