"""From an algorithm and an assembled system to the arrays of its steps."""

import ctypes
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import DIFFERENTIATES, INTERPOLATES, REAL, SAVES_STATE
from orchestration.fmi.description import Variable
from orchestration.fmi.instance import Instance
from orchestration.master.algorithm import DIRECTIONAL, NEWTON, SEQUENTIAL, Algorithm, Correction, StepControl
from orchestration.master.flatten import Assembly
from orchestration.master.kernel import coupling as c
from orchestration.master.kernel import flat_system
from orchestration.system.system import Component, Connection, System

SMALLEST_SHARE = 1e-6  # of the system's step: the smallest step, if none is given


@dataclass(frozen=True)
class Crossings:
    """Outputs whose change of sign ends a step.

    Attributes
    ----------
    outputs
        As ``component.variable``, Real.
    tolerance
        How closely the change is located, s.
    """

    outputs: Sequence[str] = ()
    tolerance: float = 1e-9

    def __post_init__(self) -> None:
        """Refuse a tolerance that cannot be met."""
        if not (math.isfinite(self.tolerance) and self.tolerance > 0):
            msg = f"The tolerance of crossings, {self.tolerance!r} s, is not positive and finite."
            raise SystemDescriptionError(msg)


@dataclass(frozen=True)
class Layout:
    """The arrays, and what they mean to a reader.

    Attributes
    ----------
    connections
        The connection of each Real link, then of each discrete one.
    watched
        Names of the values under step control.
    alive
        Arrays to which others hold addresses.
    """

    method: c.Method
    coupling: c.Coupling
    work: c.Work
    connections: tuple[Connection, ...]
    watched: tuple[str, ...]
    alive: tuple[np.ndarray, ...] = field(repr=False)

    def free(self, instances: Sequence[Instance]) -> None:
        """Free the states that were saved."""
        for states in self.work.states:
            for i, instance in enumerate(instances):
                if states[i]:
                    instance.status("fmi2FreeFMUstate", ctypes.byref(ctypes.c_void_p(int(states[i]))))
            states[:] = 0


def check_crossings(system: System, crossings: Crossings) -> None:
    """Refuse names that are no Real outputs."""
    for name in crossings.outputs:
        variable = system.resolve(name)[1]
        if variable.causality != "output" or variable.type != REAL:
            msg = f"{name} is a {variable.type} of causality {variable.causality}; crossings need a Real output."
            raise SystemDescriptionError(msg)


def check_capabilities(system: System, algorithm: Algorithm, crossings: Crossings, ratios: Mapping[str, int]) -> None:
    """Refuse what the units, or the choices together, do not allow.

    Raises
    ------
    SystemDescriptionError
        Naming the component that lacks a capability, or the choices that exclude each other.
    """
    for component in system.components:
        if crossings.outputs or algorithm.control is not None or (algorithm.rolls_back and component.continuous):
            what = "locating crossings" if crossings.outputs else f"algorithm {algorithm.name}"
            _require(component, SAVES_STATE, what)
        correction = algorithm.correction
        if correction is not None and correction.jacobian == DIRECTIONAL and component.continuous:
            _require(component, DIFFERENTIATES, "a Jacobian from directional derivatives")
    for name in ratios:
        system.component(name)
    if any(ratio > 1 for ratio in ratios.values()) and (algorithm.rolls_back or crossings.outputs):
        msg = f"Steps of several lengths do not go together with algorithm {algorithm.name} or crossings."
        raise SystemDescriptionError(msg)


@dataclass(frozen=True)
class Experiment:
    """What a layout needs to know of a run.

    Attributes
    ----------
    step, interval, duration
        The communication step, the time between two points that steps must end on, the run, s.
    ratios
        Steps per step of a component, by name; 1 where none is given.
    """

    step: float
    interval: float
    duration: float
    ratios: Mapping[str, int]
    crossings: Crossings


def layout(
    system: System,
    instances: Sequence[Instance],
    assembly: Assembly,
    algorithm: Algorithm,
    experiment: Experiment,
) -> Layout:
    """Lay out the arrays for a run; `check_capabilities` has passed."""
    connections = (*assembly.real_connections, *assembly.discrete_connections)
    links, n_rates = _links(system, assembly, algorithm, experiment.ratios)
    rates, states = np.zeros(n_rates), np.zeros((c.LEVELS, len(instances)), np.int64)
    references = np.array([_target(system, x)[1].reference for x in assembly.real_connections], np.uint32)
    one = np.ones(1)
    links[:, c.REFERENCE] = references.ctypes.data + references.itemsize * np.arange(len(links))
    links[:, c.ONE] = one.ctypes.data
    units, alive = _units(system, instances, experiment.ratios, links, references)
    units[:, c.RATES_VALUES] = rates.ctypes.data + rates.itemsize * units[:, c.RATES_VALUES]
    for level in range(c.LEVELS):
        units[:, c.SAVED + level] = states[level].ctypes.data + states.itemsize * np.arange(len(instances))
    watched = [x for x in assembly.real_outputs if system.resolve(x)[0].continuous]
    coupling = c.Coupling(
        units,
        links,
        _tolerances([_source_unit(system, x) for x in assembly.real_connections], algorithm.correction),
        np.flatnonzero(links[:, c.ASSUMED]),
        np.array(
            [j for j, x in enumerate(assembly.discrete_connections) if _target(system, x)[0].continuous], np.int64
        ),
        np.array([assembly.real_outputs[x] for x in watched], np.int64),
        np.array([not system.resolve(x)[1].direct for x in watched], np.int64),
        _tolerances([system.resolve(x)[1].unit for x in watched], algorithm.control),
        np.array([assembly.real_outputs[x] for x in experiment.crossings.outputs], np.int64),
        _limits(algorithm.control, experiment),
    )
    work = _work(rates, states, (len(assembly.plan.reals), len(assembly.plan.discretes), len(coupling.assumed)))
    work.numbers[c.NEXT_STEP] = coupling.limits[0]
    return Layout(
        _method(system, algorithm, links),
        coupling,
        work,
        connections,
        tuple(watched),
        (references, one, *alive, *assembly.alive),
    )


def _links(
    system: System, assembly: Assembly, algorithm: Algorithm, ratios: Mapping[str, int]
) -> tuple[np.ndarray, int]:
    """The table of links without addresses, and the number of input derivatives."""
    plan, position = assembly.plan, {component.name: i for i, component in enumerate(system.components)}
    links = np.full((len(plan.real_links), c.N_LINK_COLUMNS), -1, np.int64)
    links[:, (c.SOURCE, c.TARGET)] = plan.real_links
    n_rates = 0
    for i, target in enumerate(system.components):
        rows = np.arange(plan.table[i, flat_system.FIRST_REAL], plan.table[i, flat_system.END_REAL])
        smooth = []
        for j in rows:
            source = system.component(assembly.real_connections[j].source)
            fresh = algorithm.exchange == SEQUENTIAL and position[source.name] < i
            links[j, c.TARGET_UNIT] = i
            links[j, c.FRESH] = fresh
            single = ratios.get(source.name, 1) == ratios.get(target.name, 1) == 1
            if single and source.continuous and target.continuous and target.description.can(INTERPOLATES):
                smooth.append(j)
        assumed = algorithm.correction is not None or algorithm.order > 0
        links[rows, c.ASSUMED] = assumed and target.continuous and (links[rows, c.FRESH] == 0)
        for order, column in ((1, c.RATE_1), (2, c.RATE_2)):
            if algorithm.order >= order:
                links[smooth, column] = n_rates + np.arange(len(smooth))
                n_rates += len(smooth)
    return links, n_rates


def _units(
    system: System,
    instances: Sequence[Instance],
    ratios: Mapping[str, int],
    links: np.ndarray,
    references: np.ndarray,
) -> tuple[np.ndarray, list[np.ndarray]]:
    """The table of units, with places instead of addresses of the rates, and the arrays it points to."""
    units, alive = np.zeros((len(instances), c.N_UNIT_COLUMNS), np.int64), []
    for i, (component, instance) in enumerate(zip(system.components, instances, strict=True)):
        units[i, c.GET_STATE] = instance.address("fmi2GetFMUstate")
        units[i, c.SET_STATE] = instance.address("fmi2SetFMUstate")
        units[i, c.GET_DIRECTION] = instance.address("fmi2GetDirectionalDerivative")
        units[i, c.CONTINUOUS] = component.continuous
        units[i, c.RATIO] = ratios.get(component.name, 1)
        mine = links[:, c.TARGET_UNIT] == i
        moving = [np.flatnonzero(mine & (links[:, column] >= 0)) for column in (c.RATE_1, c.RATE_2)]
        if len(moving[0]):
            listed = references[np.concatenate(moving)]
            orders = np.repeat(np.array([1, 2], np.int32), [len(m) for m in moving])
            alive += [listed, orders]
            units[i, c.RATES_FUNCTION] = instance.address("fmi2SetRealInputDerivatives")
            units[i, c.RATES_REFERENCES] = listed.ctypes.data
            units[i, c.RATES_ORDERS] = orders.ctypes.data
            units[i, c.RATES_COUNT] = len(listed)
            units[i, c.RATES_VALUES] = links[moving[0][0], c.RATE_1]
    return units, alive


def _method(system: System, algorithm: Algorithm, links: np.ndarray) -> c.Method:
    """The algorithm as numbers; the estimated error is of the order of inputs that are merely held."""
    correction = algorithm.correction
    savable = all(x.description.can(SAVES_STATE) for x in system.components if x.continuous)
    held = links[(links[:, c.FRESH] >= 0) & (links[:, c.RATE_1] < 0)]
    return c.Method(
        sequential=algorithm.exchange == SEQUENTIAL,
        order=algorithm.order,
        newton=correction is not None and correction.method == NEWTON,
        directional=correction is not None and correction.jacobian == DIRECTIONAL,
        sweeps=(correction.sweeps or 0) if correction is not None else 0,
        max_iterations=correction.max_iterations if correction is not None else 0,
        restarts=correction is None and bool((links[:, c.RATE_1] >= 0).any()) and savable,
        controlled=algorithm.control is not None,
        error_order=1 if len(held) else algorithm.order + 1,
    )


def _work(rates: np.ndarray, states: np.ndarray, sizes: tuple[int, int, int]) -> c.Work:
    n_reals, n_discretes, n_assumed = sizes
    n_links = n_reals  # no more links than inputs, each with a place of its own
    return c.Work(
        rates=rates,
        past=np.zeros((c.N_PAST_KEPT, n_reals)),
        past_times=np.zeros(c.N_PAST_KEPT),
        end=np.zeros(n_links),
        residual=np.zeros(n_assumed),
        last_residual=np.zeros(n_assumed),
        pair_start=np.zeros(n_assumed),
        pair_residual=np.zeros(n_assumed),
        states=states,
        kept_reals=np.zeros(n_reals),
        kept_discretes=np.zeros(n_discretes, np.int32),
        kept_past=np.zeros((c.N_PAST_KEPT, n_reals)),
        kept_times=np.zeros(c.N_PAST_KEPT),
        kept_integers=np.zeros(c.N_INTEGERS, np.int64),
        whole=np.zeros(n_reals),
        trial=np.zeros(n_reals),
        jacobian=np.zeros((n_assumed, n_assumed)),
        pivots=np.zeros(n_assumed, np.int64),
        scratch=np.zeros(n_assumed),
        integers=np.zeros(c.N_INTEGERS, np.int64),
        numbers=np.zeros(c.N_NUMBERS),
    )


def _limits(control: StepControl | None, experiment: Experiment) -> np.ndarray:
    control = control or StepControl()
    return np.array(
        [
            control.first or experiment.step,
            control.smallest or SMALLEST_SHARE * experiment.step,
            control.largest or experiment.interval,
            experiment.duration,
            experiment.crossings.tolerance,
        ]
    )


def _tolerances(units: Sequence[str], owner: Correction | StepControl | None) -> np.ndarray:
    """Absolute and relative tolerance for values of these units, shape (n, 2)."""
    if owner is None:
        return np.ones((len(units), 2))
    tolerance = owner.tolerance
    return np.array([(tolerance.absolute_of(unit), tolerance.relative) for unit in units]).reshape(-1, 2)


def _target(system: System, connection: Connection) -> tuple[Component, Variable]:
    return system.resolve(f"{connection.target}.{connection.input}")


def _source_unit(system: System, connection: Connection) -> str:
    return system.component(connection.source).variable(connection.output).unit


def _require(component: Component, capability: str, what: str) -> None:
    if not component.description.can(capability):
        name = component.description.path.name
        msg = f"{component.name}: {name} does not declare {capability}, which {what} needs."
        raise SystemDescriptionError(msg)
