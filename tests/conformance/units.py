"""The FMUs that the conformance tests run over: those of the catalog, and two of them with Reals only."""

from pathlib import Path

from adaptimp_fmu import Model
from adaptimp_fmu.reals import as_reals
from fmus.catalog import MODELS

REALS = "reals/"
"""Begins the name of an FMU with Reals in the place of Booleans and Integers."""
UNITS = (*MODELS, f"{REALS}Actuator", f"{REALS}CraigAdaptiveImpedance")
"""Names of the FMUs. The two with Reals only stand for models with Booleans in each role, and with an Integer."""


def declared(unit: str) -> Model:
    """The model of an FMU in `UNITS`."""
    model = MODELS[unit.removeprefix(REALS)]()
    return as_reals(model) if unit.startswith(REALS) else model


def file_of_unit(unit: str, fmu_folder: Path, reals_folder: Path) -> Path:
    """The file of an FMU in `UNITS`."""
    return (reals_folder if unit.startswith(REALS) else fmu_folder) / f"{unit.removeprefix(REALS)}.fmu"
