"""Saves and restores a run: the states of its components, the values exchanged, and the rows so far."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from orchestration.errors import OrchestrationError, SystemDescriptionError
from orchestration.fmi.instance import Instance
from orchestration.master.algorithm import Algorithm
from orchestration.master.driven import DrivenInputs
from orchestration.master.flatten import Assembly
from orchestration.master.options import Options
from orchestration.master.recorder import Recorder
from orchestration.master.snapshot import Snapshot
from orchestration.master.snapshot_fit import CHANGES, require_fit
from orchestration.master.step_arrays import Layout

Change = list[float | str]  # time, variable, value


@dataclass
class Saving:
    """What a run saves, and what it is called.

    Attributes
    ----------
    system
        Name of the system, for messages.
    identity
        Hash that a run must share with a snapshot that it restores.
    intervals
        Number of intervals between the communication points of the run.
    kept
        Snapshots whose states live in the instances, and are freed with them.
    """

    system: str
    identity: str
    instances: Sequence[Instance]
    assembly: Assembly
    layout: Layout
    recorder: Recorder
    intervals: int
    kept: list[Snapshot] = field(default_factory=list)

    def save(self, time: float, changes: Sequence[Change]) -> Snapshot:
        """Return the state of the run at a time, s, with the changes made until then; see `Simulation.save`."""
        if self.recorder.streams:
            msg = f"System {self.system}: rows that go to a file cannot be taken back; keep them in memory."
            raise SystemDescriptionError(msg)
        states = tuple(instance.save() for instance in self.instances)
        plan = self.assembly.plan
        times, rows = self.recorder.rows()
        arrays = self.layout.save()
        arrays |= {"reals": plan.reals.copy(), "discretes": plan.discretes.copy()}
        arrays |= {"times": times.copy(), "rows": rows.copy(), "changes": np.array(json.dumps(changes))}
        arrays |= self.assembly.texts.table.save() if self.assembly.texts else {}
        snapshot = Snapshot(time, self.identity, arrays, states)
        if not all(isinstance(state, bytes) for state in states):
            self.kept.append(snapshot)
        return snapshot

    def restore(self, snapshot: Snapshot) -> list[Change]:
        """Restore a state, and return the changes made until then; see `Simulation.restore`."""
        if snapshot.identity != self.identity:
            msg = (
                f"System {self.system}: the snapshot at t = {snapshot.time:.9g} s is of another run; components,"
                " connections, algorithm, points, time series and recorded variables must be the same."
            )
            raise SystemDescriptionError(msg)
        whole = all(isinstance(state, bytes) for state in snapshot.states)
        if not whole and not any(snapshot is mine for mine in self.kept):
            msg = "The snapshot has states that live in another run; their FMUs do not serialize states."
            raise SystemDescriptionError(msg)
        changes = self._checked(snapshot)
        for instance, state in zip(self.instances, snapshot.states, strict=True):
            instance.restore(state)
        plan = self.assembly.plan
        self.layout.restore(snapshot.arrays)
        plan.reals[:], plan.discretes[:] = snapshot.arrays["reals"], snapshot.arrays["discretes"]
        if self.assembly.texts:
            self.assembly.texts.table.restore(snapshot.arrays)
        self.recorder.reset(snapshot.arrays["times"], snapshot.arrays["rows"])
        return changes

    def _checked(self, snapshot: Snapshot) -> list[Change]:
        """The changes that a snapshot holds, after a look at all that it holds."""
        plan, arrays = self.assembly.plan, snapshot.arrays
        present = self.layout.changing() | {"reals": plan.reals, "discretes": plan.discretes}
        limits = {"intervals": self.intervals, "rows": self.recorder.most, "columns": self.recorder.n_columns}
        require_fit(arrays, present, {**limits, "components": len(self.instances)}, self.assembly.texts)
        if len(snapshot.states) != len(self.instances):
            msg = f"The snapshot has {len(snapshot.states)} states of components, the run has {len(self.instances)}."
            raise OrchestrationError(msg)
        return json.loads(str(arrays[CHANGES]))

    def free(self) -> None:
        """Free the states that live in the instances."""
        for snapshot in self.kept:
            for instance, state in zip(self.instances, snapshot.states, strict=True):
                instance.free_state(state)
        self.kept.clear()


def choices(algorithm: Algorithm, options: Options, inputs: DrivenInputs) -> list[object]:
    """Return what a run must share with a snapshot that it restores, beside its system, columns and points."""
    chosen: list[object] = [repr(algorithm), options.every, sorted(options.ratios.items()), repr(options.crossings)]
    return [*chosen, inputs.digest] if inputs else chosen
