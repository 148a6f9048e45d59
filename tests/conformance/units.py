"""The FMUs that the conformance tests run over: those of the catalog, of the PUMA 560, and two with Reals only."""

from pathlib import Path

from adaptimp_fmu import Model
from adaptimp_fmu.reals import as_reals
from fmus.catalog import MODELS, VARIANTS
from orchestration.paper.built_fmus import built

REALS = "reals/"
"""Begins the name of an FMU with Reals in the place of Booleans and Integers."""
SPATIAL = tuple(name for name in VARIANTS if name.endswith("Puma560"))
"""Names of the FMUs of an arm in space, the PUMA 560."""
UNITS = (*MODELS, *SPATIAL, f"{REALS}Actuator", f"{REALS}CraigAdaptiveImpedance")
"""Names of the FMUs. The two with Reals only stand for models with Booleans in each role, and with an Integer."""


def declared(unit: str) -> Model:
    """The model of an FMU in `UNITS`."""
    model = (MODELS | VARIANTS)[unit.removeprefix(REALS)]()
    return as_reals(model) if unit.startswith(REALS) else model


def file_of_unit(unit: str, fmu_folder: Path, reals_folder: Path) -> Path:
    """The file of an FMU in `UNITS`; one of an arm in space is in the cache, or built there."""
    if unit in SPATIAL:
        return built(unit)
    return (reals_folder if unit.startswith(REALS) else fmu_folder) / f"{unit.removeprefix(REALS)}.fmu"
