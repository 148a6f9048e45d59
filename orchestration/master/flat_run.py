"""Initializes the components of a run, and makes everything that its compiled loop works on."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from orchestration.fmi.experiment import Experiment as FmuExperiment
from orchestration.fmi.instance import Instance
from orchestration.master.algorithm import SEQUENTIAL, Algorithm
from orchestration.master.call_watch import CallWatch
from orchestration.master.flatten import Assembly, assemble
from orchestration.master.initialization import initialize
from orchestration.master.kernel import series
from orchestration.master.kernel.step_program import operations_of_step
from orchestration.master.options import Options
from orchestration.master.outside import Outside
from orchestration.master.step_arrays import Experiment, Layout, layout
from orchestration.master.time_grid import Grid
from orchestration.sandbox.guard import Guard
from orchestration.system.system import System


@dataclass(frozen=True)
class FlatRun:
    """What a loop works on.

    Attributes
    ----------
    operations
        Those of a step of fixed length.
    series
        Table of time series, whose address the others have; None without series.
    watch
        Follows the calls of FMUs that log.
    """

    assembly: Assembly
    operations: np.recarray
    layout: Layout
    series: np.ndarray | None = field(repr=False)
    watch: CallWatch = field(repr=False)


def flat_run(
    system: System,
    instances: Sequence[Instance],
    algorithm: Algorithm,
    grid: Grid,
    *,
    options: Options,
    outside: Outside,
    guard: Guard | None = None,
) -> FlatRun:
    """Flatten a system with its instances, initialize the instances, and lay out the arrays of a run.

    Raises
    ------
    SystemDescriptionError
        If a variable to record cannot be recorded.
    InitializationError
        If a component refuses its start values, or an algebraic loop has no solution.
    """
    start = float(grid.times[0])
    fetched, driven, beside = options.crossings.outputs, outside.inputs.names, len(outside.units)
    assembly = assemble(system, instances, options.record, fetched, driven, beside=beside)
    watch = CallWatch(assembly.plan.table, instances)
    table = outside.inputs.table(assembly.driven)
    first = None if table is None else (table, float(grid.lengths[0]))
    told = _experiment(grid, options)
    initialize(system, instances, assembly, start, first, experiment=told, guard=guard)
    addresses = None if table is None else (series.address(), table.ctypes.data)
    operations = operations_of_step(assembly.plan, sequential=algorithm.exchange == SEQUENTIAL, series=addresses)
    arrays = layout(system, instances, assembly, algorithm, Experiment.of(grid, options), table)
    watch.complete(operations)
    arrays.start(assembly.plan.reals, start)
    return FlatRun(assembly, operations, arrays, table, watch)


def _experiment(grid: Grid, options: Options) -> FmuExperiment:
    """What the FMUs are told of the run; rounding does not bring the end of the last step behind the stop time."""
    last = float(max(grid.times[-1], grid.times[-2] + grid.lengths[-1]))
    return FmuExperiment(stop_time=last if options.fmu_stop_time else None, tolerance=options.fmu_tolerance)
