"""What driver.c is to do, from a system: the numbers of its PLAN file and the meaning of its rows."""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from orchestration import Component, System
from orchestration.fmi.codes import BOOLEAN, INTEGER, REAL
from orchestration.fmi.description import Variable

TYPES = {REAL: 0, INTEGER: 1, BOOLEAN: 2}  # as driver.c has them


@dataclass(frozen=True)
class Plan:
    """A system, the steps to make, and inputs that are given instead of connected.

    Attributes
    ----------
    lengths
        Length of each step, s, shape (steps,).
    given
        By ``component.input``, values during each step, shape (steps,).
    passes
        How often outputs are propagated to inputs in initialization mode.
    """

    system: System
    lengths: np.ndarray
    given: Mapping[str, np.ndarray] = field(default_factory=dict)
    passes: int = 0

    @property
    def times(self) -> np.ndarray:
        """Start of each step, s, shape (steps,): k h for equal steps, else the sum of those before."""
        if (self.lengths == self.lengths[0]).all():
            return np.arange(len(self.lengths)) * self.lengths[0]
        return np.array([0.0, *itertools.accumulate(self.lengths[:-1].tolist())])

    @property
    def outputs(self) -> list[str]:
        """All outputs as ``component.output``, in their order."""
        return [f"{c.name}.{v.name}" for c in self.system.components for v in c.description.of_causality("output")]

    def numbers(self) -> np.ndarray:
        """The PLAN file, float64."""
        signals = {name: i for i, name in enumerate([*self.given, *self.outputs])}
        counts = [len(self.system.components), len(self.lengths), len(self.given), len(signals), self.passes]
        units = [self._unit(component, signals) for component in self.system.components]
        table = np.column_stack([self.times, self.lengths, *self.given.values()])
        return np.concatenate([counts, *units, table.ravel()])

    def outputs_in(self, result: bytes) -> dict[str, np.ndarray]:
        """What the driver writes: each output after initialization and after each step, shape (steps + 1,)."""
        rows = np.frombuffer(result).reshape(len(self.lengths) + 1, -1)[:, len(self.given) :]
        return dict(zip(self.outputs, rows.T, strict=True))

    def _unit(self, component: Component, signals: Mapping[str, int]) -> Sequence[float]:
        """Counts of start values, inputs and outputs, and these as (type, reference, value or signal)."""
        sources = {c.input: f"{c.source}.{c.output}" for c in self.system.connections if c.target == component.name} | {
            name.partition(".")[2]: name for name in self.given if name.partition(".")[0] == component.name
        }
        outputs = component.description.of_causality("output")
        starts = [_item(component.variable(name), float(value)) for name, value in component.start.items()]
        inputs = [_item(component.variable(name), signals[source]) for name, source in sources.items()]
        shown = [_item(v, signals[f"{component.name}.{v.name}"]) for v in outputs]
        return [len(starts), len(inputs), len(shown), *itertools.chain(*starts, *inputs, *shown)]


def _item(variable: Variable, value: float) -> tuple[float, float, float]:
    return TYPES[variable.type], variable.reference, value
