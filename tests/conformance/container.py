"""A container that keeps the rules of all FMUs: an arm with its actuator, and a sensor with noise.

The commands of the torques are inputs of the container. It has tunable parameters, Booleans, an Integer, noise,
contact and an output that an input reaches through another component in initialization.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from orchestration import System
from orchestration.containers.fmu.write import write_fmu
from tests.conformance.units import SPATIAL, UNITS

CONTAINER = "ActuatedArm"
FMUS = [*UNITS, *SPATIAL, CONTAINER]
"""Names of all FMUs that are tested, the container last."""
of_models = pytest.mark.parametrize("identifier", UNITS)
"""Marks a test of each FMU of the catalog's models: the others have no reference and no table of declarations here."""
PARTS = {"actuator": "Actuator", "plant": "Plant", "sensor": "ForceSensor"}
STEP, STOP = 1e-4, 1.0  # s


def container_system(fmu_folder: Path) -> System:
    """The system that the container is made of."""
    system = System.of({name: fmu_folder / f"{model}.fmu" for name, model in PARTS.items()}, CONTAINER)
    connected = system.connect("actuator.tau -> plant.tau", "plant.F_ext -> sensor.F_ext")
    return replace(connected, step=STEP, stop_time=STOP)


def write_container(fmu_folder: Path, folder: Path, platforms: Sequence[str] | None = None) -> Path:
    """Write the container, for this machine or for the platforms of the given names."""
    return write_fmu(container_system(fmu_folder), folder / f"{CONTAINER}.fmu", platforms=platforms)
