"""Runs to put into a store: their keys, factors and outcomes, all of them known beforehand."""

import hashlib
from collections.abc import Sequence

import numpy as np

from orchestration.campaigns.engine import Outcomes
from orchestration.campaigns.store.keys import KEY_LENGTH
from orchestration.campaigns.store.row_table import RowColumns

COLUMNS = RowColumns({"plant.K_f": "N/m", "sensor.seed": ""}, {"peak": "N", "error": "m"}, ("system",))
MEASURES = tuple(COLUMNS.measures)
FAILED_EVERY = 7
STUDY = "0123456789abcdef"


def keys(numbers: Sequence[int]) -> np.ndarray:
    """Keys of runs, one for each number."""
    return np.array([hashlib.sha256(str(n).encode()).hexdigest()[:KEY_LENGTH] for n in numbers], f"S{KEY_LENGTH}")


def factors(numbers: Sequence[int]) -> dict[str, np.ndarray]:
    """Factors of runs."""
    n = np.asarray(numbers, float)
    return {"system": np.array([f"arm {int(k) % 2}" for k in n]), "plant.K_f": 1e5 / (n + 1), "sensor.seed": n}


def outcomes(numbers: Sequence[int]) -> Outcomes:
    """Outcomes of runs; each seventh failed."""
    n = np.asarray(numbers, np.int64)
    measured = np.stack([np.sin(n), np.cos(n)], 1)
    failed = n % FAILED_EVERY == 0
    measured[failed] = np.nan
    messages = tuple(f"plant: run {k} diverged." if bad else "" for k, bad in zip(n, failed, strict=True))
    return Outcomes(n, measured, messages)
