"""How the components of a system are instantiated and brought through the initialization mode of FMI 2.0."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np

from orchestration.errors import InitializationError
from orchestration.fmi.blame import blaming
from orchestration.fmi.codes import ONE_INSTANCE, REAL, accepted
from orchestration.fmi.display import listed
from orchestration.fmi.experiment import UNKNOWN, Experiment
from orchestration.fmi.instance import Instance
from orchestration.fmi.isolation import Isolation
from orchestration.fmi.library import needed_to_run
from orchestration.fmi.remote_library import start_process
from orchestration.fmi.start_values import by_time
from orchestration.fmi.units import Linear
from orchestration.master.algebraic_loops import solve_loops
from orchestration.master.feedthrough import chain_of_feedthrough
from orchestration.master.flatten import Assembly
from orchestration.master.kernel.codes import CALL_NAMES, Column
from orchestration.master.kernel.flat_system import Plan, copy_links, get_outputs, set_inputs
from orchestration.master.kernel.series import give
from orchestration.master.safeguard import exposed
from orchestration.sandbox.archive import unpacked
from orchestration.sandbox.guard import Guard
from orchestration.sandbox.remote import RemoteProcess
from orchestration.stages import stage
from orchestration.system.system import Component, System

MOST_WHOLE = 500
"""Connections up to which a system is solved whole if it has an algebraic loop; a bigger one without what settles."""
LONG_CHAIN = 20
"""Components in a row, at the least, that are passed through in their order: a pass moves values by one component."""


@contextmanager
def opened(system: System, isolation: Isolation | None = None, guard: Guard | None = None) -> Iterator[list[Instance]]:
    """Instantiate every component of a system; the end of the context frees all instances.

    The FMUs of components that the isolation covers live in processes of their own. What others change in this
    process is put back.

    Yields
    ------
    list of Instance
        Instances in the order of the components.

    Raises
    ------
    ArchiveError
        If an FMU cannot be unpacked safely.
    InitializationError
        If a library cannot be loaded, or an FMU refuses to be instantiated.
    """
    with ExitStack() as stack:
        folders: dict[tuple[Path, str], Path] = {}
        instances, scales = [], input_scales(system)
        processes = stack.enter_context(_processes(system, isolation))
        guard = guard or Guard()
        for component in system.components:
            path, alone = component.description.path, component.description.can(ONE_INSTANCE)
            key = (path, component.name if alone else "")
            process = processes.get(component.name)
            with blaming(f"{component.name}: {path.name}", path):
                if key not in folders:  # a copy of the library has a memory of its own
                    with stage(f"unpacking {path.name}", f"unpacked {path.name} of {component.name}"):
                        folders[key] = stack.enter_context(unpacked(path, needed_to_run))
                with guard.over([component.name] if process is None else [], "while it was loaded and instantiated"):
                    instance = Instance.open(component.name, component.description, folders[key], process=process)
            stack.callback(_close, instance, guard)
            if component.name in scales:
                instance.scale_inputs(scales[component.name])
            instances.append(instance)
        yield instances


def _close(instance: Instance, guard: Guard) -> None:
    with guard.over(exposed([instance]), "while it was freed"):
        instance.close()


@contextmanager
def _processes(system: System, isolation: Isolation | None) -> Iterator[dict[str, RemoteProcess]]:
    """Start the processes of isolated components side by side, because each takes a while; by component name."""
    with ExitStack() as stack:
        started = {}
        for component in system.components if isolation is not None else ():
            if isolation is not None and isolation.covers(component.name):
                process = start_process(isolation, len(component.description.variables))
                stack.callback(process.close)
                started[component.name] = process
        yield started


def input_scales(system: System) -> dict[str, dict[int, Linear]]:
    """Conversions of inputs by their value references, of each component that has any."""
    found: dict[str, dict[int, Linear]] = {}
    for c in system.connections:
        if not c.scale.trivial:
            found.setdefault(c.target, {})[system.component(c.target).variable(c.input).reference] = c.scale
    return found


def initialize(
    system: System,
    instances: Sequence[Instance],
    assembly: Assembly,
    t0: float,
    series: tuple[np.ndarray, float] | None = None,
    *,
    guard: Guard | None = None,
    experiment: Experiment = UNKNOWN,
) -> None:
    """Set start values, propagate outputs to inputs in initialization mode, and leave this mode.

    Inputs get their start values in initialization mode, all other variables before it (FMI 2.0.4, section 4.2.4).
    Outputs are transferred to inputs until nothing changes, so a chain of any length settles. What does
    not settle is an algebraic loop, which `solve_loops` solves. Afterwards the buffers of `assembly`
    hold the outputs of row 0.

    Parameters
    ----------
    system
        System with start values and connections.
    instances
        Instances in the order of the components.
    assembly
        Buffers and links of the system as flat arrays.
    t0
        Start time, s.
    series
        Table of time series, whose inputs get their values for the first step, and the length of this step, s. None
        without series.
    guard
        Puts back what an FMU changes in this process.
    experiment
        Stop time and tolerance that the FMUs are told. An FMU is told the tolerance of its own default experiment if
        no other is given.

    Raises
    ------
    InitializationError
        If a call fails, or an algebraic loop has no solution near the start values.
    """
    counted = f"{len(instances)} component{'s' if len(instances) != 1 else ''} of {system.name}"
    with stage(f"initializing {counted}", f"initialized {counted}"):
        guard = guard or Guard()
        for component, instance in zip(system.components, instances, strict=True):
            with guard.over(exposed([instance]), "while it was initialized"):
                _start(component, instance, t0, experiment)
        with guard.over(exposed(instances), "while it was initialized"):
            if series is not None:
                give(series[0], t0, series[1])
            _propagate(system, instances, assembly)
            for instance in instances:
                instance.call("fmi2ExitInitializationMode")
            _get_all(instances, assembly)


def _start(component: Component, instance: Instance, t0: float, experiment: Experiment) -> None:
    """Set the start values of a component, and enter initialization mode."""
    before, within = by_time(component.description, component.start)
    set_values(component, instance, before)
    if experiment.tolerance is None:
        experiment = replace(experiment, tolerance=component.description.experiment.tolerance)
    instance.set_up(t0, experiment)
    instance.call("fmi2EnterInitializationMode")
    set_values(component, instance, within)


def set_values(component: Component, instance: Instance, values: Mapping[str, float | str]) -> None:
    """Set variables of an instance, one call for each variable.

    Parameters
    ----------
    component
        Component that declares the variables.
    instance
        Instance of the component.
    values
        Numbers, and texts of Strings, by variable name, in the physical units that the FMU declares.

    Raises
    ------
    InitializationError
        If the FMU refuses a value.
    """
    for name, value in values.items():
        variable = component.variable(name)
        given = value.encode() if isinstance(value, str) else value if variable.type == REAL else int(value)
        status = instance.set(variable.type, [variable.reference], [given])
        if not accepted(status):
            raise InitializationError(instance.failure(f"fmi2Set{variable.type}", status))


def _propagate(system: System, instances: Sequence[Instance], assembly: Assembly) -> None:
    """Transfer outputs to inputs until nothing changes, or solve the algebraic loops that remain."""
    plan = assembly.plan
    _get_all(instances, assembly)
    for i in chain_of_feedthrough(system, LONG_CHAIN):
        _transfer(assembly, i)
        _exchange(instances[i], plan, i)
    moved: Iterable[int] = range(len(instances))
    # A chain passes through each connection at most once, after what drives it from outside; anything longer is an
    # algebraic loop.
    for _ in range(len(system.connections) + 1 + bool(assembly.driven)):
        before = plan.reals.copy(), plan.discretes.copy()
        for i in moved:
            _transfer(assembly, i)
            _raise_failure(instances[i], *set_inputs(plan.table, i))
        for i in moved:
            _raise_failure(instances[i], *get_outputs(plan.table, i))
        if _same(before[0], plan.reals) and _same(before[1], plan.discretes):
            return
        moved = _behind(plan)

    if len(plan.real_links) <= MOST_WHOLE:
        moved = range(len(instances))
    ranges = [np.arange(*plan.table[i, [Column.FIRST_REAL, Column.END_REAL]]) for i in moved]
    chosen = np.concatenate([np.empty(0, np.int64), *ranges])

    def evaluate(i: int | None) -> None:
        for k in moved if i is None else (i,):
            row = plan.table[k]
            copy_links(plan.discrete_links, row[Column.FIRST_DISCRETE], row[Column.END_DISCRETE], plan.discretes)
            _exchange(instances[k], plan, k)

    solve_loops(system.name, assembly, evaluate, chosen)
    settled = plan.discretes.copy()
    evaluate(None)
    if not _same(settled, plan.discretes):
        changed = set(np.flatnonzero(settled != plan.discretes).tolist())
        pairs = zip(plan.discrete_links[:, 0].tolist(), assembly.discrete_connections, strict=True)
        loop = listed([str(connection) for source, connection in pairs if source in changed])
        msg = f"System {system.name}: discrete values do not settle during initialization in a loop of {loop}."
        raise InitializationError(msg)


def _exchange(instance: Instance, plan: Plan, i: int) -> None:
    """Set the inputs of component i, and get its outputs."""
    _raise_failure(instance, *set_inputs(plan.table, i))
    _raise_failure(instance, *get_outputs(plan.table, i))


def _behind(plan: Plan) -> list[int]:
    """Components with an input that differs, bit by bit, from the output that drives it."""
    found = []
    for links, values, end in (
        (plan.real_links, plan.reals.view(np.int64), Column.END_REAL),
        (plan.discrete_links, plan.discretes, Column.END_DISCRETE),
    ):
        differ = np.flatnonzero(values[links[:, 0]] != values[links[:, 1]])
        found.append(np.searchsorted(plan.table[:, end], differ, side="right"))  # links are in order of components
    return np.unique(np.concatenate(found)).tolist()


def _transfer(assembly: Assembly, i: int) -> None:
    """Copy the outputs that drive component i to the inputs of component i."""
    plan = assembly.plan
    row = plan.table[i]
    copy_links(plan.real_links, row[Column.FIRST_REAL], row[Column.END_REAL], plan.reals)
    copy_links(plan.discrete_links, row[Column.FIRST_DISCRETE], row[Column.END_DISCRETE], plan.discretes)


def _get_all(instances: Sequence[Instance], assembly: Assembly) -> None:
    """Get the outputs of all instances into the buffers."""
    for i, instance in enumerate(instances):
        _raise_failure(instance, *get_outputs(assembly.plan.table, i))


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    """Compare two arrays bit by bit, so that NaN equals NaN."""
    return a.tobytes() == b.tobytes()


def _raise_failure(instance: Instance, call: int, status: int) -> None:
    """Raise an error if a call did not succeed."""
    if not accepted(status):
        raise InitializationError(instance.failure(CALL_NAMES[Column(call)], status, " during initialization"))
