"""Makes the arrays that a co-simulation algorithm needs in a run, from the algorithm, the system and its flat form."""

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from orchestration.fmi.codes import INTERPOLATES, SAVES_STATE
from orchestration.fmi.description import Variable
from orchestration.fmi.instance import Instance
from orchestration.master.algorithm import DIRECTIONAL, NEWTON, SEQUENTIAL, Algorithm, Correction, StepControl
from orchestration.master.flatten import Assembly
from orchestration.master.kernel.codes import (
    LINK,
    METHOD,
    N_LEVELS,
    N_ROWS,
    STATE,
    WATCHED,
    Column,
    Group,
    Row,
)
from orchestration.master.kernel.coupling import Coupling
from orchestration.master.kernel.records import Method, Records, Watched
from orchestration.master.kernel.series import Column as SeriesColumn
from orchestration.master.kernel.series import Form as SeriesForm
from orchestration.master.kernel.series import address as series_address
from orchestration.master.memory import require_matrix
from orchestration.master.options import Crossings, Options
from orchestration.master.time_grid import Grid
from orchestration.system.system import Component, Connection, System

SMALLEST_SHARE = 1e-6  # of the system's step: the smallest step, if none is given


@dataclass(frozen=True)
class Layout:
    """The arrays of a run for the compiled loop, and the names behind their rows.

    Attributes
    ----------
    state
        Array of shape (1,) whose record is the `state` of the coupling.
    connections
        Connection of each Real link, then of each discrete link.
    watched
        Names of the values under step control.
    alive
        Arrays that must outlive the run, because other arrays hold their addresses.
    """

    coupling: Coupling
    state: np.ndarray
    connections: tuple[Connection, ...]
    watched: tuple[str, ...]
    alive: tuple[np.ndarray, ...] = field(repr=False)

    def free(self, instances: Sequence[Instance]) -> None:
        """Free the states that were saved."""
        for states in self.coupling.states:
            for i, instance in enumerate(instances):
                if states[i]:
                    instance.status("fmi2FreeFMUstate", ctypes.byref(ctypes.c_void_p(int(states[i]))))
            states[:] = 0

    def start(self, reals: np.ndarray, time: float) -> None:
        """Begin a run at a time, s, with the given Real values as the only past."""
        history, state = self.coupling.history, self.coupling.state
        history[Row.LAST, :-1], history[Row.LAST, -1] = reals, time
        state.n_past, state.time, state.next_step = 1, time, self.coupling.method.first_step

    def save(self) -> dict[str, np.ndarray]:
        """Return copies of all arrays that change in a run, without the buffers of values."""
        return {name: array.copy() for name, array in self.changing().items()}

    def restore(self, arrays: Mapping[str, np.ndarray]) -> None:
        """Restore the arrays that `save` returned."""
        for name, array in self.changing().items():
            array[...] = arrays[name]

    def changing(self) -> dict[str, np.ndarray]:
        """Return the arrays that change in a run, by name."""
        c = self.coupling
        links = {name: c.links[name] for name in ("end", "residual", "last_residual")}
        past = c.history[: Row.KEPT_LAST]
        return {"past": past, "jacobian": c.jacobian, "pivots": c.pivots, "state": self.state, **links}


@dataclass(frozen=True)
class Experiment:
    """The times of a run, and the steps of its components.

    Attributes
    ----------
    step, interval, duration
        Communication step, time between two points that steps must end on, and duration of the run, s.
    ratios
        Communication steps per step of a component, by name; a component that is missing has 1.
    """

    step: float
    interval: float
    duration: float
    ratios: Mapping[str, int]
    crossings: Crossings

    @classmethod
    def of(cls, grid: Grid, options: Options) -> "Experiment":
        """The experiment of a run with these communication points and options."""
        duration = float(grid.times[-1] - grid.times[0])
        return cls(grid.step, float(np.max(grid.lengths)), duration, options.ratios, options.crossings)


def layout(
    system: System,
    instances: Sequence[Instance],
    assembly: Assembly,
    algorithm: Algorithm,
    experiment: Experiment,
    series: np.ndarray | None = None,
) -> Layout:
    """Make the arrays for a run; `orchestration.master.capabilities` has accepted the run before.

    The table of time series, which has a row for each input in ``assembly.driven``, gets the addresses of the inputs'
    derivatives.
    """
    plan, n = assembly.plan, len(instances)
    connections = (*assembly.real_connections, *assembly.discrete_connections)
    straight = _straight(assembly, series)
    links, rate_of, n_rates = _links(system, assembly, algorithm, experiment.ratios, straight)
    rates, states, one = np.zeros(n_rates), np.zeros((N_LEVELS, n), np.int64), np.ones(1)
    history, kept_discretes = np.zeros((N_ROWS, len(plan.reals) + 1)), np.zeros_like(plan.discretes)
    references = np.array([_target(system, x)[1].reference for x in assembly.real_connections], np.uint32)
    links.reference = references.ctypes.data + references.itemsize * np.arange(len(links))
    listed = _fill_table(system, instances, assembly, experiment.ratios, (links, references, rates, rate_of))
    if series is not None:
        for row, name in zip(series[1:], assembly.driven, strict=True):
            row[SeriesColumn.RATE] = rates.ctypes.data + rates.itemsize * rate_of[name] if name in rate_of else 0
    watched = [x for x in assembly.real_outputs if system.resolve(x)[0].continuous]
    assumed = np.flatnonzero(links.assumed)
    method, state = _method(system, algorithm, links, experiment), np.zeros(1, STATE).view(np.recarray)
    method.one, method.saved_states = one.ctypes.data, states.ctypes.data
    method.history, method.reals = history.ctypes.data, plan.reals.ctypes.data
    method.discretes, method.kept_discretes = plan.discretes.ctypes.data, kept_discretes.ctypes.data
    if series is not None:
        method.give, method.series = series_address(), series.ctypes.data
    if any(system.resolve(name)[0].continuous and name not in rate_of for name in straight):
        method.error_order = 1
    coupling = Coupling(
        table=plan.table,
        discrete_links=plan.discrete_links,
        reals=plan.reals,
        discretes=plan.discretes,
        links=links,
        history=history,
        rates=rates,
        states=states,
        assumed=assumed,
        exact=_exact(system, assembly),
        watched=_watched(system, assembly, watched, algorithm.control),
        crossings=np.array([assembly.real_outputs[x] for x in experiment.crossings.outputs], np.int64),
        jacobian=_jacobian(system.name, len(assumed) if method.newton else 0),
        pivots=np.zeros(len(assumed), np.int64),
        method=method,
        state=state[0],
    )
    return Layout(
        coupling, state, connections, tuple(watched), (references, one, kept_discretes, *listed, *assembly.alive)
    )


def _jacobian(name: str, n: int) -> np.ndarray:
    """Memory for the Jacobian of n assumed inputs and a right side; none is needed without Newton's method."""
    require_matrix(name, n)
    return np.zeros((n, n + 1))


def _straight(assembly: Assembly, series: np.ndarray | None) -> list[str]:
    """Return the inputs whose time series move in straight lines."""
    rows = [] if series is None else series[1:]
    return [
        name for row, name in zip(rows, assembly.driven, strict=True) if row[SeriesColumn.FORM] == SeriesForm.LINEAR
    ]


def _links(
    system: System, assembly: Assembly, algorithm: Algorithm, ratios: Mapping[str, int], straight: Sequence[str]
) -> tuple[np.recarray, dict[str, int], int]:
    """Return the links, still without addresses, and the places and the number of the input derivatives.

    The places are those of inputs with time series; links have their own. The derivatives of a component are
    neighbours: the first ones of its links, the second ones of its links, those of its series.
    """
    plan, position = assembly.plan, {component.name: i for i, component in enumerate(system.components)}
    links = np.zeros(len(plan.real_links), LINK).view(np.recarray)
    links.source, links.target = plan.real_links[:, 0], plan.real_links[:, 1]
    links["rate"] = links["curvature"] = -1
    links.absolute, links.relative = _tolerances(
        [_source_unit(system, x) for x in assembly.real_connections], algorithm.correction
    )
    n_rates, rate_of = 0, {}
    straight_of: dict[str, list[str]] = {}
    for name in straight:
        straight_of.setdefault(name.partition(".")[0], []).append(name)
    for i, target in enumerate(system.components):
        rows = np.arange(plan.table[i, Column.FIRST_REAL], plan.table[i, Column.END_REAL])
        smooth = []
        for j in rows:
            source = system.component(assembly.real_connections[j].source)
            links.component[j] = i
            links.fresh[j] = algorithm.exchange == SEQUENTIAL and position[source.name] < i
            held = source.variable(assembly.real_connections[j].output).stands_for
            if ratios.get(source.name, 1) == 1 and source.continuous and _moves(target, ratios) and not held:
                smooth.append(j)
        assumed = algorithm.correction is not None or algorithm.order > 0
        links.assumed[rows] = assumed and target.continuous and (links.fresh[rows] == 0)
        for order, places in ((1, links.rate), (2, links.curvature)):
            if algorithm.order >= order:
                places[smooth] = n_rates + np.arange(len(smooth))
                n_rates += len(smooth)
        if algorithm.order > 0 and _moves(target, ratios):
            mine = straight_of.get(target.name, [])
            rate_of |= {name: n_rates + k for k, name in enumerate(mine)}
            n_rates += len(mine)
    return links, rate_of, n_rates


def _moves(target: Component, ratios: Mapping[str, int]) -> bool:
    """Whether inputs of a component may move within a communication step."""
    return ratios.get(target.name, 1) == 1 and target.continuous and target.description.can(INTERPOLATES)


def _fill_table(
    system: System,
    instances: Sequence[Instance],
    assembly: Assembly,
    ratios: Mapping[str, int],
    moving: tuple[np.recarray, np.ndarray, np.ndarray, Mapping[str, int]],
) -> list[np.ndarray]:
    """Fill the columns of the table that the loop of all algorithms needs; returns the arrays behind addresses.

    `moving` holds the links, the value references of their inputs, the input derivatives, and the places of those of
    inputs with time series.
    """
    links, references, rates, rate_of = moving
    alive = []
    places_of: dict[str, dict[str, int]] = {}
    for name, place in rate_of.items():
        places_of.setdefault(name.partition(".")[0], {})[name] = place
    for i, (component, instance) in enumerate(zip(system.components, instances, strict=True)):
        row = assembly.plan.table[i]
        row[Column.GET_STATE] = instance.address("fmi2GetFMUstate")
        row[Column.SET_STATE] = instance.address("fmi2SetFMUstate")
        row[Column.GET_DIRECTION] = instance.address("fmi2GetDirectionalDerivative")
        row[Column.IS_CONTINUOUS] = component.continuous
        row[Column.RATIO] = ratios.get(component.name, 1)
        mine = np.arange(row[Column.FIRST_REAL], row[Column.END_REAL])
        smooth = [mine[places[mine] >= 0] for places in (links.rate, links.curvature)]
        given = places_of.get(component.name, {})
        if len(smooth[0]) or given:
            driven = np.array([system.resolve(name)[1].reference for name in given], np.uint32)
            listed = np.concatenate([references[np.concatenate(smooth)], driven])
            orders = np.repeat(np.array([1, 2, 1], np.int32), [*(len(m) for m in smooth), len(given)])
            first = min([*links.rate[smooth[0]], *given.values()])
            alive += [listed, orders]
            group = row[Column.SET_RATES :]
            group[Group.FUNCTION] = instance.address("fmi2SetRealInputDerivatives")
            group[Group.REFERENCES] = listed.ctypes.data
            group[Group.COUNT] = len(listed)
            group[Group.VALUES] = rates.ctypes.data + rates.itemsize * first
            group[Group.ORDERS] = orders.ctypes.data
    return alive


def _method(system: System, algorithm: Algorithm, links: np.recarray, experiment: Experiment) -> Method:
    """Return the algorithm as numbers; the order of the estimated error is that of held inputs."""
    correction, control = algorithm.correction, algorithm.control or StepControl()
    savable = all(x.description.can(SAVES_STATE) for x in system.components if x.continuous)
    method: Method = np.zeros(1, METHOD).view(np.recarray)[0]
    method.sequential = algorithm.exchange == SEQUENTIAL
    method.order = algorithm.order
    if correction is not None:
        method.newton = correction.method == NEWTON
        method.directional = correction.jacobian == DIRECTIONAL
        method.sweeps = correction.sweeps or 0
        method.max_iterations = correction.max_iterations
    method.restarts = correction is None and bool((links.rate >= 0).any()) and savable
    method.controlled = algorithm.control is not None
    method.error_order = 1 if (links.rate < 0).any() else algorithm.order + 1
    method.first_step = control.first or experiment.step
    method.smallest_step = control.smallest or SMALLEST_SHARE * experiment.step
    method.largest_step = control.largest or experiment.interval
    method.duration = experiment.duration
    method.crossing_tolerance = experiment.crossings.tolerance
    return method


def _exact(system: System, assembly: Assembly) -> np.ndarray:
    """Return the discrete links into continuous components."""
    targets = [_target(system, connection)[0] for connection in assembly.discrete_connections]
    return np.array([j for j, component in enumerate(targets) if component.continuous], np.int64)


def _watched(system: System, assembly: Assembly, names: Sequence[str], control: StepControl | None) -> Records[Watched]:
    """Return the values under step control; errors of outputs with direct feedthrough do not add up."""
    watched = np.zeros(len(names), WATCHED).view(np.recarray)
    watched.index = [assembly.real_outputs[x] for x in names]
    watched.accumulates = [not system.resolve(x)[1].direct for x in names]
    watched.absolute, watched.relative = _tolerances([system.resolve(x)[1].unit for x in names], control)
    return watched


def _tolerances(units: Sequence[str], owner: Correction | StepControl | None) -> np.ndarray:
    """Return the absolute and relative tolerances for values in the given physical units, shape (2, n)."""
    if owner is None:
        return np.ones((2, len(units)))
    tolerance = owner.tolerance
    return np.array([(tolerance.absolute_of(unit), tolerance.relative) for unit in units]).reshape(-1, 2).T


def _target(system: System, connection: Connection) -> tuple[Component, Variable]:
    return system.resolve(f"{connection.target}.{connection.input}")


def _source_unit(system: System, connection: Connection) -> str:
    return system.component(connection.source).variable(connection.output).unit
