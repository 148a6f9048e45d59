"""Run a system of coupled FMUs from a start time to a stop time.

    result = simulate(system, stop_time=2.0, step=1e-4)

A run is this loop:

    instantiate; set start values; propagate outputs to inputs in initialization mode
    row 0 = outputs
    for k = 0, ..., n - 1:   t = t0 + k step
        a step of the algorithm; see `orchestration.master.algorithm`
        row k + 1 = outputs

After initialization, the master calls fmi2DoStep between a set of inputs and the next get of outputs,
as FMI 2.0 demands.
"""

import itertools
import json
from collections.abc import Collection, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from orchestration.errors import SystemDescriptionError, printable, warn_caller
from orchestration.fmi.display import listed
from orchestration.fmi.given import a_path, require_type, shown
from orchestration.fmi.isolation import Isolation
from orchestration.fmi.names import suggestion
from orchestration.master.algorithm import ALGORITHMS, Algorithm, find_algorithm
from orchestration.master.changes import Changes
from orchestration.master.form import report_descriptions
from orchestration.master.judge import report_prediction
from orchestration.master.options import Options, Progress
from orchestration.master.outside import outside
from orchestration.master.pacing import Pace
from orchestration.master.progress import progress_bar
from orchestration.master.provenance import provenance
from orchestration.master.simulation import Simulation
from orchestration.master.stiffness import report_stiffness
from orchestration.master.time_grid import Grid, fixed_grid, given_grid, tick_grid
from orchestration.master.walls import report_walls
from orchestration.results.result import Result
from orchestration.system.system import System

__all__ = ["ALGORITHMS", "Options", "Progress", "UnconnectedInputWarning", "prepare", "simulate", "stream"]


MOST_LISTED = 50
"""Unconnected inputs that a warning names."""


class UnconnectedInputWarning(UserWarning):
    """Warning that inputs without a connection keep their start values during the run.

    Examples
    --------
    >>> import warnings
    >>> from orchestration import System, UnconnectedInputWarning, scenario, simulate
    >>> alone = System.of({"arm": scenario("fig2")["plant"]})
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("ignore", UnconnectedInputWarning)  # no torque is what is wanted
    ...     result = simulate(alone, stop_time=0.1, step=1e-3)
    >>> alone.unconnected_inputs()
    ['arm.tau[1]', 'arm.tau[2]']
    """


def simulate(
    system: System | str | Path,
    stop_time: float | None = None,
    step: float | None = None,
    algorithm: str | Algorithm = "gauss-seidel",
    *,
    record: str | Sequence[str] | None = None,
    order: Sequence[str] | None = None,
    times: np.ndarray | None = None,
    inputs: Any = None,
    changes: Changes | None = None,
    pace: float | Pace | None = None,
    isolate: bool | str | Collection[str] | Isolation | None = None,
    progress: bool | Progress = False,
    verdict: bool = False,
    options: Options | None = None,
) -> Result:
    """Run a system of coupled FMUs, and return the rows it recorded.

    Parameters
    ----------
    system
        Components, start values and connections; or the path of an SSP package.
    stop_time
        End of the run, s. Default: the stop time of the system, which must then have one. The duration must be
        a multiple of the step.
    step
        Communication step, s. Default: the step of the system, which must then have one.
    algorithm
        Name of one of `ALGORITHMS`, or an `Algorithm`.
    record
        Variables to record: names ``component.variable`` or names of arrays, of any causality, or patterns with ``*``
        and ``?``, which choose outputs. Default: all outputs.
    order
        Component names in the order of stepping. Default: the order of the system.
    times
        Communication points, s, shape (n + 1,), increasing, instead of `stop_time` and `step`.
    inputs
        Time series for inputs without a connection. A mapping from ``component.variable``, a scalar or an array, to
        ``(time, values)``, a `TimeSeries`, or a column of pandas or xarray. Or a whole table whose columns have such
        names: the path of a CSV or Parquet file, a DataFrame, a Dataset, a structured array, a `Result`. Its time, in
        s, is the column ``time``, the index, or the first column; a header ``plant.F [kN]`` names a unit. A series
        must cover the run.
    changes
        Values that change during the run: by time, s, values by ``component.variable``, of tunable parameters and of
        inputs without a source. They are set at the first communication point at or after the time.
    pace
        Simulated seconds per second: 1.0 keeps step with the clock, 2.0 goes twice as fast; or a `Pace`. The result
        then has a column ``lateness``. Default: as fast as possible.
    isolate
        Components whose FMUs live in processes of their own, so that a crash, a hang or an exit of an FMU is an error
        of the run: True for all, names of components, or an `Isolation` with limits. Default: none.
    progress
        True for a bar on standard error, or a function that is called with the steps made and the steps in all.
    verdict
        Whether to predict the stability of the run before it, which takes some tenths of a second, and to warn of a
        run that is unstable. `Result.verdict` gives the same when it is asked for.
    options
        Rare choices for the run. Default: those of `Options`.

    Returns
    -------
    Result
        Row 0, and one row for each recorded step.

    Raises
    ------
    SystemDescriptionError
        If the system cannot be run as asked.
    InitializationError
        If a component refuses its start values, or an algebraic loop has no solution.
    SimulationError
        If a component fails. ``error.result`` holds the rows before the failure.
    RunInterrupted
        If the user interrupts the run. ``error.result`` holds the rows before the interrupt.

    Examples
    --------
    >>> from orchestration import scenario, simulate
    >>> result = simulate(scenario("fig2"), stop_time=1.2, record=["plant.x", "controller.e"])
    >>> result
    <Result: 12001 rows, t = 0 to 1.2 s, 4 columns (plant.x[1], plant.x[2], controller.e[1], controller.e[2])>
    >>> float(result["plant.x[1]"].min().round(3))  # m; the wall is at -1.436
    -1.442
    """
    system = _system(system)
    if not (isinstance(progress, bool) or callable(progress)):
        msg = f"progress is {shown(progress)}; give True for a bar, or a function of two numbers."
        raise SystemDescriptionError(msg)
    if not isinstance(verdict, bool | np.bool_):
        msg = f"verdict is {shown(verdict)}; give True to predict the stability before the run, or False."
        raise SystemDescriptionError(msg)
    with ExitStack() as stack:
        show = stack.enter_context(progress_bar()) if progress is True else progress or None
        given = {
            "record": record,
            "progress": show,
            "inputs": inputs,
            "changes": changes,
            "pace": pace,
            "isolate": isolate,
        }
        run = prepare(system, stop_time, step, algorithm, order=order, times=times, options=_chosen(options, given))
        if verdict:
            report_prediction(run.predict())
        simulation = stack.enter_context(run)
        simulation.run()
        return simulation.result()


def stream(
    path: str | Path,
    system: System | str | Path,
    stop_time: float | None = None,
    step: float | None = None,
    algorithm: str | Algorithm = "gauss-seidel",
    *,
    record: str | Sequence[str] | None = None,
    order: Sequence[str] | None = None,
    inputs: Any = None,
    changes: Changes | None = None,
    pace: float | Pace | None = None,
    isolate: bool | str | Collection[str] | Isolation | None = None,
    options: Options | None = None,
) -> int:
    """Run a system and write its rows to a Parquet file during the run.

    At most 16 MB of rows are in memory; the communication points take 8 bytes for each step. If the run fails or is
    interrupted, the rows before are in ``STEM.partial.parquet``. If the process is killed, its complete groups of rows
    are in ``NAME.<random>.part``, which `Result.read` reads.

    Parameters
    ----------
    path
        Parquet file to write.
    system, stop_time, step, algorithm, record, order, inputs, changes, pace, isolate, options
        As for `simulate`.

    Returns
    -------
    int
        Number of rows.

    Raises
    ------
    OrchestrationError
        If the file cannot be written, and where `simulate` raises one of the subclasses.
    RunInterrupted
        If the user interrupts the run.

    Examples
    --------
    >>> from orchestration import Result, scenario, stream
    >>> stream("long.parquet", scenario("fig2"), stop_time=0.5, record="plant.*")
    5001
    >>> Result.read("long.parquet")["plant.x"].shape
    (5001, 2)
    """
    file = a_path("The file for the rows", path)
    given = {"record": record, "inputs": inputs, "changes": changes, "pace": pace, "isolate": isolate}
    run = prepare(_system(system), stop_time, step, algorithm, order=order, options=_chosen(options, given))
    run.stream_to(file)
    with run:
        run.run()
    return run.count


def prepare(
    system: System,
    stop_time: float | None = None,
    step: float | None = None,
    algorithm: str | Algorithm = "gauss-seidel",
    *,
    order: Sequence[str] | None = None,
    times: np.ndarray | None = None,
    inputs: Any = None,
    changes: Changes | None = None,
    pace: float | Pace | None = None,
    isolate: bool | str | Collection[str] | Isolation | None = None,
    options: Options | None = None,
) -> Simulation:
    """Prepare a run that can be stopped, saved, restored, changed and continued.

    Parameters
    ----------
    system, stop_time, step, algorithm, order, times, inputs, changes, pace, isolate, options
        As for `simulate`.

    Returns
    -------
    Simulation
        Context manager. The FMUs are instantiated when the context is entered.

    Raises
    ------
    SystemDescriptionError
        If the system cannot be run as asked.

    Examples
    --------
    >>> from orchestration import prepare, scenario
    >>> with prepare(scenario("fig2"), stop_time=0.5) as run:
    ...     while run.time < 0.5 and abs(run.result()["controller.e"][-1]).max() < 5e-3:  # m
    ...         run.run(until=round(run.time + 0.1, 9))
    ...     print(run.time, len(run.result()["time"]))
    0.5 5001
    """
    require_type("The system", system, System, "give a System, as System.read('loop.ssp')")
    options = _chosen(options, {"inputs": inputs, "changes": changes, "pace": pace, "isolate": isolate})
    chosen = find_algorithm(algorithm)
    if order is not None:
        system = system.ordered(order)
    grid = chosen_grid(system, (stop_time, step, times), chosen, options)
    report_descriptions(system, strict=options.strict)
    report_stiffness(system, float(grid.lengths.max()))
    report_walls(system)
    around, grid = outside(system, options, grid, controlled=chosen.control is not None)
    _report_unconnected(system, options, {*around.inputs.names, *itertools.chain(*around.changes.values())})
    metadata = isolated(system, options) | provenance(
        system,
        algorithm=repr(chosen) if isinstance(algorithm, Algorithm) else chosen.name,
        step=grid.step,
        start_time=float(grid.times[0]),
        stop_time=float(grid.times[-1]),
        order=None,
    )
    return Simulation(system, grid, chosen, options, metadata=metadata, outside=around)


def _system(system: System | str | Path) -> System:
    """A system, read from its file if need be."""
    if isinstance(system, System):
        return system
    require_type("The system", system, (str, PathLike), "give a System, or the path of an SSP package")
    return System.read(system)


def _chosen(options: Options | None, given: Mapping[str, Any]) -> Options:
    """Options with what was given beside them.

    Raises
    ------
    SystemDescriptionError
        If a choice is given twice.
    """
    if options is not None:
        require_type("options", options, Options, "give Options, as Options(every=2)")
    options = options or Options()
    given = {name: value for name, value in given.items() if value is not None}
    for name in given:
        if getattr(options, name) is not None:
            msg = f"{name} is given twice, as an argument and in the options; give it once."
            raise SystemDescriptionError(msg)
    return replace(options, **given)


def chosen_grid(
    system: System,
    wanted: tuple[float | None, float | None, np.ndarray | None],
    algorithm: Algorithm,
    options: Options,
) -> Grid:
    """Return the communication points of a run, and refuse ratios that do not fit them."""
    stop_time, step, times = wanted
    if algorithm.control is not None and times is not None:
        msg = f"Algorithm {algorithm.name} chooses its communication points itself; do not give times."
        raise SystemDescriptionError(msg)
    if times is None:
        start = system.start_time if options.start_time is None else options.start_time
        span, step = (start, system.run_stop_time(stop_time)), system.run_step(step)
        if algorithm.control is not None:
            return tick_grid(system, span, step)
        grid = fixed_grid(system, span, step, stale=options.allow_stale_inputs)
    else:
        grid = given_grid(system, times, stale=options.allow_stale_inputs)
    for name, ratio in options.ratios.items():
        if ratio >= 1 and (grid.n % ratio or grid.steps_per_tick.get(name, ratio) % ratio or grid.lengths.size > 1):
            msg = (
                f"{name}: steps of {ratio} communication steps must fit its sample time and the run of"
                f" {grid.n} equal steps."
            )
            raise SystemDescriptionError(msg)
    return grid


def isolated(system: System, options: Options) -> dict[str, str]:
    """Metadata that names the isolated components; empty if there are none.

    Raises
    ------
    SystemDescriptionError
        If a name is not that of a component.
    """
    isolation = options.isolation
    if isolation is None:
        return {}
    names = [component.name for component in system.components]
    for name in isolation.components or ():
        if name not in names:
            msg = f"isolate names {name!r}, which is no component; {suggestion(name, names)}"
            raise SystemDescriptionError(msg)
    return {"isolated": json.dumps([name for name in names if isolation.covers(name)])}


def _report_unconnected(system: System, options: Options, given: Collection[str]) -> None:
    """Warn of inputs that are neither connected nor given otherwise, or refuse them if the run is strict."""
    inputs = [name for name in system.unconnected_inputs() if name not in given]
    if not inputs:
        return
    msg = printable(f"Unconnected inputs keep their start values: {listed(inputs, MOST_LISTED)}.")
    if options.strict:
        msg = f"{msg} Connect them, or run without strict."
        raise SystemDescriptionError(msg)
    warn_caller(msg, UnconnectedInputWarning)
