"""The FMUs that the conformance tests run over: those of the catalog, and two of them with Reals only."""

from pathlib import Path

from adaptimp_fmu import Model
from adaptimp_fmu.reals import as_reals
from fmus.catalog import MODELS

REALS = "reals/"
"""Begins the name of a unit with Reals in the place of Booleans and Integers."""
UNITS = (*MODELS, f"{REALS}Actuator", f"{REALS}CraigAdaptiveImpedance")
"""Names of the units; the two have Booleans as outputs, inputs and parameters, and an Integer."""


def declared(unit: str) -> Model:
    """The model of a unit."""
    model = MODELS[unit.removeprefix(REALS)]()
    return as_reals(model) if unit.startswith(REALS) else model


def file_of_unit(unit: str, fmu_folder: Path, reals_folder: Path) -> Path:
    """The FMU file of a unit."""
    return (reals_folder if unit.startswith(REALS) else fmu_folder) / f"{unit.removeprefix(REALS)}.fmu"
