"""A system as a native library in this process: one call makes many runs, and reduces each of them to some numbers.

    program = NativeProgram.of(system, varied=("plant.K_f",), reductions=formula.reductions)
    runs = program.runs(values, steps, stop_time=2.0)          # values (n, 1), steps (n,)
    runs.reduced                                               # (n, n_reductions)

The library is compiled with the flags of the FMUs and makes the steps of `orchestration.simulate`, to the bit.
"""

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from orchestration.containers.native.library import (
    COMPLETE,
    Outcome,
    Request,
    identity_of,
    loaded,
)
from orchestration.containers.native.sentences import failure_sentence, refusal
from orchestration.containers.native.sources import NativeSources, native_sources
from orchestration.containers.plan import GAUSS_SEIDEL
from orchestration.errors import ContainerError, SimulationError
from orchestration.fmi.description import SAMPLE_TIME
from orchestration.master.time_grid import fixed_grid
from orchestration.results.measures.expression import Reduction
from orchestration.results.result import Result
from orchestration.system.sampling import RATIO_TOLERANCE
from orchestration.system.system import System

STOPPED = "The call was stopped before this run began."
"""Message of a run that was not made."""


class Stop:
    """A flag that ends a call of `NativeProgram.runs` before its next run; any thread may raise it."""

    def __init__(self) -> None:
        self._flag = np.zeros(1, np.int32)

    def set(self) -> None:
        """Raise the flag."""
        self._flag[0] = 1

    @property
    def address(self) -> int:
        """Where the flag is in memory."""
        return self._flag.ctypes.data


@dataclass(frozen=True)
class Runs:
    """What became of the runs of one call.

    Attributes
    ----------
    reduced
        The reductions of each run, float64, shape (n, n_reductions); NaN where a run failed.
    messages
        A sentence for each run that failed or was not made, and an empty text for all others.
    rows
        Recorded rows, float64, shape (n, n_rows, n_recorded), where n_rows is that of the longest run; NaN behind the
        end of a shorter run and where a run failed. None if nothing is recorded.
    made
        Number of runs made, those that failed included; smaller than n after a stop.
    """

    reduced: np.ndarray
    messages: tuple[str, ...]
    rows: np.ndarray | None
    made: int


class NativeProgram:
    """A system as a native library in this process. Threads may share it.

    Parameters
    ----------
    system
        The system. Its start values are in force unless a run varies them.
    sources
        Its C sources.
    varied, reductions, record
        As of `of`.

    Attributes
    ----------
    identity
        Hash of the C sources, of the compiler and of its flags, as hexadecimal digits. Start values and the step are no
        part of it.
    """

    def __init__(
        self,
        system: System,
        sources: NativeSources,
        varied: Sequence[str],
        reductions: Sequence[Reduction],
        record: Sequence[str],
    ) -> None:
        self.system, self.varied = system, tuple(varied)
        self.reductions, self.record = tuple(reductions), tuple(record)
        self.identity = identity_of(sources.files, sources.compiled)
        self._library = loaded(self.identity, sources.files, sources.compiled)
        number = {variable.path: i for i, variable in enumerate(sources.plan.variables)}
        self._common = np.array([number[path] for path in sources.common], np.uint32)
        self._common_values = np.array(list(sources.common.values()), float)
        self._paths = (*sources.common, *self.varied)
        self._units = {path: system.resolve(path)[1].unit for path in self.record}
        self._types = [sources.plan.variables[number[path]].variable.type for path in self._paths]

    @classmethod
    def of(
        cls,
        system: System,
        algorithm: str = GAUSS_SEIDEL,
        *,
        varied: Sequence[str] = (),
        reductions: Sequence[Reduction] = (),
        record: Sequence[str] = (),
    ) -> "NativeProgram":
        """Compile a system, or take the library from the cache.

        Parameters
        ----------
        system
            System whose FMUs are of this project; its components in the order of stepping.
        algorithm
            ``gauss-seidel`` or ``jacobi``.
        varied
            Parameters and unconnected inputs that differ from run to run, as ``component.variable``.
        reductions
            What each run is reduced to; of outputs, parameters and unconnected inputs.
        record
            Columns that are recorded at each communication point; of the same variables.

        Raises
        ------
        ContainerError
            If the system cannot be a native library, or a variable cannot be varied, reduced or recorded.
        SystemDescriptionError
            If a name is unknown.

        Examples
        --------
        >>> import numpy as np
        >>> from orchestration import scenario
        >>> from orchestration.containers.native.program import NativeProgram
        >>> from orchestration.results.measures.expression import Column, Reduction
        >>> deepest = Reduction("max", Column("plant.penetration"))  # m
        >>> program = NativeProgram.of(scenario("fig2"), varied=("plant.K_f",), reductions=(deepest,))
        >>> walls = np.array([[1e4], [1e5], [-1.0]])  # N/m
        >>> runs = program.runs(walls, np.full(3, 1e-4), stop_time=1.0)
        >>> (1e3 * runs.reduced[:2, 0]).round(2).tolist()  # mm
        [13.23, 5.57]
        >>> runs.messages[2]
        'plant: fmi2SetReal returned fmi2Error; its last message: "fmi2SetReal: K_f = -1 must be at least 0 N/m.".'
        """
        sources = native_sources(system, algorithm, varied, reductions, record)
        return cls(system, sources, varied, reductions, record)

    def runs(
        self,
        values: np.ndarray,
        steps: np.ndarray,
        stop_time: float,
        start_time: float = 0.0,
        stop: Stop | None = None,
    ) -> Runs:
        """Make runs, one after the other, in memory of their own. Other threads run meanwhile.

        Parameters
        ----------
        values
            Start values of the varied variables, shape (n, n_varied).
        steps
            Communication step of each run, s, shape (n,).
        stop_time, start_time
            End and begin of all runs, s.
        stop
            Flag that ends the call early.

        Raises
        ------
        ContainerError
            If the arrays do not fit each other.
        """
        values = np.ascontiguousarray(values, float)
        steps = np.ascontiguousarray(steps, float)
        n = len(steps)
        if values.shape != (n, len(self.varied)) or steps.ndim != 1:
            shapes = f"values have the shape {values.shape} and steps the shape {steps.shape}"
            msg = f"A call of runs: {shapes}; give {len(self.varied)} values and one step for each run."
            raise ContainerError(msg)
        counts = _counts(steps, stop_time - start_time)
        reduced = np.full((n, len(self.reductions)), np.nan)
        outcomes = (Outcome * n)()
        rows = np.full((n, int(counts.max(initial=0)) + 1, len(self.record)), np.nan) if self.record else None
        flag = stop or Stop()
        memory = np.zeros(-(-int(self._library.native_size()) // 8))
        request = Request(
            n,
            len(self._common),
            *map(_address, (self._common, self._common_values, values, steps, counts)),
            start_time,
            *(flag.address, _address(memory), _address(reduced), ctypes.addressof(outcomes), _address(rows)),
            0 if rows is None else rows.shape[1],
        )
        made = int(self._library.native_runs(ctypes.byref(request)))
        span = (start_time, stop_time)
        messages = [
            self._message(outcomes[i], int(counts[i]), values[i], float(steps[i]), span) if i < made else STOPPED
            for i in range(n)
        ]
        return Runs(reduced, tuple(messages), rows, made)

    def result(self, values: np.ndarray, step: float, stop_time: float, start_time: float = 0.0) -> Result:
        """Make one run and return its recorded columns, as `orchestration.simulate` does; without metadata.

        Parameters
        ----------
        values
            Start values of the varied variables, shape (n_varied,).
        step
            Communication step, s.
        stop_time, start_time
            End and begin of the run, s.

        Raises
        ------
        SimulationError
            If the run fails.
        """
        values = np.asarray(values, float)
        runs = self.runs(values[None, :], np.array([step]), stop_time, start_time)
        if runs.messages[0]:
            raise SimulationError(runs.messages[0])
        given = dict(zip(self.varied, values.tolist(), strict=True))
        periods = {path: period for path, period in given.items() if path.endswith(f".{SAMPLE_TIME}")}
        system = self.system.set(periods) if periods else self.system
        grid = fixed_grid(system, (start_time, stop_time), step, stale=False)
        rows = np.empty((len(grid.times), 0)) if runs.rows is None else runs.rows[0]
        return Result(grid.times, self.record, rows, self._units, grid.rows_per_tick(1), {}, system.sample_times)

    def _message(self, outcome: Outcome, count: int, values: np.ndarray, step: float, span: tuple[float, float]) -> str:
        """The sentence of a run; empty if it is complete."""
        if count > 0 and outcome.where == COMPLETE:
            return ""
        given = dict(zip(self.varied, values.tolist(), strict=True))
        if outcome.steps == 0 and (refused := refusal(self.system, given, step, span)):
            return refused
        return failure_sentence(outcome, self._paths, self._types, span[0] + outcome.steps * step)


def _counts(steps: np.ndarray, duration: float) -> np.ndarray:
    """Numbers of steps of runs, int64; 0 of a run that is not a whole number of steps."""
    with np.errstate(all="ignore"):
        ratios = duration / steps
        whole = np.isfinite(ratios) & (ratios > 0.5) & (ratios < 2**53)
        nearest = np.where(whole, np.round(ratios), 0.0)
        fits = whole & (nearest >= 1) & (np.abs(ratios - nearest) <= RATIO_TOLERANCE * nearest)
    return np.where(fits & (steps > 0), nearest, 0.0).astype(np.int64)


def _address(array: np.ndarray | None) -> int | None:
    return None if array is None else array.ctypes.data
