"""The paper's five FMUs in a rig, and the same as bare generated functions."""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Self

import numpy as np

from orchestration.fmi.codes import BOOLEAN, REAL, WORST_ACCEPTED
from orchestration.fmi.instance import Instance
from orchestration.system.system import Component, System
from tests.benchmarks.native import COMPONENTS, BareUnits
from tests.benchmarks.rig import Rig, require, sources


@dataclass(frozen=True)
class Inputs:
    """Inputs that a component had in the steps of a run, in their order.

    Attributes
    ----------
    all
        As doubles, shape (n_steps, n_inputs).
    reals, booleans
        Those of each type, float64 and int32.
    """

    all: np.ndarray
    reals: np.ndarray
    booleans: np.ndarray


class Bench(Rig):
    """A rig of the five `COMPONENTS`, all outputs recorded."""

    def __init__(self, system: System, n_steps: int) -> None:
        require(tuple(c.name for c in system.components) == COMPONENTS, "bare.c is for another system.")
        super().__init__(system, n_steps)

    def __enter__(self) -> Self:
        """Open the FMUs; compile the C programs."""
        super().__enter__()
        fmus = {c.name: c.description.path for c in self.system.components}
        saturation = "saturated[1]" in self.system.component("controller").description.variables
        with TemporaryDirectory(prefix="benchmark-", ignore_cleanup_errors=True) as folder:
            self.bare = BareUnits(fmus, saturation, Path(folder))
        self._values = {c.name: _values(c, i) for c, i in zip(self.system.components, self.instances, strict=True)}
        return self

    def restore(self) -> None:
        """Back to the state after initialization, bare FMUs too."""
        super().restore()
        self.bare.start(self._values, float(self.times[0]))

    def time_bare(self, n: int) -> np.ndarray:
        """Measure the generated functions without FMI, recording nothing."""
        self.restore()
        return self.pieces(n, lambda first, last: self.bare.run(self.times, self.step, first, last))

    def time_bare_copies(self, n: int) -> np.ndarray:
        """Measure the copying from outputs to inputs between the bare FMUs."""
        self.restore()
        return self.pieces(n, lambda first, last: self.bare.copy(last - first))

    def time_copies(self, n: int, *, links: bool = False, records: bool = False) -> np.ndarray:
        """Measure what a step of the C loop does besides its calls; with neither, the empty loop."""
        self.restore()
        return self.pieces(n, lambda first, last: self.c.copy(last - first, self.rows[first + 1 :], links, records))

    def time_unit(self, name: str, inputs: Inputs, step: bool) -> np.ndarray:
        """Measure one bare FMU with given inputs: copying, and steps."""
        self.restore()

        def run(first: int, last: int) -> None:
            self.bare.replay(name, self.times[first:last], self.step, inputs.all[first:last], step)

        return self.pieces(len(inputs.all), run)

    def time_component(self, i: int, inputs: Inputs, calls: tuple[int, int, int]) -> np.ndarray:
        """Measure the calls (set, step, get) of one component with given inputs.

        Raises
        ------
        BenchmarkError
            If a call fails.
        """
        self.restore()

        def run(first: int, last: int) -> None:
            given = (inputs.reals[first:last], inputs.booleans[first:last])
            status = self.c.replay(i, (self.times[first:last], self.step), given, [bool(call) for call in calls])
            require(status <= WORST_ACCEPTED, f"Component {i} alone ended with status {status}.")

        return self.pieces(len(inputs.all), run)

    def first_contact(self, records: np.ndarray) -> int:
        """The first row in which the tip touches the wall, or the number of rows."""
        touched = records[:, self.assembly.columns.index("plant.penetration")] > 0
        return int(np.argmax(touched)) if touched.any() else len(records)

    def check_bare(self, records: np.ndarray) -> int:
        """Compare the bare FMUs with the real run, bit by bit, up to the last row of `records`.

        Returns
        -------
        int
            Number of steps with equal outputs; if the records hold no event, it should be all.
        """
        self.restore()
        widths = {c.name: len(c.description.of_causality("output")) for c in self.system.components}
        for k in range(1, len(records)):
            self.bare.run(self.times, self.step, k - 1, k)
            shown = [self.bare.outputs(name, width) for name, width in widths.items()]
            if np.concatenate(shown).tobytes() != records[k].tobytes():
                return k - 1
        return len(records) - 1

    def inputs(self, records: np.ndarray) -> dict[str, Inputs]:
        """Inputs that each component had in the steps of a run."""
        column = {path: j for j, path in enumerate(self.assembly.columns)}
        position = {component.name: i for i, component in enumerate(self.system.components)}
        found = {}
        for component in self.system.components:
            given = sources(self.system, component)
            values = np.empty((len(records) - 1, len(given)))
            for j, source in enumerate(given.values()):
                # a component that stands before this one has made the same step already
                fresh = position[source.partition(".")[0]] < position[component.name]
                values[:, j] = records[1:, column[source]] if fresh else records[:-1, column[source]]
            kinds = np.array([component.variable(name).type for name in given], dtype=object)
            reals = np.ascontiguousarray(values[:, kinds == REAL])
            booleans = np.ascontiguousarray(values[:, kinds == BOOLEAN], np.int32)
            found[component.name] = Inputs(values, reals, booleans)
        return found


def _values(component: Component, instance: Instance) -> np.ndarray:
    """All variables of an instance by value reference; references are 0, 1, ..."""
    variables = component.description.variables.values()
    values = np.full(len(variables), np.nan)
    for variable in variables:
        _, (values[variable.reference],) = instance.get(variable.type, [variable.reference])
    return values
