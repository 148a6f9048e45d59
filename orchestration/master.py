"""Run a system with a fixed communication step.

    result = simulate(system, stop_time=2.0, step=1e-4)

Pseudocode of the whole:

    instantiate; set start values; propagate outputs to inputs in initialization mode
    row 0 = outputs
    for k = 0, ..., n - 1:   t = t0 + k step
        gauss-seidel: each component in order: set inputs, doStep(t, step), get outputs
        jacobi:       set all inputs, doStep all, get all outputs
        row k + 1 = outputs

Outputs are never read after inputs are set without a doStep in between.
"""

import time as clock
import warnings
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np

from orchestration import loop
from orchestration.assembly import Assembly, assemble
from orchestration.errors import InitializationError, SimulationError, SystemDescriptionError
from orchestration.fmu import WORST_ACCEPTED, Instance
from orchestration.initialize import initialize, opened
from orchestration.result import Result
from orchestration.system import RATIO_TOLERANCE, System

ALGORITHMS = {"gauss-seidel": loop.GAUSS_SEIDEL, "jacobi": loop.JACOBI}
Progress = Callable[[int, int], None]

_FIRST_CHUNK = 256  # steps; later chunks last about _CHUNK_SECONDS
_CHUNK_SECONDS = 0.1


class UnconnectedInputWarning(UserWarning):
    """Inputs that no connection drives keep their start values."""


@dataclass(frozen=True)
class Options:
    """How a run is made, besides the system, its duration and its step.

    Attributes
    ----------
    record
        Outputs to record as ``component.variable``; None records all.
    start_time
        Time of row 0, s.
    strict
        Whether an unconnected input is an error instead of a warning.
    allow_stale_inputs
        Whether a sampling period may be shorter than, or no multiple of, the step; ticks within a
        step then use the inputs of its start.
    progress
        Called now and then with (steps made, steps in all).
    """

    record: Collection[str] | None = None
    start_time: float = 0.0
    strict: bool = False
    allow_stale_inputs: bool = False
    progress: Progress | None = None


def simulate(
    system: System,
    stop_time: float | None = None,
    step: float | None = None,
    algorithm: str = "gauss-seidel",
    *,
    order: Sequence[str] | None = None,
    times: np.ndarray | None = None,
    options: Options | None = None,
) -> Result:
    """Run a system.

    Parameters
    ----------
    stop_time, step
        s; the system's own if None. The duration must be a multiple of the step.
    algorithm
        One of `ALGORITHMS`.
    order
        Component names; the order of the system if None.
    times
        Communication points, s, shape (n + 1,), increasing, instead of `stop_time` and `step`.
    options
        See `Options`.

    Returns
    -------
    Result
        n + 1 rows.

    Raises
    ------
    SystemDescriptionError
        If the system cannot be run as asked.
    InitializationError
        If a component refuses its start values.
    SimulationError
        If a component fails; ``error.result`` has the rows made before.
    """
    options = options or Options()
    if algorithm not in ALGORITHMS:
        msg = f"There is no algorithm {algorithm!r}; there are {', '.join(ALGORITHMS)}."
        raise SystemDescriptionError(msg)
    if order is not None:
        system = system.ordered(order)
    steps = _steps(system.step if step is None else step, times)
    ratios = _ratios(system, steps, options)
    stop_time = system.stop_time if stop_time is None else stop_time
    points = _points(options.start_time, stop_time, steps[0]) if times is None else np.array(times, float)
    _report_unconnected(system, options)
    with opened(system) as instances:
        assembly = assemble(system, instances, options.record)
        rows = np.empty((points.size, len(assembly.columns)))
        initialize(system, instances, assembly, float(points[0]))
        assembly.record(rows[0])
        result = Result(points, assembly.columns, rows, assembly.units, ratios)
        if fault := _not_finite(result, 0, 1):
            raise InitializationError(fault[1])
        _advance(instances, assembly, ALGORITHMS[algorithm], steps, result, options.progress)
        for instance in instances:
            status = instance.status("fmi2Terminate")
            if status > WORST_ACCEPTED:
                raise SimulationError(instance.failure("fmi2Terminate", status), result)
    return result


def _steps(step: float, times: np.ndarray | None) -> np.ndarray:
    """Step sizes, s, shape (n,), or (1,) if no communication points are given and all are equal."""
    if times is not None:
        points = np.array(times, dtype=float)
        shaped = points.ndim == 1 and points.size > 1
        if not (shaped and np.isfinite(points).all() and (np.diff(points) > 0).all()):
            msg = "The communication points must be at least two finite, increasing times."
            raise SystemDescriptionError(msg)
        return np.diff(points)
    if not (np.isfinite(step) and step > 0):
        msg = f"The step {step!r} s is not positive."
        raise SystemDescriptionError(msg)
    return np.array([step], dtype=float)


def _points(t0: float, stop_time: float, step: float) -> np.ndarray:
    """Communication points t0 + k step, s, shape (n + 1,)."""
    count = (stop_time - t0) / step
    n = round(count) if np.isfinite(count) else -1
    if n < 1 or abs(count - n) > RATIO_TOLERANCE * n:
        whole = t0 + max(1, n) * step
        msg = (
            f"The run from {t0:g} s to {stop_time:g} s is no multiple of the step {step:g} s;"
            f" stop at {whole:.9g} s instead."
        )
        raise SystemDescriptionError(msg)
    return t0 + np.arange(n + 1) * step


def _ratios(system: System, steps: np.ndarray, options: Options) -> dict[str, int]:
    """Steps per tick of the sampled components; empty where they are not whole."""
    if options.allow_stale_inputs:
        try:
            return system.steps_per_tick(float(steps[0]))
        except SystemDescriptionError:
            return {}
    shortest, longest = float(steps.min()), float(steps.max())
    ratios = system.steps_per_tick(shortest)
    if longest - shortest > RATIO_TOLERANCE * longest and system.steps_per_tick(longest) != ratios:
        msg = f"Steps from {shortest:g} s to {longest:g} s do not fit the sample times."
        raise SystemDescriptionError(msg)
    return ratios


def _report_unconnected(system: System, options: Options) -> None:
    inputs = system.unconnected_inputs()
    if not inputs:
        return
    msg = f"Unconnected inputs keep their start values: {', '.join(inputs)}."
    if options.strict:
        raise SystemDescriptionError(msg)
    warnings.warn(msg, UnconnectedInputWarning, stacklevel=3)


def _advance(
    instances: Sequence[Instance],
    assembly: Assembly,
    algorithm: int,
    steps: np.ndarray,
    result: Result,
    progress: Progress | None,
) -> None:
    """Make all steps, in chunks, so that interrupts and progress get through."""
    n = result.time.size - 1
    done, chunk = 0, _FIRST_CHUNK
    while done < n:
        last = min(n, done + chunk)
        started = clock.perf_counter()
        k, i, call, status = loop.run(assembly.plan, algorithm, (result.time, steps), (done, last), result.rows)
        elapsed = clock.perf_counter() - started
        if k < last:
            where = f" at t = {result.time[k]:.9g} s (step {k})"
            message = instances[i].failure(loop.CALL_NAMES[call], status, where)
            raise SimulationError(message, _first_rows(result, k + 1))
        if fault := _not_finite(result, done + 1, last + 1):
            raise SimulationError(fault[1], _first_rows(result, fault[0]))
        done = last
        chunk = max(1, int(chunk * min(4.0, _CHUNK_SECONDS / max(elapsed, 1e-6))))
        if progress is not None:
            progress(done, n)


def _not_finite(result: Result, first: int, last: int) -> tuple[int, str] | None:
    """The first row with a value that is NaN or infinite, and the sentence that says so."""
    finite = np.isfinite(result.rows[first:last])
    if finite.all():
        return None
    bad = np.argwhere(~finite)
    k, column = first + int(bad[0, 0]), bad[0, 1]
    why = "the run has diverged" if k > 0 else "start values are wrong or missing"
    where = f"at t = {result.time[k]:.9g} s (row {k})"
    return k, f"{result.names[column]} is {result.rows[k, column]} {where}; {why}."


def _first_rows(result: Result, count: int) -> Result:
    return Result(
        result.time[:count].copy(),
        result.names,
        result.rows[:count].copy(),
        result.units,
        result.steps_per_tick,
    )
