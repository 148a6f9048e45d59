"""Linear models of components whose equations are hidden, from responses to small pulses.

An FMU for co-simulation hides its state. So the model is found by experiment. A component makes 2 s + 1
steps from a saved state. Its inputs are held at u_0, except that one input is changed by +delta in the first
step. A second run has -delta in place of +delta. The central difference of both runs is a column of the
Markov parameters (`eigensystem_realization`):

    H_j = (y_(j+1)(u_0 + delta) - y_(j+1)(u_0 - delta)) / (2 delta)

Curvature causes an error proportional to delta^2, rounding an error of about eps |y| / delta. So delta is
changed in powers of ten, first upwards, then downwards, while the responses to neighbouring powers agree
better and better. The disagreement that remains at the best power is the noise of the response. Where
inputs are polynomials in time, their first and second derivatives (fmi2SetRealInputDerivatives) count as
further inputs. A sampled component steps from tick to tick.

The operating point of a moving component changes during the experiment. The same pulse, given s steps later,
then has another response. The difference of both responses is the drift. States whose responses are smaller
than the drift cannot be identified.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from orchestration.analysis.stability.eigensystem_realization import Pulses, Realization, realize
from orchestration.analysis.stability.operating_point import SavedComponent
from orchestration.errors import SimulationError

BLOCKS, MOST_BLOCKS = 6, 24  # first and largest s; s is doubled while the states fill the Hankel matrix
FIRST_DECADE, LAST_DECADE, LEAST_DECADE = -2, 4, -9  # powers of ten of delta / max(1, |u|)
PERFECT = 1e-13  # relative disagreement of two responses that rounding alone explains
SEEN = 2  # a response below this multiple of its noise counts as zero
EPS = float(np.finfo(float).eps)


@dataclass(frozen=True)
class ComponentModel:
    """Linear model of one step of a component, about its operating point.

    Attributes
    ----------
    name
        Name of the component.
    continuous
        Whether the component is continuous; see `orchestration.system.component.Component`.
    inputs, outputs
        Names of the connected Real variables.
    order
        Degree of the input polynomials. The columns of B and D belong to the values of all inputs, then
        to the first, then to the second derivatives of all inputs.
    pulses
        Responses from which the model was identified.
    map
        State-space model of the step.
    """

    name: str
    continuous: bool
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    order: int
    pulses: Pulses
    map: Realization

    def shaken(self, random: np.random.Generator) -> "ComponentModel":
        """A model with as many states, identified from responses that random errors within the noise change."""
        return replace(self, map=realize(self.pulses.shaken(random), self.map.A.shape[0]))

    def later(self) -> "ComponentModel":
        """The model identified from the pulses that were given s steps later."""
        pulses = replace(self.pulses, H=self.pulses.later)
        return replace(self, map=realize(pulses, self.map.A.shape[0]))


def identify(saved: SavedComponent, h: float, order: int = 0) -> ComponentModel:
    """Identify a linear model of one step of a component from its responses to pulses.

    Parameters
    ----------
    saved
        Component at its operating point.
    h
        Step, s. A sampled component makes steps of its sampling period instead.
    order
        Degree of the input polynomials. A component that cannot interpolate its inputs holds them.

    Returns
    -------
    ComponentModel
        Linear model about the operating point.

    Raises
    ------
    SimulationError
        If a step from the operating point fails.
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
    """Measure the responses to pulses at all inputs and their derivatives."""
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
            # This scale lets a derivative change the input over a step by about as much as a value would.
            degree, i = divmod(j, n_inputs)
            scale = max(1.0, abs(saved.u[i])) * math.factorial(degree) / h**degree
            channel = _Channel(saved, h, held, (degree, i), scale, np.abs(base).max(axis=0))
            H[:, :, j], noise[:, :, j], later[:, :, j] = channel.column(blocks)
    return Pulses(H, noise, later)


@dataclass(frozen=True)
class _Channel:
    """The experiment on one channel: derivative number `place[0]` of input `place[1]`, changed by about `scale`."""

    saved: SavedComponent
    h: float
    held: np.ndarray
    place: tuple[int, int]
    scale: float
    size: np.ndarray  # largest magnitudes of the outputs, shape (n_outputs,)

    def column(self, blocks: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Columns of `Pulses.H`, `noise` and `later`, shapes (n_steps, n_outputs), (2, n_outputs) and as `H`."""
        n = 2 * blocks + 1
        found: dict[int, np.ndarray | None] = {}

        def response(decade: int) -> np.ndarray | None:
            """Response to a pulse of a power of ten, measured once."""
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
        """Central difference of two runs of n steps with a pulse in step `when`; None if a step fails."""
        delta, runs = self.scale * 10.0**decade, []
        for sign in (1, -1):
            moved = self.held[:n].copy()
            moved[when, *self.place] += sign * delta
            runs.append(self.saved.run(self.h, moved))
            if runs[-1] is None:
                return None
        return (runs[0] - runs[1]) / (2 * delta)

    def rounding(self, decade: int) -> np.ndarray:
        """Rounding error of the central difference, shape (n_outputs,)."""
        return 2 * EPS * self.size / (self.scale * 10.0**decade)

    def disagreement(self, decade: int, small: np.ndarray | None, large: np.ndarray | None) -> float:
        """Largest relative difference of two responses in any output, beyond their rounding errors."""
        if small is None or large is None:
            return math.inf
        peak, rounding = _largest(small), self.rounding(decade)
        seen = peak > 10 * rounding
        beyond = np.maximum(0, _largest(large - small) - 4 * rounding)
        return float((beyond[seen] / peak[seen]).max(initial=0.0))


def _largest(H: np.ndarray) -> np.ndarray:
    """Largest magnitudes of H_0 and of all later parameters, shape (2, n_outputs)."""
    return np.stack([np.abs(H[0]), np.abs(H[1:]).max(axis=0)])


def _best_decade(disagreement: Callable[[int], float]) -> int:
    """Power of ten of delta whose response agrees best with the response to the next power.

    The search goes upwards first, and downwards if no larger power agrees better. Upwards, the search goes on
    even at perfect agreement: the rounding errors of further outputs still decrease.
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
    """Message of an experiment that failed."""
    last = saved.instance.messages[-1] if saved.instance.messages else "it logged nothing"
    return f'{saved.name}: steps of {h:g} s from t = {saved.time:g} s fail with {what}; its last message: "{last}".'
