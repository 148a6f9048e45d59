"""Tests that runs have the same key if, and only if, they are made of the same content."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from orchestration import Component, Result, System
from orchestration.campaigns.engines.engine import Points
from orchestration.campaigns.engines.task import Task
from orchestration.campaigns.measuring.measure import Measure
from orchestration.campaigns.store.keys import KEY_LENGTH, RunKeys


def peak(result: Result) -> float:
    return float(result["plant.F_ext[1]"].max())


def lowest(result: Result) -> float:
    return float(result["plant.F_ext[1]"].min())


PEAK, LOWEST = Measure.of(peak, unit="N"), Measure.of(lowest, unit="N")


def task(system: System, varied: tuple[str, ...] = ("plant.K_f",), **other: object) -> Task:
    return replace(Task(system, varied, (PEAK,), 0.1), **other)


def points(*values: tuple[float, ...], step: float = 1e-4) -> Points:
    return Points(np.arange(len(values)), np.array(values, float), np.full(len(values), step))


def key(of: Task, *values: float, step: float = 1e-4) -> bytes:
    (only,) = RunKeys(of).of(points(values, step=step))
    return only


def test_keys_are_hexadecimal_and_depend_on_values_and_step_only(fig2: System) -> None:
    rows = Points(np.array([0, 1, 2, 3]), np.array([[1e5], [2e5], [1e5], [1e5]]), np.array([1e-4, 1e-4, 1e-4, 5e-5]))
    keys = RunKeys(task(fig2)).of(rows)
    assert all(len(k) == KEY_LENGTH and int(k, 16) >= 0 for k in keys)
    assert keys[0] == keys[2]
    assert len({*keys}) == 3


def test_the_same_run_of_another_study_has_the_same_key(fig2: System) -> None:
    varied = key(task(fig2), 2e5)
    assert varied == key(task(fig2.set({"plant.K_f": 2e5}), ()))
    both = task(fig2.set({"plant.K_f": 7.0}), ("sensor.seed", "plant.K_f"))
    assert varied == key(both, float(fig2["sensor"]["seed"]), 2e5)
    default = float(fig2["plant"].description.variables["mu"].start or 0.0)
    assert varied == key(task(fig2.set({"plant.mu": default})), 2e5)


def test_a_copy_of_the_fmus_elsewhere_gives_the_same_keys(fig2: System, tmp_path: Path) -> None:
    copies = []
    for component in fig2.components:
        copy = Component.read(shutil.copy(component.path, tmp_path / f"{component.name}.fmu"), component.name)
        copies.append(replace(copy, start=component.start))
    moved = replace(fig2, components=tuple(copies), name="moved")
    assert key(task(moved), 1e5) == key(task(fig2), 1e5)


def test_a_written_system_that_is_read_again_gives_the_same_keys(fig2: System, tmp_path: Path) -> None:
    again = System.read(fig2.write(tmp_path / "fig2.ssp"))
    assert key(task(again), 1e5) == key(task(fig2), 1e5)


CHANGES: dict[str, Callable[[Task], Task]] = {
    "a start value": lambda t: replace(t, system=t.system.set({"plant.mu": 1e-9})),
    "a text": lambda t: replace(t, algorithm="jacobi"),
    "the stop time": lambda t: replace(t, stop_time=0.2),
    "the start time": lambda t: replace(t, system=replace(t.system, start_time=0.1)),
    "the order": lambda t: replace(t, system=t.system.ordered(list(t.system)[::-1])),
    "a connection": lambda t: replace(t, system=replace(t.system, connections=t.system.connections[1:])),
    "a scaled connection": lambda t: replace(t, system=_scaled(t.system)),
    "a measure": lambda t: replace(t, measures=(LOWEST,)),
    "one more measure": lambda t: replace(t, measures=(PEAK, LOWEST)),
    "a measure's name": lambda t: replace(t, measures=(replace(PEAK, names=("top",)),)),
    "the last bit": lambda t: replace(t, system=t.system.set({"plant.D_f": float(np.nextafter(0.0, 1.0))})),
}


def _scaled(system: System) -> System:
    first = system.connections[0]
    return replace(system, connections=(replace(first, factor=2.0), *system.connections[1:]))


@pytest.mark.parametrize("change", CHANGES)
def test_whatever_changes_a_run_changes_its_key(fig2: System, change: str) -> None:
    assert key(CHANGES[change](task(fig2)), 1e5) != key(task(fig2), 1e5)


def test_the_order_of_measures_does_not_count(fig2: System) -> None:
    assert key(task(fig2, measures=(PEAK, LOWEST)), 1e5) == key(task(fig2, measures=(LOWEST, PEAK)), 1e5)


def test_another_fmu_gives_another_key(fig2: System, fmu_folder: Path) -> None:
    swapped = fig2.replace("controller", fmu_folder / "CraigAdaptiveImpedance.fmu")
    assert key(task(swapped), 1e5) != key(task(fig2), 1e5)


def test_values_do_not_move_between_variables(fig2: System) -> None:
    of = task(fig2, ("plant.m[1]", "plant.m[2]"))
    assert key(of, 1.0, 2.0) != key(of, 2.0, 1.0)
    assert key(of, 1.0, 2.0) == key(task(fig2, ("plant.m[2]", "plant.m[1]")), 2.0, 1.0)


def test_keys_of_many_runs_are_those_of_each(fig2: System, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("orchestration.campaigns.store.keys._AT_ONCE", 3)
    rows = points(*[(float(k),) for k in range(10)])
    together = RunKeys(task(fig2)).of(rows)
    assert together.tolist() == [key(task(fig2), float(k)) for k in range(10)]
    assert RunKeys(task(fig2)).of(rows[:0]).shape == (0,)
