"""A running simulation of a system, which can be saved, taken back, branched and continued.

An algorithm that neither extrapolates nor corrects inputs nor controls its step uses the short loop of
`kernel.fixed_step`. Other algorithms use the loop of `kernel.step_control`. A loop is called for about a tenth of a
second at a time, so that interrupts are noticed and progress is shown.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np

from orchestration.errors import InitializationError, RunInterrupted, SimulationError
from orchestration.fmi.codes import known_status
from orchestration.fmi.deferred import raise_kept
from orchestration.fmi.given import a_number, a_path, require_type
from orchestration.fmi.instance import Instance
from orchestration.master.algorithm import Algorithm
from orchestration.master.block import Block
from orchestration.master.capabilities import check_capabilities, check_crossings, check_steps
from orchestration.master.chunks import Chunks
from orchestration.master.compilation import compile_loop
from orchestration.master.discard import end_of_simulation
from orchestration.master.failure_text import failure_message
from orchestration.master.flat_run import flat_run
from orchestration.master.fmu_messages import kept_messages, report_warnings
from orchestration.master.form import report_libraries
from orchestration.master.initialization import opened
from orchestration.master.judge import Judge
from orchestration.master.kernel import fixed_step
from orchestration.master.kernel.codes import Failure
from orchestration.master.memory import require_memory
from orchestration.master.options import Options
from orchestration.master.outside import Outside
from orchestration.master.provenance import told_afterwards
from orchestration.master.reached import Reached
from orchestration.master.recorder import Recorder, Sink, any_value, not_finite
from orchestration.master.safeguard import guarded, over_steps, terminate
from orchestration.master.saving import Saving, choices
from orchestration.master.setting import set_in_run
from orchestration.master.snapshot import Snapshot, identity
from orchestration.master.streaming import Streaming
from orchestration.master.time_grid import Grid
from orchestration.results.columns import ENDED, FAILED, INTERRUPTED
from orchestration.results.prediction import VERDICT, Prediction
from orchestration.results.result import Result
from orchestration.sandbox.guard import Guard
from orchestration.system.system import System

Opening = Callable[[Guard], AbstractContextManager[list[Instance]]]
_CHUNK_VALUES = 2**17  # recorded in a chunk: they are checked while they are in the processor's cache


class Simulation(Reached):
    """A run of a system; a context manager that opens and initializes the FMUs, and frees them at the end.

    Parameters
    ----------
    system
        The system to run. Components step in the order of the system.
    grid
        See `orchestration.master.time_grid`.
    algorithm, options
        See `orchestration.simulate`.
    metadata
        Metadata of the result.
    outside
        Time series, changes and the clock.
    opening
        Opens the instances in the order of the components, with a guard of the process. Default: the FMUs are unpacked
        and loaded, and freed at the end.

    Raises
    ------
    SystemDescriptionError
        If the system does not allow the algorithm or the options.
    InitializationError
        On entry, if a component refuses its start values.

    Examples
    --------
    >>> from orchestration import prepare, scenario
    >>> with prepare(scenario("fig2"), stop_time=1.12) as run:
    ...     run.run(until=0.9)  # s; soon the arm touches the wall
    ...     before = run.save()
    ...     print(run.predict().word, run.time, run.steps_made, run.count, run.steps_per_tick["sensor"])
    ...     run.run()
    ...     stiff = run.result()
    ...     run.restore(before)
    ...     run.set({"controller.K": 2000.0})  # N/m
    ...     run.run()
    ...     soft = run.result()
    stable 0.9 9000 9001 1
    >>> round(1e3 * float(stiff["plant.x[1]"][-1] - soft["plant.x[1]"][-1]), 1)  # mm, soon after the contact
    -1.1

    Rows can go to a file instead:

    >>> streamed = prepare(scenario("fig2"), stop_time=0.1)
    >>> streamed.stream_to("rows.parquet")
    >>> with streamed as run:
    ...     run.run()
    ...     run.complete()
    """

    compile_seconds: float
    """Time that compiling the loop took on entry, or loading its machine code, s."""

    def __init__(
        self,
        system: System,
        grid: Grid,
        algorithm: Algorithm,
        options: Options,
        *,
        metadata: Mapping[str, str] | None = None,
        outside: Outside | None = None,
        opening: Opening | None = None,
    ) -> None:
        check_crossings(system, options.crossings)
        check_capabilities(system, algorithm, options.crossings, options.ratios)
        check_steps(system, algorithm, options.crossings, unequal=grid.unequal)
        self.system, self.grid, self.algorithm, self.options = system, grid, algorithm, options
        self._outside, self._opening = outside or Outside(), opening
        first = self._outside.inputs.first_values(float(grid.times[0]), float(grid.lengths[0]))
        self.judge = Judge(system, first, grid.step, algorithm, options.isolation)
        self._metadata = dict(metadata or {})
        self._varies = algorithm.control is not None or bool(options.crossings.outputs)  # the number of rows
        self._plain = algorithm.plain and not options.crossings.outputs and not options.slow
        self._fault = any_value if options.allow_nan else not_finite
        self._changes: list[list[float | str]] = []  # time, variable, value
        self._ended = ""  # a sentence, once a component has ended the simulation
        self._changed_at = -1  # point at which scheduled changes were made last
        self._stack, self._guard = ExitStack(), Guard()
        self._chunks, self._block, self._streaming = Chunks(), Block(system.name), Streaming()

    def __repr__(self) -> str:
        """System, algorithm and how far the run is."""
        at = f"at t = {float(self._state.time):.9g} s" if self._block.begun else "not begun"
        return f"<Simulation of {self.system.name} with {self.algorithm.name}: {at}>"

    def __enter__(self) -> Self:
        """Open and initialize the components, record row 0, and compile the loop."""
        with ExitStack() as stack:
            self._instances: list[Instance] = stack.enter_context(self._opened())
            if self._opening is None:
                report_libraries(self._instances, strict=self.options.strict)
            run = (self.system, self._instances, self.algorithm, self.grid)
            self._flat = flat_run(*run, options=self.options, outside=self._outside, guard=self._guard)
            self._assembly, self._layout = self._flat.assembly, self._flat.layout
            self._state = self._layout.coupling.state
            stack.callback(guarded, (self._instances, self._guard), self._layout.free, self._instances)
            self._columns = (*self._assembly.columns, *self._outside.units)
            self._units, self._texts = self._assembly.units | self._outside.units, self._assembly.texts
            every_column = (*self._columns, *self._texts.columns)
            known = None if self._varies else self.grid.n // self.options.every + 1
            if known is not None and self._streaming.path is None:
                require_memory(self.system.name, self.grid.n, known, len(every_column))
            self._recorder = Recorder(len(every_column), known, self._sink(stack))
            known_by = choices(self.algorithm, self.options, self._outside.inputs)
            name = identity(self.system, every_column, self.grid.times, known_by)
            parts = (self._instances, self._assembly, self._layout, self._recorder, self.grid.n)
            self._saving = Saving(self.system.name, name, *parts)
            stack.callback(guarded, (self._instances, self._guard), self._saving.free)
            times, rows = self._recorder.room()
            times[0], rows[0, len(self._assembly.columns) :] = self.grid.times[0], 0.0
            self._assembly.record(rows[0])
            if fault := self._fault(self._columns, *self._recorder.filled(1), first=0):
                raise InitializationError(fault[1])
            self.compile_seconds = compile_loop(lambda: self._run_plain(0) if self._plain else self._run_general(0))
            self._stack = stack.pop_all()
        self._block.begin()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Terminate and free the components.

        Raises
        ------
        SimulationError
            If a component does not terminate after a run without errors.
        """
        self._block.end()
        try:
            if kind is None:
                self._terminate()
            else:
                self._recorder.flush()
        except BaseException as failed:  # an interrupt, or a warning that is an error, must leave nothing behind either
            self._stack.__exit__(type(failed), failed, failed.__traceback__)
            raise
        self._stack.__exit__(kind, error, trace)

    def stream_to(self, path: str | Path) -> None:
        """Write rows to a .parquet file instead of keeping them; call this before the ``with`` block begins."""
        self._streaming.to(a_path("The file of rows", path))

    def predict(self) -> Prediction:
        """Predict the stability of the run near its start, and keep the prediction in the metadata of the result."""
        self._metadata[VERDICT] = (prediction := self.judge()).as_json()
        return prediction

    def run(self, until: float | None = None) -> None:
        """Run on from the present time to a communication point.

        Parameters
        ----------
        until
            A communication point, s; the last one if None.

        Raises
        ------
        SystemDescriptionError
            If `until` is not a communication point after the present time.
        SimulationError
            If a component fails, the run diverges or an iteration does not converge; ``error.result`` has
            the rows until then.
        RunInterrupted
            A KeyboardInterrupt, with the rows until then.
        """
        self._block.require_open()
        last = self.grid.n if until is None else self.grid.ahead(a_number("The time to run until", until), self.time)
        try:
            if self._outside.pacer is not None:
                self._outside.pacer.begin(self.time)
            while self._state.interval < last and not self._ended:
                self._apply_changes()
                reach = self._outside.reach(self.grid, int(self._state.interval), last)
                self._chunks.begin()
                with over_steps(self._instances, self._guard, self.time):
                    self._run_plain(reach) if self._plain else self._run_general(reach)
                self._chunks.end()
                raise_kept()
                self._texts.forget([self._assembly.plan.discretes], self._recorder.parts)
                if self.options.progress is not None:
                    so_far, controlled = int(self._state.interval), self.algorithm.control is not None
                    self.options.progress(*self.grid.progress(so_far, self.time, controlled=controlled))
                if self._outside.pacer is not None:
                    self._outside.pacer.wait(self.time)
            report_warnings(() if self._ended else self._instances)
        except KeyboardInterrupt as interrupt:
            raise RunInterrupted(self._broken_off(INTERRUPTED, "The run was interrupted.")) from interrupt

    def result(self) -> Result:
        """Return the rows recorded so far; the arrays are views of the run's memory where that is possible."""
        self._block.require_begun()
        times, rows = self._recorder.rows()
        numbers, texts = self._texts.split(rows)
        about = (self._units, self.steps_per_tick, self._described(), self.system.sample_times)
        found = Result(times, self._columns, numbers, *about, texts=texts, judge=self.judge)
        return replace(found, status=ENDED, message=self._ended) if self._ended else found

    def _broken_off(self, status: str, message: str) -> Result:
        return replace(self.result(), status=status, message=message)

    @property
    def steps_per_tick(self) -> dict[str, int]:
        """Rows per sampling period, by component; empty if rows do not fall on the ticks."""
        return {} if self._varies else self.grid.rows_per_tick(self.options.every)

    def set(self, values: Mapping[str, float | bool | str | Sequence[float]]) -> None:
        """Set tunable parameters, and inputs without a source, from here on; values are as for `System.set`.

        Raises
        ------
        SystemDescriptionError
            If a name or value is wrong.
        SimulationError
            If the component refuses, for example because the parameter is fixed.
        """
        self._block.require_open()
        asked = (self.system, self._instances, values, self._outside.inputs.names)
        taken = guarded((self._instances, self._guard), set_in_run, *asked)
        self._changes += [[self.time, name, value] for name, value in taken.items()]

    def save(self) -> Snapshot:
        """Save the state of the whole run.

        Raises
        ------
        SystemDescriptionError
            If a component does not save states, or rows go to a file.
        """
        self._block.require_open()
        return guarded((self._instances, self._guard), self._saving.save, self.time, self._changes)

    def restore(self, snapshot: Snapshot) -> None:
        """Restore a state that was saved, here or in another run of the same system.

        Raises
        ------
        SystemDescriptionError
            If the snapshot is of another system, algorithm, grid or choice of columns.
        """
        self._block.require_open()
        require_type("The snapshot", snapshot, Snapshot, "give one of save(), or of Snapshot.read(path)")
        self._changes = guarded((self._instances, self._guard), self._saving.restore, snapshot)
        self._ended, self._changed_at = "", -1

    def _opened(self) -> AbstractContextManager[list[Instance]]:
        if self._opening is not None:
            return self._opening(self._guard)
        return opened(self.system, self.options.isolation, self._guard)

    def _described(self) -> dict[str, str]:
        told = told_afterwards(self._changes, None if self._plain else self._state)
        return self._metadata | self._outside.described() | told | kept_messages(self._instances)

    def _sink(self, stack: ExitStack) -> Sink | None:
        ticks = {"steps_per_tick": self.steps_per_tick, "sample_times": self.system.sample_times}
        metadata = self._metadata | self._outside.inputs.described()
        return self._streaming.sink(stack, self._columns, self._units, self._texts, metadata=metadata, **ticks)

    def _apply_changes(self) -> None:
        """Make the changes that are due at the present communication point, once."""
        k = int(self._state.interval)
        if k in self._outside.changes and k != self._changed_at and self.time == self.grid.times[k]:
            self._changed_at = k
            try:
                self.set(self._outside.changes[k])
            except InitializationError as refused:
                msg = f"The change at t = {self.time:.9g} s (step {self.steps_made}) is refused: {refused}"
                raise SimulationError(msg, self.result()) from refused

    def _run_plain(self, last: int) -> None:
        """Run a part of the steps in the loop for fixed steps."""
        state, every = self._state, self.options.every
        done = int(state.interval)
        room = self._recorder.room()[1]
        most = max(1, _CHUNK_VALUES // max(1, room.shape[1])) * every
        end = min(last, done + min(self._chunks.steps, most), (done // every + len(room)) * every + every - 1)
        grid = (self.grid.times, self.grid.lengths)
        k, j, status = fixed_step.run(self._flat.operations, self._assembly.plan, grid, (done, end), room, every)
        times, _ = self._recorder.room()
        n = k // every - done // every
        times[:n] = self.grid.times[(done // every + 1) * every : k + 1 : every]
        self._finish_rows(*self._recorder.filled(n))
        state.interval = state.steps_made = k
        state.time = self.grid.times[k]
        if k < end:
            failed = self._flat.operations[int(j)]
            self._fail((int(failed.subject), int(failed.call), known_status(int(status))))

    def _run_general(self, last: int) -> None:
        """Run a part of the steps in the loop for all algorithms."""
        from orchestration.master.kernel import step_control

        budget = 1 if self._outside.pacer is not None and self._varies else self._chunks.steps
        count, failure = step_control.run(
            self._assembly.plan,
            self._layout.coupling,
            (self.grid.times, self.grid.lengths),
            (last, budget, self.options.every),
            self._recorder.room(),
        )
        self._finish_rows(*self._recorder.filled(count))
        if failure[0] >= 0:
            self._fail(failure)

    def _finish_rows(self, times: np.ndarray, rows: np.ndarray) -> None:
        """Refuse rows with values that are not finite; rows before them stay."""
        if self._outside.pacer is not None:
            rows[:, len(self._assembly.columns)] = self._outside.pacer.lateness(times)
        if fault := self._fault(self._columns, times, rows, first=self._recorder.count - len(times)):
            self._recorder.drop(len(times) - fault[0])
            self._recorder.flush()
            raise SimulationError(fault[1], self._broken_off(FAILED, fault[1]))

    def _fail(self, failure: Failure) -> None:
        self._recorder.flush()
        raise_kept()
        where = f" at t = {self.time:.9g} s (step {self.steps_made})"
        self._ended = end_of_simulation(failure, where, self._instances)
        if self._ended:
            return
        message = failure_message(failure, where, self._layout, self._instances, self._assembly)
        raise SimulationError(message, self._broken_off(FAILED, message))

    def complete(self) -> None:
        """Complete the file that rows are streamed to, before the FMUs are called for the last time; once is enough."""
        self._recorder.flush()
        self._streaming.complete(self._described(), self._ended)

    def _terminate(self) -> None:
        self.complete()
        terminate(self._instances, self._guard, self.result)
