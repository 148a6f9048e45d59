"""Systems of the adaptive figures with numbers changed, and what a run shows.

The tests take the figures at the earlier calibration, ``fig5-first`` and so on: its noise is new at every tick, its
bounds of errors are derived beside the tests, and a run has half the steps of one at the chosen calibration.
"""

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from fmus.catalog import MODELS
from orchestration import Options, Result, System, simulate
from orchestration.paper.built_fmus import fmus
from orchestration.paper.scenarios import ALL_SCENARIOS

CONTROLLERS = (
    "HoganImpedance",
    "CraigAdaptiveImpedance",
    "SlotineLiAdaptiveImpedance",
    "SpongOrtegaAdaptiveImpedance",
)
QUIET = {"sensor.noise_std": 0.0, "sensor.noise_bound": 0.0}
UNLIMITED = {"actuator.tau_max[1]": 1e9, "actuator.tau_max[2]": 1e9}


@cache
def files() -> Mapping[str, Path]:
    """All FMU files by model identifier."""
    return fmus(MODELS)


def system(name: str, changes: Mapping[str, float] | None = None) -> System:
    """A figure's system, with start values changed by ``component.variable``."""
    return ALL_SCENARIOS[name].system(files()).set(changes or {})


def run(given: System, **options: Any) -> Result:
    """A run in which an unconnected input is an error."""
    return simulate(given, options=Options(strict=True, **options))


def pair(path: str, first: float, second: float) -> dict[str, float]:
    """Both elements of a vector."""
    return {f"{path}[1]": first, f"{path}[2]": second}


def norms(result: Result, name: str) -> np.ndarray:
    """Euclidean norms of a vector at the communication points, shape (n_rows,)."""
    return np.linalg.norm(result[name], axis=1)
