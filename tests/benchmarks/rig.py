"""Any system, initialized, and the loops over it that run in this process.

Every loop starts from the same saved states and buffers, restored outside the measured time; where
FMUs save no state, from fresh instances.
"""

import ctypes
from collections.abc import Callable, Collection
from contextlib import ExitStack
from itertools import pairwise
from time import perf_counter
from types import TracebackType
from typing import Any, Self

import numpy as np

from orchestration.fmi.codes import BOOLEAN, INTEGER, REAL, SAVES_STATE, WORST_ACCEPTED
from orchestration.fmi.instance import Instance
from orchestration.master.flatten import Assembly, assemble
from orchestration.master.initialization import initialize, opened
from orchestration.master.kernel import fixed_step
from orchestration.master.kernel.step_program import operations_of_step
from orchestration.system.system import Component, System
from tests.benchmarks.native import CLoop
from tests.benchmarks.report import Measure

PIECE = 2000  # steps of a piece: many are made without an interruption, and the call costs little
NEVER = 2**62  # of how many steps one is recorded, if none is


class BenchmarkError(RuntimeError):
    """A loop failed, or did not compute what it should."""


class Rig:
    """A system, initialized; a context manager.

    Parameters
    ----------
    n_steps
        Most steps that will be made.
    record
        Outputs to fetch and record; None is all of them.
    piece
        Steps that are timed together.

    Attributes
    ----------
    times
        Communication points, s, shape (n_steps + 1,).
    rows
        Where the loops record, shape (n_steps + 1, n_columns).
    """

    instances: list[Instance]
    assembly: Assembly
    c: CLoop

    def __init__(self, system: System, n_steps: int, record: Collection[str] | None = None, piece: int = PIECE) -> None:
        self.system, self.step, self.piece = system, system.run_step(), piece
        self.times = np.arange(n_steps + 1) * self.step
        self._n_rows, self._record = n_steps + 1, record
        self._saves = all(c.description.can(SAVES_STATE) for c in system.components)
        self._saved: list[ctypes.c_void_p] = []
        self._stack = ExitStack()

    def __enter__(self) -> Self:
        """Open and initialize the FMUs."""
        self._open()
        self.rows = np.zeros((self._n_rows, len(self.assembly.columns)))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Free the FMUs."""
        self._stack.close()

    def restore(self) -> None:
        """Back to the state after initialization; row 0 of the records is written."""
        if not self._saves:
            self._stack.close()
            self._open()
        for instance, state in zip(self.instances, self._saved, strict=False):
            instance.call("fmi2SetFMUstate", state)
        self.assembly.plan.reals[:], self.assembly.plan.discretes[:] = self._buffers
        self.assembly.record(self.rows[0])

    def time_c(self, n: int, every: int = 1) -> np.ndarray:
        """Measure the C loop, recording one of `every` steps.

        Raises
        ------
        BenchmarkError
            If a call fails.
        """
        self.restore()

        def run(first: int, last: int) -> None:
            status = self.c.run((self.times, self.step), (first, last), self._room(first, every), every)
            require(status <= WORST_ACCEPTED, f"The C loop ended with status {status}.")

        return self.pieces(n, run)

    def time_ours(self, n: int, every: int = 1) -> np.ndarray:
        """Measure `fixed_step.run`, recording one of `every` steps.

        Raises
        ------
        BenchmarkError
            If a call fails.
        """
        self.restore()
        plan, grid = self.assembly.plan, (self.times, np.array([self.step]))

        def run(first: int, last: int) -> None:
            k, *failure = fixed_step.run(self.operations, plan, grid, (first, last), self._room(first, every), every)
            require(k == last, f"The compiled loop ended at step {k}: {failure}.")

        return self.pieces(n, run)

    def time_fmpy(self, n: int) -> np.ndarray:
        """Measure a Python loop over fmpy's own methods, batched per component; all outputs are recorded."""
        self.restore()
        parts = _fmpy_parts(self.system, self.instances)
        values = list(self.rows[0])

        def run(first: int, last: int) -> None:
            for k in range(first, last):
                t = self.times[k]
                for slave, (reals, real_sources), (booleans, boolean_sources), fetched in parts:
                    if reals:
                        slave.setReal(reals, [values[j] for j in real_sources])
                    if booleans:
                        slave.setBoolean(booleans, [bool(values[j]) for j in boolean_sources])
                    slave.doStep(t, self.step)
                    for get, references, begin in fetched:
                        values[begin : begin + len(references)] = get(references)
                self.rows[k + 1] = values

        return self.pieces(n, run)

    def records(self, measure: Measure, n: int) -> np.ndarray:
        """The rows 0 to n that a loop records."""
        self.rows.fill(np.nan)
        measure(n)
        return self.rows[: n + 1].copy()

    def check(self, ours: np.ndarray, name: str, measure: Measure, n: int) -> None:
        """Compare the records of n steps of a loop with ours.

        Raises
        ------
        BenchmarkError
            If they differ in a bit.
        """
        records, expected = self.records(measure, n), ours[: n + 1]
        if records.tobytes() != expected.tobytes():
            differ = records.view(np.uint64) != expected.view(np.uint64)
            msg = f"The records of {name} differ from ours, first in row {np.argwhere(differ)[0][0]}."
            raise BenchmarkError(msg)

    def pieces(self, n: int, run: Callable[[int, int], None]) -> np.ndarray:
        """Wall times of n steps made by ``run(first, last)``, piece by piece, s."""
        bounds = [*range(0, n, self.piece), n]
        seconds = np.empty(len(bounds) - 1)
        for j, (first, last) in enumerate(pairwise(bounds)):
            begin = perf_counter()
            run(first, last)
            seconds[j] = perf_counter() - begin
        return seconds

    def _room(self, first: int, every: int) -> np.ndarray:
        """Where a loop that begins with step `first` records."""
        return self.rows[first // every + 1 :]

    def _open(self) -> None:
        with ExitStack() as stack:
            self.instances = stack.enter_context(opened(self.system))
            self.assembly = assemble(self.system, self.instances, self._record)
            initialize(self.system, self.instances, self.assembly, 0.0)
            self._buffers = (self.assembly.plan.reals.copy(), self.assembly.plan.discretes.copy())
            self.operations = operations_of_step(self.assembly.plan, sequential=True)
            self.c = CLoop(self.assembly.plan, self.operations, len(self.assembly.columns))
            self._saved = [_save(instance) for instance in self.instances] if self._saves else []
            for instance, state in zip(self.instances, self._saved, strict=False):
                stack.callback(instance.call, "fmi2FreeFMUstate", ctypes.byref(state))
            self._stack = stack.pop_all()


def require(satisfied: bool, message: str) -> None:
    """Raise a `BenchmarkError` if not satisfied."""
    if not satisfied:
        raise BenchmarkError(message)


def sources(system: System, component: Component) -> dict[str, str]:
    """Where each connected input of a component comes from, in the order of the inputs."""
    by_input = {(c.target, c.input): f"{c.source}.{c.output}" for c in system.connections}
    names = (v.name for v in component.description.of_causality("input"))
    return {n: by_input[component.name, n] for n in names if (component.name, n) in by_input}


def _save(instance: Instance) -> ctypes.c_void_p:
    state = ctypes.c_void_p()
    instance.call("fmi2GetFMUstate", ctypes.byref(state))
    return state


def _fmpy_parts(system: System, instances: list[Instance]) -> list[tuple[Any, ...]]:
    """(slave, Real inputs and columns of their sources, Boolean ones, [(getter, outputs, first column)])."""
    columns = [f"{c.name}.{v.name}" for c in system.components for v in c.description.of_causality("output")]
    column = {path: j for j, path in enumerate(columns)}
    parts = []
    for component, instance in zip(system.components, instances, strict=True):
        given, inputs = sources(system, component), {}
        for kind in (REAL, BOOLEAN):
            names = [n for n in given if component.variable(n).type == kind]
            inputs[kind] = ([component.variable(n).reference for n in names], [column[given[n]] for n in names])
        fetched, slave = [], _slave(instance)
        for kind, get in ((REAL, "getReal"), (INTEGER, "getInteger"), (BOOLEAN, "getBoolean")):
            outputs = [v for v in component.description.of_causality("output") if v.type == kind]
            if outputs:  # of a type, side by side
                first = column[f"{component.name}.{outputs[0].name}"]
                fetched.append((getattr(slave, get), [v.reference for v in outputs], first))
        parts.append((slave, inputs[REAL], inputs[BOOLEAN], fetched))
    return parts


def _slave(instance: Instance) -> Any:
    """The same instance as an object of fmpy."""
    from fmpy.fmi2 import FMU2Slave

    path, description = instance.library.path, instance.description
    slave = FMU2Slave(
        guid=description.guid,
        modelIdentifier=description.identifier,
        unzipDirectory=str(path.parents[2]),
        libraryPath=str(path),
        instanceName=instance.name,
    )
    slave.component = ctypes.c_void_p(instance.component)
    return slave
