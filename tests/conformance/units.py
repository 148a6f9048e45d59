"""The FMUs that the conformance tests run over: those of the catalog, of the PUMA 560, and two with Reals only."""

from pathlib import Path

from adaptimp_fmu import Model
from adaptimp_fmu.reals import as_reals
from fmus.catalog import MODELS
from tests.variant_files import file_of

REALS = "reals/"
"""Begins the name of an FMU with Reals in the place of Booleans and Integers."""
UNITS = (*MODELS, f"{REALS}Actuator", f"{REALS}CraigAdaptiveImpedance")
"""Names of the FMUs. The two with Reals only stand for models with Booleans in each role, and with an Integer."""
SPATIAL = ("PlantPuma560", "ForceSensorPuma560", "SlotineLiAdaptiveImpedancePuma560")
"""Names of the FMUs of an arm in space that tests of behaviour run over, too: events, noise and a filter, adaptation.

The others of the arm have the same runtime, and no more state than these.
"""


def declared(unit: str) -> Model:
    """The model of an FMU in `UNITS`."""
    model = MODELS[unit.removeprefix(REALS)]()
    return as_reals(model) if unit.startswith(REALS) else model


def file_of_unit(unit: str, fmu_folder: Path, reals_folder: Path) -> Path:
    """The file of an FMU in `UNITS` or `SPATIAL`; the latter are in the cache, or built there."""
    if unit in SPATIAL:
        return file_of(unit)
    return (reals_folder if unit.startswith(REALS) else fmu_folder) / f"{unit.removeprefix(REALS)}.fmu"
