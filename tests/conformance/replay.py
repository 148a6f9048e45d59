"""Drives an FMU with its committed reference data, as any tool that knows the cross-check form would."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from fmpy.util import read_csv, read_ref_opt_file

from orchestration.paper.reference_data import FOLDER
from tests.driver import Driver


def table(identifier: str, suffix: str, folder: Path = FOLDER) -> np.ndarray:
    """The structured array in ``UNIT_suffix.csv``; only times where a unit has no inputs."""
    path = folder / identifier / f"{identifier}_{suffix}.csv"
    return read_csv(path) if path.exists() else table(identifier, "ref", folder)[["time"]]


def options(identifier: str, folder: Path = FOLDER) -> dict[str, float]:
    """What ``UNIT_ref.opt`` says."""
    return read_ref_opt_file(folder / identifier / f"{identifier}_ref.opt")


def replay(identifier: str, driver: Driver) -> dict[str, np.ndarray]:
    """Outputs by name at the communication points of the reference."""
    inputs, step = table(identifier, "in"), options(identifier)["StepSize"]

    def apply(row: np.void) -> None:
        names = [name for name in row.dtype.names or () if name != "time"]
        driver.set({n: float(row[n]) if driver.variables[n].type == "Real" else bool(row[n]) for n in names})

    driver.enter()
    apply(inputs[0])
    driver.call("fmi2ExitInitializationMode")
    rows = [driver.outputs()]
    for k, row in enumerate(inputs[:-1]):
        apply(row)
        driver.step(k * step, step)
        rows.append(driver.outputs())
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def assert_reproduces(identifier: str, path: Path, open_fmu: Callable[..., Driver]) -> None:
    """An FMU shows its reference's outputs, within RelTol of each column's largest absolute value."""
    expected, tolerance = table(identifier, "ref"), options(identifier)["RelTol"]
    for name, column in replay(identifier, open_fmu(path)).items():
        atol = tolerance * np.max(np.abs(expected[name]))
        np.testing.assert_allclose(column, expected[name], rtol=0, atol=atol, err_msg=name)
