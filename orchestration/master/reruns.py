"""A system that is run again and again with other start values, without opening its FMUs again.

    with Reruns(system, stop_time=2.0, algorithm="iterative") as runs:
        for stiffness in (1e4, 1e5, 1e6):
            result = runs.run({"plant.K_f": stiffness}, step=1e-4)

Each run has the bits of `simulate`, and fails with the errors of `simulate`.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from functools import partial
from types import TracebackType
from typing import Self

import numpy as np

from orchestration.errors import OrchestrationError, SimulationError
from orchestration.fmi.isolation import Isolation
from orchestration.fmi.pool import Reuse
from orchestration.master.algorithm import Algorithm, find_algorithm
from orchestration.master.flatten import recorded_paths
from orchestration.master.open_system import After, OpenSystem, Ways
from orchestration.master.options import Options
from orchestration.master.outside import outside
from orchestration.master.provenance import provenance, told_of_values
from orchestration.master.reuse import Learned, each_alone, quickest, same, warn_of_slow_ones
from orchestration.master.simulate import chosen_grid, isolated
from orchestration.master.simulation import Simulation
from orchestration.master.time_grid import Grid
from orchestration.results.result import Result
from orchestration.system.system import System

WAS_ENDED = "was ended"


@dataclass(frozen=True)
class _Point:
    """Start values by ``component.variable``, and the communication step, s."""

    values: Mapping[str, float]
    step: float


class Reruns:
    """A system that is run again and again with other start values; a context manager that closes the FMUs.

    An object is used by one thread at a time.

    Parameters
    ----------
    system
        The system, with the start values that the runs have in common.
    stop_time
        End of each run, s.
    algorithm
        As for `orchestration.simulate`.
    options
        As for `orchestration.simulate`; the runs have neither time series nor changes nor a pace.
    trusted
        Components whose FMUs do not wear out. A run that fails is made once more with all other FMUs just loaded, if
        they were not: they may have leaked memory or files from run to run. A run that takes longer than the time limit
        of an isolated FMU is not made again.
    learned
        What is known of the FMUs, to be shared with other objects of the same system.

    Attributes
    ----------
    learned
        What was found out about the FMUs.
    """

    def __init__(
        self,
        system: System,
        stop_time: float,
        algorithm: str | Algorithm = "gauss-seidel",
        options: Options | None = None,
        *,
        trusted: Collection[str] = (),
        learned: Learned | None = None,
    ) -> None:
        self.system, self.stop_time, self.algorithm = system, stop_time, find_algorithm(algorithm)
        self._named = repr(algorithm) if isinstance(algorithm, Algorithm) else self.algorithm.name
        self._options = replace(options or Options(), progress=self._go_on)
        self.learned, self._trusted = learned or Learned(), frozenset(trusted)
        self._isolation: Isolation | None = self._options.isolation
        self._open = self._fresh = OpenSystem(system, self._isolation)
        self._last: _Point | None = None
        self._about: dict[str, str] | None = None
        self._ended = False

    def __enter__(self) -> Self:
        """Nothing is opened before the first run."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the FMUs."""
        self.close()

    def run(self, values: Mapping[str, float], step: float) -> Result:
        """Run the system once.

        Parameters
        ----------
        values
            Start values that differ from those of the system, by ``component.variable``.
        step
            Communication step, s.

        Raises
        ------
        SystemDescriptionError, ArchiveError, InitializationError, SimulationError
            As `orchestration.simulate`.
        RunInterrupted
            If the user interrupts the run, or `end` was called.
        """
        point = _Point(values, step)
        ways = self.learned.ways(self._open)
        if ways is None and self.learned.learning.acquire(blocking=False):
            try:
                return self._learning(point)
            finally:
                self.learned.learning.release()
        ways = ways or {}
        worn = any(not self._trusted.issuperset(key) for key in self._open.reused(ways))
        try:
            return self._made(self._open, point, ways)
        except SimulationError:
            if not worn or self._ended or self._open.is_overdue:
                raise
        return self._made(self._open, point, self._ways_of_trusted())

    @property
    def processes(self) -> list[int]:
        """Ids of the processes in which isolated FMUs live."""
        return self._open.processes

    def end(self) -> None:
        """End the run that another thread makes, and its processes; it then raises an error."""
        self._ended = True
        for system in {self._open, self._fresh}:
            system.end(WAS_ENDED)

    def close(self) -> None:
        """Close the FMUs; a second call does nothing."""
        self._open.close()

    def _ways_of_trusted(self) -> Ways:
        """Ways in which all FMUs are loaded but those that are trusted."""
        ways = self.learned.ways(self._open) or {}
        return {key: way for key, way in ways.items() if self._trusted.issuperset(key)}

    def _learning(self, point: _Point) -> Result:
        """Make a run with FMUs just loaded, and find out whether the FMUs that have been run make it as well."""
        after, before = self._open.after, self._last or point
        self._fresh = fresh = OpenSystem(self.system, self._isolation)
        try:
            truth = self._made(fresh, point, {}, whole=True)  # if this run fails, the next one may tell
        finally:
            fresh.close()
        failed, ways = after == After.FAILURE, quickest(self._open)
        if not same(self._attempt(point, ways), truth):
            loaded, again = dict.fromkeys(ways, Reuse.FRESH), partial(self._attempt, point)
            ways = loaded if failed else each_alone(self._open, truth, partial(self._attempt, before), again)
        if not failed:
            warn_of_slow_ones(self._open, ways)
        self.learned.learn(after, ways)
        return self._asked(truth)

    def _attempt(self, point: _Point, ways: Ways) -> Result | None:
        """All that a run records with FMUs in the given ways; None if it fails."""
        try:
            return self._made(self._open, point, ways, whole=True)
        except OrchestrationError:
            return None

    def _made(self, fmus: OpenSystem, point: _Point, ways: Ways, *, whole: bool = False) -> Result:
        """Make a run; a whole one records all outputs, and refuses FMUs that refuse their way."""
        self._go_on()
        system = self.system.set(point.values)
        options = replace(self._options, record=self._everything()) if whole else self._options
        grid = chosen_grid(system, (self.stop_time, point.step, None), self.algorithm, options)
        around, grid = outside(system, options, grid, controlled=self.algorithm.control is not None)
        told = {"step": repr(grid.step), "stop_time": repr(float(grid.times[-1]))}
        about = self._common(grid) | told_of_values(system) | told
        opening = partial(fmus.like_new, ways, strict=whole)
        run = Simulation(system, grid, self.algorithm, options, metadata=about, outside=around, opening=opening)
        if fmus is self._open:
            self._last = point
        with run:
            run.run()
            return run.result()

    def _asked(self, whole: Result) -> Result:
        """The columns that are recorded, of a result with all of them."""
        if self._options.record is None:
            return whole
        asked = [f"{component}.{variable}" for component, variable in recorded_paths(self.system, self._options.record)]
        names = tuple(name for name in asked if name not in whole.texts)
        places = [whole.names.index(name) for name in names]
        return replace(
            whole,
            names=names,
            rows=np.ascontiguousarray(whole.rows[:, places]),
            units={name: whole.units[name] for name in names},
            texts={name: whole.texts[name] for name in asked if name in whole.texts},
        )

    def _everything(self) -> list[str] | None:
        """All outputs and all other columns that are recorded."""
        if self._options.record is None:
            return None
        paths = [*recorded_paths(self.system, None), *recorded_paths(self.system, self._options.record)]
        return list(dict.fromkeys(f"{component}.{variable}" for component, variable in paths))

    def _common(self, grid: Grid) -> dict[str, str]:
        """Metadata that all runs have in common."""
        if self._about is None:
            self._about = isolated(self.system, self._options) | provenance(
                self.system,
                algorithm=self._named,
                step=grid.step,
                start_time=float(grid.times[0]),
                stop_time=float(grid.times[-1]),
                order=None,
            )
        return self._about

    def _go_on(self, *_: int) -> None:
        """Stop the run that `end` was called for; also called with the progress of a run.

        Raises
        ------
        KeyboardInterrupt
        """
        if self._ended:
            raise KeyboardInterrupt
