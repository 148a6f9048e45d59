"""A loop over FMUs that knows fmi2GetReal and fmi2SetReal only, as ROS 2's fmi_adapter does.

It is written apart from the master, with ctypes and without any of its code for steps, and takes groups of components:
a group takes its inputs at once, and a later group sees what an earlier one has just given. One group of all components
is Jacobi's order, one for each is Gauss-Seidel's.
"""

import ctypes
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from orchestration import Component, System
from orchestration.fmi.codes import REAL
from orchestration.fmi.instance import c_references
from tests.driver import Driver

Groups = Sequence[Sequence[str]]
MOST_PASSES = 20  # of initialization; the figures need five
_DOUBLES = ctypes.POINTER(ctypes.c_double)
_TRANSFER = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(ctypes.c_uint), ctypes.c_size_t, _DOUBLES)
_STEP = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int)


def simultaneous(system: System) -> Groups:
    """All components in one group: Jacobi's order."""
    return [[component.name for component in system.components]]


def one_by_one(system: System) -> Groups:
    """One group for each component: Gauss-Seidel's order."""
    return [[component.name] for component in system.components]


def loop_at_once(system: System) -> Groups:
    """First each component that has no connected input, then all others at once."""
    driven = {connection.target for connection in system.connections}
    names = [component.name for component in system.components]
    return [*([name] for name in names if name not in driven), [name for name in names if name in driven]]


class _Unit:
    """A component whose variables are all Reals."""

    def __init__(self, component: Component, system: System, columns: Sequence[str]) -> None:
        variables = component.description.variables
        assert all(variable.type == REAL for variable in variables.values()), "all variables must be Reals"
        self.driver = Driver(Path(component.path))
        self._handle = self.driver.instance.component
        links = [c for c in system.connections if c.target == component.name]
        outputs = [variable.name for variable in component.description.of_causality("output")]
        self.sources = np.array([columns.index(f"{c.source}.{c.output}") for c in links], int)
        self.places = np.array([columns.index(f"{component.name}.{name}") for name in outputs], int)
        self.give = self._transfer("fmi2SetReal", [variables[c.input].reference for c in links])
        self.show = self._transfer("fmi2GetReal", [variables[name].reference for name in outputs])
        self._step = _STEP(self.driver.instance.address("fmi2DoStep"))
        start = self._transfer("fmi2SetReal", [variables[name].reference for name in component.start])
        start(np.array([float(value) for value in component.start.values()]))
        self.driver.enter()

    def _transfer(self, function: str, references: Sequence[int]) -> Callable[[np.ndarray], None]:
        """A call for these variables, with an array of values."""
        call, listed = _TRANSFER(self.driver.instance.address(function)), c_references(references)

        def transfer(values: np.ndarray) -> None:
            status = call(self._handle, listed, len(references), values.ctypes.data_as(_DOUBLES))
            assert status == 0, self.driver.messages.last()

        return transfer

    def step(self, time: float, step: float) -> None:
        """One fmi2DoStep."""
        assert self._step(self._handle, time, step, 1) == 0, self.driver.messages.last()


def columns_of(system: System) -> tuple[str, ...]:
    """Names of all outputs, in the order of the components and of their variables."""
    return tuple(f"{c.name}.{v.name}" for c in system.components for v in c.description.of_causality("output"))


def run(system: System, n_steps: int, groups: Groups) -> np.ndarray:
    """All outputs at t = k step, shape (n_steps + 1, len(columns_of(system)))."""
    columns = columns_of(system)
    rows, step = np.zeros((n_steps + 1, len(columns))), system.run_step()
    with ExitStack() as stack:
        units: dict[str, Any] = {}
        for component in system.components:
            units[component.name] = _Unit(component, system, columns)
            stack.callback(units[component.name].driver.close)
        _initialize(list(units.values()), rows[0])
        for k in range(n_steps):
            now = rows[k + 1]
            now[:] = rows[k]
            for group in groups:
                chosen = [units[name] for name in group]
                for unit in chosen:
                    unit.give(now[unit.sources])
                    unit.step(k * step, step)
                for unit in chosen:
                    now[unit.places] = _shown(unit)
    return rows


def _initialize(units: Sequence[_Unit], row: np.ndarray) -> None:
    """Pass outputs on in initialization mode until nothing changes, and leave that mode."""
    for _ in range(MOST_PASSES):
        before = row.tobytes()
        for unit in units:
            unit.give(row[unit.sources])
            row[unit.places] = _shown(unit)
        if row.tobytes() == before:
            break
    else:
        raise AssertionError("initialization does not settle")
    for unit in units:
        unit.driver.call("fmi2ExitInitializationMode")


def _shown(unit: _Unit) -> np.ndarray:
    values = np.empty(len(unit.places))
    unit.show(values)
    return values
