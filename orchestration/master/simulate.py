"""Run a system.

    result = simulate(system, stop_time=2.0, step=1e-4)

Pseudocode of the whole:

    instantiate; set start values; propagate outputs to inputs in initialization mode
    row 0 = outputs
    for k = 0, ..., n - 1:   t = t0 + k step
        a step of the algorithm; see `orchestration.master.algorithm`
        row k + 1 = outputs

Outputs are never read after inputs are set without a doStep in between.
"""

import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.master.algorithm import ALGORITHMS, Algorithm, find_algorithm
from orchestration.master.options import Options, Progress
from orchestration.master.provenance import provenance
from orchestration.master.simulation import Simulation
from orchestration.master.time_grid import Grid, fixed_grid, given_grid, tick_grid
from orchestration.results.result import Result
from orchestration.system.system import System

__all__ = ["ALGORITHMS", "Options", "Progress", "UnconnectedInputWarning", "prepare", "simulate", "stream"]


class UnconnectedInputWarning(UserWarning):
    """Inputs that no connection drives keep their start values."""


def simulate(
    system: System,
    stop_time: float | None = None,
    step: float | None = None,
    algorithm: str | Algorithm = "gauss-seidel",
    *,
    order: Sequence[str] | None = None,
    times: np.ndarray | None = None,
    options: Options | None = None,
) -> Result:
    """Run a system.

    Parameters
    ----------
    stop_time, step
        s; the system's own if None, and one of them is needed. The duration must be a multiple of the step.
    algorithm
        One of `ALGORITHMS`, or an `Algorithm`.
    order
        Component names; the order of the system if None.
    times
        Communication points, s, shape (n + 1,), increasing, instead of `stop_time` and `step`.
    options
        See `Options`.

    Returns
    -------
    Result
        A row per recorded step, and row 0.

    Raises
    ------
    SystemDescriptionError
        If the system cannot be run as asked.
    InitializationError
        If a component refuses its start values.
    SimulationError
        If a component fails; ``error.result`` has the rows made before.
    RunInterrupted
        If the user interrupts; it has the rows made before.
    """
    with prepare(system, stop_time, step, algorithm, order=order, times=times, options=options) as simulation:
        simulation.run()
        return simulation.result()


def stream(
    path: str | Path,
    system: System,
    stop_time: float | None = None,
    step: float | None = None,
    algorithm: str | Algorithm = "gauss-seidel",
    *,
    order: Sequence[str] | None = None,
    options: Options | None = None,
) -> int:
    """Run a system, writing rows to a Parquet file as they come; memory stays bounded.

    If the run fails or is interrupted, the rows made before are in ``STEM.partial.parquet``.

    Returns
    -------
    int
        Number of rows.

    Raises
    ------
    OrchestrationError, RunInterrupted
        As `simulate`; also if the file cannot be written.
    """
    run = prepare(system, stop_time, step, algorithm, order=order, options=options)
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
    """A run that can be saved, taken back, branched and continued; parameters as of `simulate`.

    Returns
    -------
    Simulation
        To be used as a context manager.

    Raises
    ------
    SystemDescriptionError
        If the system cannot be run as asked.
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


def _grid(
    system: System,
    wanted: tuple[float | None, float | None, np.ndarray | None],
    algorithm: Algorithm,
    options: Options,
) -> Grid:
    stop_time, step, times = wanted
    if algorithm.control is not None and times is not None:
        msg = f"Algorithm {algorithm.name} chooses its communication points; give no times."
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
    inputs = system.unconnected_inputs()
    if not inputs:
        return
    msg = f"Unconnected inputs keep their start values: {', '.join(inputs)}."
    if options.strict:
        raise SystemDescriptionError(msg)
    warnings.warn(msg, UnconnectedInputWarning, stacklevel=4)
