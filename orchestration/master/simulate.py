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

import warnings
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.master.algorithm import ALGORITHMS, Algorithm, find_algorithm
from orchestration.master.options import Options, Progress
from orchestration.master.progress import progress_bar
from orchestration.master.provenance import provenance
from orchestration.master.simulation import Simulation
from orchestration.master.time_grid import Grid, fixed_grid, given_grid, tick_grid
from orchestration.results.result import Result
from orchestration.system.system import System

__all__ = ["ALGORITHMS", "Options", "Progress", "UnconnectedInputWarning", "prepare", "simulate", "stream"]


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
    progress: bool | Progress = False,
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
        Outputs to record: names ``component.variable``, names of arrays, or patterns with ``*`` and ``?``.
        Default: all outputs.
    order
        Component names in the order of stepping. Default: the order of the system.
    times
        Communication points, s, shape (n + 1,), increasing, instead of `stop_time` and `step`.
    progress
        True for a bar on standard error, or a function that is called with the steps made and the steps in all.
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
    >>> float(result["plant.x[1]"].min().round(3))  # m; the wall is at -1.45
    -1.456
    """
    system = system if isinstance(system, System) else System.read(system)
    with ExitStack() as stack:
        show = stack.enter_context(progress_bar(system.name)) if progress is True else progress or None
        chosen = _chosen(options, record, show)
        run = prepare(system, stop_time, step, algorithm, order=order, times=times, options=chosen)
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
    options: Options | None = None,
) -> int:
    """Run a system and write its rows to a Parquet file during the run, so that memory stays bounded.

    If the run fails or is interrupted, the rows before are in ``STEM.partial.parquet``.

    Parameters
    ----------
    path
        Parquet file to write.
    system, stop_time, step, algorithm, record, order, options
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
    system = system if isinstance(system, System) else System.read(system)
    run = prepare(system, stop_time, step, algorithm, order=order, options=_chosen(options, record, None))
    run.stream_to(Path(path))
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
    options: Options | None = None,
) -> Simulation:
    """Prepare a run that can be stopped, saved, restored, changed and continued.

    Parameters
    ----------
    system, stop_time, step, algorithm, order, times, options
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
    options = options or Options()
    chosen = find_algorithm(algorithm)
    if order is not None:
        system = system.ordered(order)
    grid = _grid(system, (stop_time, step, times), chosen, options)
    _report_unconnected(system, options)
    metadata = provenance(
        system,
        algorithm=repr(chosen) if isinstance(algorithm, Algorithm) else chosen.name,
        step=grid.step,
        start_time=float(grid.times[0]),
        stop_time=float(grid.times[-1]),
        order=None,
    )
    return Simulation(system, grid, chosen, options, metadata=metadata)


def _chosen(options: Options | None, record: str | Sequence[str] | None, progress: Progress | None) -> Options:
    """Options with what was given beside them.

    Raises
    ------
    SystemDescriptionError
        If a choice is given twice.
    """
    options = options or Options()
    given = {"record": record, "progress": progress}
    for name, value in given.items():
        if value is not None and getattr(options, name) is not None:
            msg = f"{name} is given twice, as an argument and in the options; give it once."
            raise SystemDescriptionError(msg)
    return replace(options, **{name: value for name, value in given.items() if value is not None})


def _grid(
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
        span, step = (options.start_time, system.run_stop_time(stop_time)), system.run_step(step)
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


def _report_unconnected(system: System, options: Options) -> None:
    """Warn of unconnected inputs, or refuse them if the run is strict."""
    inputs = system.unconnected_inputs()
    if not inputs:
        return
    msg = f"Unconnected inputs keep their start values: {', '.join(inputs)}."
    if options.strict:
        raise SystemDescriptionError(msg)
    warnings.warn(msg, UnconnectedInputWarning, stacklevel=4)
