"""What acts on a run from outside its system: time series, changes of values, and the clock."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from orchestration.master.changes import scheduled, times_of
from orchestration.master.driven import DrivenInputs, driven_inputs, require_cover
from orchestration.master.options import Options
from orchestration.master.pacing import Pace, Pacer
from orchestration.master.time_grid import Grid, with_points
from orchestration.results.columns import LATENESS
from orchestration.system.system import System


@dataclass(frozen=True)
class Outside:
    """What acts on a run from outside.

    Attributes
    ----------
    inputs
        Inputs that take their values from time series.
    changes
        Values by ``component.variable``, by the index of the communication point at which they are set.
    pacer
        Keeps the run to a clock; None to go as fast as possible.
    """

    inputs: DrivenInputs = field(default_factory=DrivenInputs)
    changes: Mapping[int, Mapping[str, float | bool | str]] = field(default_factory=dict)
    pacer: Pacer | None = None

    def reach(self, grid: Grid, interval: int, last: int) -> int:
        """Return the point up to which to step now from a point: not beyond a change, nor ahead of the clock."""
        last = min([last, *(k for k in self.changes if k > interval)])
        return last if self.pacer is None else self.pacer.reach(grid.times, interval, last)

    @property
    def units(self) -> dict[str, str]:
        """Columns that a run has beside the recorded variables, with their units."""
        return {LATENESS: "s"} if self.pacer else {}

    def described(self) -> dict[str, str]:
        """Metadata of a result."""
        return {**self.inputs.described(), **(self.pacer.described() if self.pacer else {})}


def outside(system: System, options: Options, grid: Grid, *, controlled: bool) -> tuple[Outside, Grid]:
    """Bind what the options say to a system; returns it with the grid, which gets further points in a controlled run.

    Steps of a controlled run end where a time series jumps or bends, and where a value changes, as they do on ticks.

    Raises
    ------
    SystemDescriptionError
        If a time series or a change does not fit the system or the run.
    """
    inputs = driven_inputs(system, options.inputs)
    require_cover(inputs, float(grid.times[0]), float(grid.times[-1]))
    changes = options.changes or {}
    if controlled:
        grid = with_points(grid, np.concatenate([inputs.corners(), times_of(changes)]))
    pace = Pace.of(options.pace)
    found = Outside(inputs, scheduled(system, changes, grid, inputs.names), Pacer(pace) if pace else None)
    return found, grid
