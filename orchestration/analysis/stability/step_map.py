"""The linear map of a coupled system from one communication point to the next.

The state z of a coupled system at a communication point contains three parts: the states of all components,
their outputs, and as many past outputs as the input polynomials need. All deviations from the operating point
in a step are linear in z, so each one is a row of coefficients. The step of `orchestration.master.algorithm`
is executed with these rows in place of numbers. The rows of the new z form the map M with z+ = M z.

Where the algorithm corrects inputs, their assumed values e at the end of the step are unknowns besides z.
After a sweep, the connected outputs are y = R z + J e. The correction ends at the solution
y = e = (I - J)^-1 R z. A sweep without relaxation multiplies the error of e by J. So repeated sweeps
converge if the spectral radius of J is below one.

A component that ticks every r steps holds its outputs in between. The map over one period of all ticks is the
product of the maps of its steps.
(Stability of co-simulation by the spectral radius of such maps: M. Busch, "Zur effizienten Kopplung von
Simulationsprogrammen", Kassel 2012; C. Gomes et al., "Co-simulation: a survey", ACM CSUR 51(3), 2018.)
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from orchestration.analysis.stability.pulse_response import ComponentModel
from orchestration.master.algorithm import FIXED_POINT, SEQUENTIAL, Algorithm
from orchestration.system.system import Connection, System


@dataclass(frozen=True)
class Link:
    """A connection of two Real variables in a linear coupled system.

    Attributes
    ----------
    connection
        Connection of the original system.
    source, target
        Indices of the two components in `Coupled.models`.
    output, input
        Indices of the two variables in the lists of the components' outputs and inputs.
    smooth
        Whether both components are continuous. Only such connections are corrected or interpolated.
    """

    connection: Connection
    source: int
    output: int
    target: int
    input: int
    smooth: bool


@dataclass(frozen=True)
class Coupled:
    """A coupled system whose components are linear models.

    Attributes
    ----------
    models
        One model per component, in the order of the system.
    links
        All Real connections.
    ratios
        Steps per tick of each component; 1 for a continuous component.
    """

    models: tuple[ComponentModel, ...]
    links: tuple[Link, ...]
    ratios: tuple[int, ...]

    @classmethod
    def of(cls, system: System, models: Sequence[ComponentModel], step: float) -> "Coupled":
        """Combine the models of all components with the Real connections of a system.

        Parameters
        ----------
        system
            System that has the connections.
        models
            One model per component, in the order of the system.
        step
            Communication step, s.

        Raises
        ------
        SystemDescriptionError
            If a sampling period is not a multiple of the step.
        """
        places = {model.name: i for i, model in enumerate(models)}
        links = []
        for c in system.connections:
            source, target = models[places[c.source]], models[places[c.target]]
            if c.output in source.outputs and c.input in target.inputs:
                ends = (places[c.source], source.outputs.index(c.output))
                ends += (places[c.target], target.inputs.index(c.input))
                links.append(Link(c, *ends, smooth=source.continuous and target.continuous))
        ratios = system.steps_per_tick(step)
        return cls(tuple(models), tuple(links), tuple(ratios.get(model.name, 1) for model in models))

    def radius(self, algorithm: Algorithm, h: float, gains: np.ndarray | None = None) -> float:
        """Spectral radius of the map from one communication point to the next.

        Where sampled components tick every few steps, this is the geometric mean over one period of all ticks.

        Parameters
        ----------
        algorithm
            Co-simulation algorithm.
        h
            Communication step, s.
        gains
            Factors of the connections, shape (n_links,). Default: all 1.

        Raises
        ------
        LinAlgError
            If the corrected inputs have no solution.
        """
        n = int(np.lcm.reduce([1, *self.ratios]))
        product, kept = None, {}
        for k in range(n):
            due = tuple(k % ratio == 0 for ratio in self.ratios)
            if due not in kept:
                kept[due] = transition(self, algorithm, h, due, gains)[0]
            product = kept[due] if product is None else kept[due] @ product
        return spectral_radius(product) ** (1 / n) if product is not None else 0.0

    def contraction(self, algorithm: Algorithm, h: float) -> float | None:
        """Factor by which a sweep without relaxation changes the error of corrected inputs; None if none are."""
        J = transition(self, algorithm, h, (True,) * len(self.models))[1]
        return None if J is None else spectral_radius(J)

    def ordered(self, order: Sequence[int]) -> "Coupled":
        """The same coupled system with its components in another order, given as old indices."""
        place = {old: new for new, old in enumerate(order)}
        links = tuple(
            Link(x.connection, place[x.source], x.output, place[x.target], x.input, x.smooth) for x in self.links
        )
        return Coupled(tuple(self.models[i] for i in order), links, tuple(self.ratios[i] for i in order))


def spectral_radius(M: np.ndarray) -> float:
    """Largest magnitude of the eigenvalues of a square matrix; infinite if the matrix is not finite."""
    if not np.isfinite(M).all():
        return np.inf
    return float(np.abs(np.linalg.eigvals(M)).max(initial=0.0))


def transition(
    coupled: Coupled, algorithm: Algorithm, h: float, due: Sequence[bool], gains: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray | None]:
    """Matrices of one step: the map M, and the iteration matrix J of the corrected inputs.

    The equations of both stand in the docstring of the module.

    Parameters
    ----------
    coupled
        Linear coupled system.
    algorithm
        Co-simulation algorithm.
    h
        Communication step, s.
    due
        Whether each component makes a step. A sampled component holds its outputs between two ticks.
    gains
        Factors of the connections, shape (n_links,). Default: all 1.

    Returns
    -------
    M
        Map of the state z, shape (n_z, n_z).
    J
        Iteration matrix of the corrected inputs, shape (n_corrected, n_corrected); None if no input is
        corrected.

    Raises
    ------
    LinAlgError
        If I - J is singular, so that the corrected inputs have no solution.
    """
    rows = _Rows.identity(coupled, algorithm, h, np.ones(len(coupled.links)) if gains is None else gains)
    past = rows.past
    if algorithm.correction is None:
        rows.sweep(due, None)
        return rows.after(past), None
    assumed = [j for j, link in enumerate(coupled.links) if rows.is_assumed(link)]
    start = list(rows.x)
    ends = {j: rows.extrapolated(coupled.links[j]) for j in assumed}
    rows.sweep(due, ends)
    sweeps = algorithm.correction.sweeps
    if sweeps == 1 or not assumed:
        return rows.after(past), None
    first = {j: rows.shown(coupled.links[j]) for j in assumed}
    R, J = _repeated_sweep(rows, start, assumed)
    if sweeps is None or algorithm.correction.method != FIXED_POINT:
        E = np.linalg.solve(np.eye(len(assumed)) - J, R)
    else:
        E = np.vstack([first[j] for j in assumed])
        for _ in range(sweeps - 2):
            E = R + J @ E
    return rows.substituted(E).after(past), J


def _repeated_sweep(
    rows: "_Rows", start: Sequence[np.ndarray], assumed: Sequence[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Matrices R and J of y = R z + J e, from a repeated step of the continuous components."""
    coupled, n, m = rows.coupled, rows.width, len(assumed)
    smooth = [model.continuous for model in coupled.models]
    rows.x = [start[i] if smooth[i] else x for i, x in enumerate(rows.x)]
    rows.widen(m)
    unknown = np.eye(m, n + m, n)
    rows.sweep(smooth, {j: unknown[[i]] for i, j in enumerate(assumed)}, again=True)
    end = np.vstack([rows.shown(coupled.links[j]) for j in assumed])
    return end[:, :n], end[:, n:]


@dataclass
class _Rows:
    """All quantities of one step, as rows of coefficients over the state z and the unknown input values.

    `x` and `y` are the current states and outputs of the components. `past[a]` are the outputs at the
    communication point a steps before the start of the step.
    """

    coupled: Coupled
    algorithm: Algorithm
    h: float
    gains: np.ndarray
    x: list[np.ndarray]
    y: list[np.ndarray]
    past: list[list[np.ndarray]] = field(default_factory=list)

    @classmethod
    def identity(cls, coupled: Coupled, algorithm: Algorithm, h: float, gains: np.ndarray) -> "_Rows":
        """Rows at the start of a step, where every quantity is an element of the state z."""
        models, order = coupled.models, algorithm.order
        sizes = [model.map.A.shape[0] for model in models] + (order + 1) * [len(model.outputs) for model in models]
        parts = np.split(np.eye(sum(sizes)), np.cumsum(sizes)[:-1])
        n = len(models)
        past = [parts[n * (age + 1) : n * (age + 2)] for age in range(order + 1)]
        return cls(coupled, algorithm, h, gains, parts[:n], list(past[0]), past)

    @property
    def width(self) -> int:
        """Number of columns: the elements of z, and the unknown input values if there are any."""
        return self.y[0].shape[1]

    def is_assumed(self, link: Link) -> bool:
        """Whether the target uses an assumed value: its source has not made its step yet, and may repeat it."""
        sequential = self.algorithm.exchange == SEQUENTIAL
        return link.smooth and not (sequential and link.source < link.target)

    def sweep(self, due: Sequence[bool], ends: dict[int, np.ndarray] | None, again: bool = False) -> None:
        """Step the components that are due; `ends` are the assumed values at the end of the step, by link."""
        sequential = self.algorithm.exchange == SEQUENTIAL or again
        inputs = {} if sequential else {i: self.inputs(i, ends) for i, now in enumerate(due) if now}
        for i, now in enumerate(due):
            if now:
                U, map_ = inputs[i] if i in inputs else self.inputs(i, ends), self.coupled.models[i].map
                self.y[i] = map_.C @ self.x[i] + map_.D @ U
                self.x[i] = map_.A @ self.x[i] + map_.B @ U

    def inputs(self, i: int, ends: dict[int, np.ndarray] | None) -> np.ndarray:
        """Values and derivatives of the inputs of component i, shape ((order + 1) n_inputs, width)."""
        model = self.coupled.models[i]
        order = min(model.order, self.algorithm.order)
        U = np.zeros((model.order + 1, len(model.inputs), self.width))
        for j, link in enumerate(self.coupled.links):
            if link.target != i:
                continue
            assumed = ends is not None and j in ends
            end = ends[j] if ends is not None and j in ends else self.shown(link)
            if order == 0 or not link.smooth:
                U[0, link.input] = self.gains[j] * end[0]
                continue
            fresh = self.algorithm.exchange == SEQUENTIAL and link.source < link.target
            for degree, row in enumerate(self.polynomial(link, end if assumed or fresh else None)):
                if degree <= order:
                    U[degree, link.input] = self.gains[j] * row[0]
        return U.reshape((model.order + 1) * len(model.inputs), self.width)

    def shown(self, link: Link) -> np.ndarray:
        """Current output at the source of a link, shape (1, width)."""
        return self.y[link.source][[link.output]]

    def polynomial(self, link: Link, end: np.ndarray | None) -> tuple[np.ndarray, ...]:
        """Value and derivatives, at the start of the step, of the polynomial through `end` and past outputs."""
        order, h = self.algorithm.order, self.h
        y = [values[link.source][[link.output]] for values in self.past]
        if end is not None and order == 1:
            return y[0], (end - y[0]) / h
        if order == 1:
            return y[0], (y[0] - y[1]) / h
        if end is not None:
            return y[0], (end - y[1]) / (2 * h), (end - 2 * y[0] + y[1]) / h**2
        return y[0], (3 * y[0] - 4 * y[1] + y[2]) / (2 * h), (y[0] - 2 * y[1] + y[2]) / h**2

    def extrapolated(self, link: Link) -> np.ndarray:
        """Initial guess of the value at the end of the step."""
        if min(self.coupled.models[link.target].order, self.algorithm.order) == 0:
            return self.past[0][link.source][[link.output]]
        terms = (1.0, self.h, self.h**2 / 2)
        return sum((c * row for c, row in zip(terms, self.polynomial(link, None), strict=False)), np.zeros(1))

    def widen(self, m: int) -> None:
        """Add m columns for unknown input values to all rows."""
        self.x, self.y = ([np.pad(a, ((0, 0), (0, m))) for a in arrays] for arrays in (self.x, self.y))
        self.past = [[np.pad(a, ((0, 0), (0, m))) for a in values] for values in self.past]

    def substituted(self, E: np.ndarray) -> "_Rows":
        """Rows over z alone, after the unknown input values were replaced by E z."""
        n = E.shape[1]
        x, y = ([a[:, :n] + a[:, n:] @ E for a in arrays] for arrays in (self.x, self.y))
        return _Rows(self.coupled, self.algorithm, self.h, self.gains, x, y)

    def after(self, past: list[list[np.ndarray]]) -> np.ndarray:
        """Rows of the new state z, given the past outputs at the start of the step."""
        return np.vstack([*self.x, *self.y, *(a for values in past[:-1] for a in values)])
