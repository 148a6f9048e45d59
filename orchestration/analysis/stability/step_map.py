"""The step-to-step map of a coupled system: the algorithm, carried out on matrices.

The state z of a coupled system between two steps is the states of its units, what their outputs show,
and what those showed at earlier communication points as far as polynomials need it. Every number
that occurs in a step is linear in z: a row. So the step of `orchestration.master.algorithm` is carried out as
it stands, with rows in place of numbers; the rows of the new z are the map M, z+ = M z.

Where inputs are corrected, their assumed values e at the end of the step are unknowns beside z. After a
sweep their sources show y = R z + J e. The correction ends where y = e = (I - J)^-1 R z. Repeating sweeps
without relaxation multiplies the error of e by J: it converges if the spectral radius of J is below one.

Units that tick every r steps hold their outputs in between; the map over all phases is a product.
(Stability of co-simulation by the spectral radius of such maps: M. Busch, "Zur effizienten Kopplung von
Simulationsprogrammen", Kassel 2012; C. Gomes et al., "Co-simulation: a survey", ACM CSUR 51(3), 2018.)
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from orchestration.analysis.stability.pulse_response import UnitModel
from orchestration.master.algorithm import FIXED_POINT, SEQUENTIAL, Algorithm
from orchestration.system.system import Connection, System


@dataclass(frozen=True)
class Link:
    """A Real connection between identified units.

    Attributes
    ----------
    source, output, target, input
        Places of the units, and of the variables in them.
    smooth
        Whether both units are continuous, so that the connection may be corrected.
    """

    connection: Connection
    source: int
    output: int
    target: int
    input: int
    smooth: bool


@dataclass(frozen=True)
class Coupled:
    """A linear coupled system.

    Attributes
    ----------
    units
        In the order of the components.
    ratios
        Steps per tick of each unit; 1 for continuous ones.
    """

    units: tuple[UnitModel, ...]
    links: tuple[Link, ...]
    ratios: tuple[int, ...]

    @classmethod
    def of(cls, system: System, units: Sequence[UnitModel], step: float) -> "Coupled":
        """The units of a system with its Real connections."""
        places = {unit.name: i for i, unit in enumerate(units)}
        links = []
        for c in system.connections:
            source, target = units[places[c.source]], units[places[c.target]]
            if c.output in source.outputs and c.input in target.inputs:
                ends = (places[c.source], source.outputs.index(c.output))
                ends += (places[c.target], target.inputs.index(c.input))
                links.append(Link(c, *ends, smooth=source.continuous and target.continuous))
        ratios = system.steps_per_tick(step)
        return cls(tuple(units), tuple(links), tuple(ratios.get(unit.name, 1) for unit in units))

    def radius(self, algorithm: Algorithm, h: float, gains: np.ndarray | None = None) -> float:
        """Spectral radius per step of h, s, with every link multiplied by its gain, shape (n_links,)."""
        n = int(np.lcm.reduce([1, *self.ratios]))
        product, kept = None, {}
        for k in range(n):
            due = tuple(k % ratio == 0 for ratio in self.ratios)
            if due not in kept:
                kept[due] = transition(self, algorithm, h, due, gains)[0]
            product = kept[due] if product is None else kept[due] @ product
        return spectral_radius(product) ** (1 / n) if product is not None else 0.0

    def contraction(self, algorithm: Algorithm, h: float) -> float | None:
        """Spectral radius of the unrelaxed repetition of sweeps; None if nothing is corrected."""
        J = transition(self, algorithm, h, (True,) * len(self.units))[1]
        return None if J is None else spectral_radius(J)

    def ordered(self, order: Sequence[int]) -> "Coupled":
        """The same with its units in another order."""
        place = {old: new for new, old in enumerate(order)}
        links = tuple(
            Link(x.connection, place[x.source], x.output, place[x.target], x.input, x.smooth) for x in self.links
        )
        return Coupled(tuple(self.units[i] for i in order), links, tuple(self.ratios[i] for i in order))


def spectral_radius(M: np.ndarray) -> float:
    """Largest magnitude of an eigenvalue; infinite if M is not finite."""
    if not np.isfinite(M).all():
        return np.inf
    return float(np.abs(np.linalg.eigvals(M)).max(initial=0.0))


def transition(
    coupled: Coupled, algorithm: Algorithm, h: float, due: Sequence[bool], gains: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray | None]:
    """M of one step, and J of its correction if there is one; see the module.

    Parameters
    ----------
    due
        Which units step; a sampled one that does not tick holds.

    Raises
    ------
    LinAlgError
        If I - J is singular: the implicit inputs have no solution.
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
    smooth = [unit.continuous for unit in coupled.units]
    rows.x = [start[i] if smooth[i] else x for i, x in enumerate(rows.x)]
    n, m = rows.width, len(assumed)
    rows.widen(m)
    unknown = np.eye(m, n + m, n)
    rows.sweep(smooth, {j: unknown[[i]] for i, j in enumerate(assumed)}, again=True)
    end = np.vstack([rows.shown(coupled.links[j]) for j in assumed])
    R, J = end[:, :n], end[:, n:]
    if sweeps is None or algorithm.correction.method != FIXED_POINT:
        E = np.linalg.solve(np.eye(m) - J, R)
    else:
        E = np.vstack([first[j] for j in assumed])
        for _ in range(sweeps - 2):
            E = R + J @ E
    return rows.substituted(E).after(past), J


@dataclass
class _Rows:
    """Every number of a step, as rows over z (and the unknowns, once widened).

    `x` and `y` are the units' states and outputs as they are now, `past[a]` the outputs a + 0 steps before t.
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
        units, order = coupled.units, algorithm.order
        sizes = [unit.map.A.shape[0] for unit in units] + (order + 1) * [len(unit.outputs) for unit in units]
        parts = np.split(np.eye(sum(sizes)), np.cumsum(sizes)[:-1])
        n = len(units)
        past = [parts[n * (age + 1) : n * (age + 2)] for age in range(order + 1)]
        return cls(coupled, algorithm, h, gains, parts[:n], list(past[0]), past)

    @property
    def width(self) -> int:
        return self.y[0].shape[1]

    def is_assumed(self, link: Link) -> bool:
        """Whether the source has not stepped when the target's inputs are set, and may step again."""
        sequential = self.algorithm.exchange == SEQUENTIAL
        return link.smooth and not (sequential and link.source < link.target)

    def sweep(self, due: Sequence[bool], ends: dict[int, np.ndarray] | None, again: bool = False) -> None:
        """Step the units that are due; `ends` are the assumed values by link."""
        sequential = self.algorithm.exchange == SEQUENTIAL or again
        inputs = {} if sequential else {i: self.inputs(i, ends) for i, now in enumerate(due) if now}
        for i, now in enumerate(due):
            if now:
                U, map_ = inputs[i] if i in inputs else self.inputs(i, ends), self.coupled.units[i].map
                self.y[i] = map_.C @ self.x[i] + map_.D @ U
                self.x[i] = map_.A @ self.x[i] + map_.B @ U

    def inputs(self, i: int, ends: dict[int, np.ndarray] | None) -> np.ndarray:
        """Values and derivatives of the inputs of unit i, shape ((order + 1) n_inputs, width)."""
        unit = self.coupled.units[i]
        order = min(unit.order, self.algorithm.order)
        U = np.zeros((unit.order + 1, len(unit.inputs), self.width))
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
        return U.reshape((unit.order + 1) * len(unit.inputs), self.width)

    def shown(self, link: Link) -> np.ndarray:
        """What the link's source shows now, shape (1, width)."""
        return self.y[link.source][[link.output]]

    def polynomial(self, link: Link, end: np.ndarray | None) -> tuple[np.ndarray, ...]:
        """Value, first and second derivative at t of the polynomial through `end` and the past."""
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
        """The value that is assumed first at the end of the step."""
        if min(self.coupled.units[link.target].order, self.algorithm.order) == 0:
            return self.past[0][link.source][[link.output]]
        terms = (1.0, self.h, self.h**2 / 2)
        return sum((c * row for c, row in zip(terms, self.polynomial(link, None), strict=False)), np.zeros(1))

    def widen(self, m: int) -> None:
        """Add m unknowns."""
        self.x, self.y = ([np.pad(a, ((0, 0), (0, m))) for a in arrays] for arrays in (self.x, self.y))
        self.past = [[np.pad(a, ((0, 0), (0, m))) for a in values] for values in self.past]

    def substituted(self, E: np.ndarray) -> "_Rows":
        """The unknowns replaced by E z."""
        n = E.shape[1]
        x, y = ([a[:, :n] + a[:, n:] @ E for a in arrays] for arrays in (self.x, self.y))
        return _Rows(self.coupled, self.algorithm, self.h, self.gains, x, y)

    def after(self, past: list[list[np.ndarray]]) -> np.ndarray:
        """The rows of the new z, given the past at t."""
        return np.vstack([*self.x, *self.y, *(a for values in past[:-1] for a in values)])
