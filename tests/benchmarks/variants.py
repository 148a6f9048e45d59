"""One system, five instances, and the loops over them that run in this process.

Every loop starts from the same saved states and buffers, restored outside the measured time.
"""

import ctypes
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np

from orchestration import loop
from orchestration.assembly import Assembly, assemble
from orchestration.fmu import BOOLEAN, INTEGER, REAL, Instance
from orchestration.initialize import initialize, opened
from orchestration.system import Component, System
from tests.benchmarks.native import COMPONENTS, BareUnits, CLoop

Measure = Callable[[int], np.ndarray]  # number of steps -> wall times of its pieces, s
PIECE = 500  # steps of a piece: so short that many pieces are made without an interruption


class BenchmarkError(RuntimeError):
    """A loop failed, or did not compute what it should."""


@dataclass(frozen=True)
class Bench:
    """The system, initialized, with all outputs recorded.

    Attributes
    ----------
    times
        Communication points, s, shape (n_steps + 1,).
    step
        s.
    rows
        Where the loops record, touched before, shape (n_steps + 1, n_columns).
    """

    system: System
    instances: list[Instance]
    assembly: Assembly
    bare: BareUnits
    c: CLoop
    times: np.ndarray
    step: float
    rows: np.ndarray
    _saved: tuple[ctypes.c_void_p, ...]
    _buffers: tuple[np.ndarray, np.ndarray]
    _values: Mapping[str, np.ndarray]

    def restore(self) -> None:
        """Back to the state after initialization; row 0 of the records is written."""
        for instance, state in zip(self.instances, self._saved, strict=True):
            instance.call("fmi2SetFMUstate", state)
        self.assembly.plan.reals[:] = self._buffers[0]
        self.assembly.plan.discretes[:] = self._buffers[1]
        self.assembly.record(self.rows[0])
        self.bare.start(self._values, float(self.times[0]))

    def time_bare(self, n: int) -> np.ndarray:
        """Measure the generated functions without FMI, recording nothing."""
        self.restore()
        return _pieces(n, lambda first, last: self.bare.run(self.times, self.step, first, last))

    def time_c(self, n: int) -> np.ndarray:
        """Measure the C loop.

        Raises
        ------
        BenchmarkError
            If a call fails.
        """
        self.restore()

        def run(first: int, last: int) -> None:
            status = self.c.run(self.times, self.step, (first, last), self.rows)
            _require(status <= loop.WORST_ACCEPTED, f"The C loop ended with status {status}.")

        return _pieces(n, run)

    def time_ours(self, n: int) -> np.ndarray:
        """Measure `orchestration.loop.run`.

        Raises
        ------
        BenchmarkError
            If a call fails.
        """
        self.restore()
        plan, grid = self.assembly.plan, (self.times, np.array([self.step]))

        def run(first: int, last: int) -> None:
            k, *failure = loop.run(plan, loop.GAUSS_SEIDEL, grid, (first, last), self.rows[first + 1 :], 1)
            _require(k == last, f"The compiled loop ended at step {k}: {failure}.")

        return _pieces(n, run)

    def time_fmpy(self, n: int) -> np.ndarray:
        """Measure a Python loop over fmpy's own methods, batched per component."""
        self.restore()
        parts = _fmpy_parts(self.system, self.instances)
        values = list(self.rows[0])

        def run(first: int, last: int) -> None:
            for k in range(first, last):
                t = self.times[k]
                for slave, inputs, sources, reals, booleans, begin in parts:
                    if inputs:
                        slave.setReal(inputs, [values[j] for j in sources])
                    slave.doStep(t, self.step)
                    end = begin + len(reals)
                    values[begin:end] = slave.getReal(reals)
                    if booleans:
                        values[end : end + len(booleans)] = slave.getBoolean(booleans)
                self.rows[k + 1] = values

        return _pieces(n, run)

    def time_unit(self, name: str, inputs: np.ndarray, step: bool) -> np.ndarray:
        """Measure one bare unit with given inputs, shape (n_steps, n_inputs): copying, and steps."""
        self.restore()

        def run(first: int, last: int) -> None:
            self.bare.replay(name, self.times[first:last], self.step, inputs[first:last], step)

        return _pieces(len(inputs), run)

    def time_component(self, i: int, inputs: np.ndarray, calls: Sequence[bool]) -> np.ndarray:
        """Measure the calls (set, step, get) of one component with given inputs.

        Raises
        ------
        BenchmarkError
            If a call fails.
        """
        self.restore()

        def run(first: int, last: int) -> None:
            status = self.c.replay(i, self.times[first:last], self.step, inputs[first:last], calls)
            _require(status <= loop.WORST_ACCEPTED, f"Component {i} alone ended with status {status}.")

        return _pieces(len(inputs), run)

    def records(self, measure: Measure, n: int) -> np.ndarray:
        """The rows 0 to n that a loop records."""
        self.rows.fill(np.nan)
        measure(n)
        return self.rows[: n + 1].copy()

    def check_bare(self, records: np.ndarray) -> int:
        """Compare the bare units with the real run, bit by bit, up to the last row of `records`.

        Returns
        -------
        int
            Number of steps with equal outputs; the records hold no event, so it should be all.
        """
        self.restore()
        for k in range(1, len(records)):
            self.bare.run(self.times, self.step, k - 1, k)
            shown = [
                self.bare.outputs(c.name, len(c.description.of_causality("output"))) for c in self.system.components
            ]
            if np.concatenate(shown).tobytes() != records[k].tobytes():
                return k - 1
        return len(records) - 1

    def inputs(self, records: np.ndarray) -> dict[str, np.ndarray]:
        """Inputs that each component had in the steps of a run, shape (n_steps, n_inputs)."""
        column = {path: j for j, path in enumerate(self.assembly.columns)}
        position = {component.name: i for i, component in enumerate(self.system.components)}
        found = {}
        for name, i in position.items():
            sources = _sources(self.system, self.system.components[i])
            found[name] = np.empty((len(records) - 1, len(sources)))
            for j, source in enumerate(sources):
                fresh = position[source.partition(".")[0]] < i  # stepped before, in the same step
                values = records[:, column[source]]
                found[name][:, j] = values[1:] if fresh else values[:-1]
        return found


@contextmanager
def bench(system: System, n_steps: int) -> Iterator[Bench]:
    """Open and initialize a system of the five `COMPONENTS`, and compile the C programs for it."""
    _require(tuple(c.name for c in system.components) == COMPONENTS, "bare.c is for another system.")
    with (
        TemporaryDirectory(prefix="benchmark-", ignore_cleanup_errors=True) as name,
        opened(system) as instances,
    ):
        folder = Path(name)
        assembly = assemble(system, instances, None)
        initialize(system, instances, assembly, 0.0)
        fmus = {c.name: c.description.path for c in system.components}
        saved = tuple(_save(instance) for instance in instances)
        try:
            yield Bench(
                system,
                instances,
                assembly,
                BareUnits(fmus, folder),
                CLoop(assembly.plan, len(assembly.columns), folder),
                np.arange(n_steps + 1) * system.step,
                system.step,
                np.zeros((n_steps + 1, len(assembly.columns))),
                saved,
                (assembly.plan.reals.copy(), assembly.plan.discretes.copy()),
                {c.name: _values(c, i) for c, i in zip(system.components, instances, strict=True)},
            )
        finally:
            for instance, state in zip(instances, saved, strict=True):
                instance.call("fmi2FreeFMUstate", ctypes.byref(state))


def _pieces(n: int, run: Callable[[int, int], None]) -> np.ndarray:
    """Wall times of n steps made by ``run(first, last)``, piece by piece, s."""
    bounds = [*range(0, n, PIECE), n]
    seconds = np.empty(len(bounds) - 1)
    for j, (first, last) in enumerate(pairwise(bounds)):
        begin = perf_counter()
        run(first, last)
        seconds[j] = perf_counter() - begin
    return seconds


def _save(instance: Instance) -> ctypes.c_void_p:
    state = ctypes.c_void_p()
    instance.call("fmi2GetFMUstate", ctypes.byref(state))
    return state


def _values(component: Component, instance: Instance) -> np.ndarray:
    """All variables of an instance by value reference; references are 0, 1, ..."""
    variables = component.description.variables.values()
    values = np.full(len(variables), np.nan)
    getters = {REAL: "getReal", INTEGER: "getInteger", BOOLEAN: "getBoolean"}
    for variable in variables:
        get = getattr(instance.slave, getters[variable.type])
        values[variable.reference] = get([variable.reference])[0]
    return values


def _sources(system: System, component: Component) -> list[str]:
    """Where each connected input of a component comes from, in the order of the inputs."""
    by_input = {(c.target, c.input): f"{c.source}.{c.output}" for c in system.connections}
    names = (v.name for v in component.description.of_causality("input"))
    return [by_input[component.name, n] for n in names if (component.name, n) in by_input]


def _fmpy_parts(system: System, instances: list[Instance]) -> list[tuple[Any, ...]]:
    """(slave, inputs, columns of their sources, Real outputs, Boolean outputs, first column)."""
    paths = [f"{c.name}.{v.name}" for c in system.components for v in c.description.of_causality("output")]
    parts = []
    for component, instance in zip(system.components, instances, strict=True):
        sources = _sources(system, component)
        connected = {c.input for c in system.connections if c.target == component.name}
        inputs = [v.reference for v in component.description.of_causality("input") if v.name in connected]
        outputs = component.description.of_causality("output")
        reals = [v.reference for v in outputs if v.type == REAL]
        booleans = [v.reference for v in outputs if v.type == BOOLEAN]
        first = paths.index(f"{component.name}.{outputs[0].name}")
        parts.append((instance.slave, inputs, [paths.index(s) for s in sources], reals, booleans, first))
    return parts


def _require(satisfied: bool, message: str) -> None:
    if not satisfied:
        raise BenchmarkError(message)
