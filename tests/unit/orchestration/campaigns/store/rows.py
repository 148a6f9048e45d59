"""Runs to put into a store, all of them known beforehand, and what a table of them must hold."""

import hashlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa

from orchestration.campaigns.engines.engine import Outcomes
from orchestration.campaigns.store.keys import KEY_LENGTH
from orchestration.campaigns.store.row_table import RowColumns
from orchestration.campaigns.store.store import Store
from orchestration.campaigns.store.writer import RowWriter

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


def append(writer: RowWriter, numbers: Sequence[int]) -> None:
    """Append runs."""
    writer.append(keys(numbers), factors(numbers), outcomes(numbers))


def filled(folder: Path, chunks: Sequence[Sequence[int]], study: str = STUDY) -> Store:
    """A store with the runs of a study, appended in parts."""
    store = Store.open(folder)
    with store.writer(study, COLUMNS) as writer:
        for chunk in chunks:
            append(writer, chunk)
    return store


def files(store: Store, study: str = STUDY) -> list[Path]:
    """Files with the rows of a study."""
    return sorted((store.folder / "rows" / f"study={study}").iterdir())


def assert_rows(table: pa.Table, numbers: Sequence[int]) -> None:
    """The table holds the runs of these numbers, in their order and bit by bit."""
    assert table["number"].to_pylist() == list(numbers)
    assert table["key"].to_pylist() == keys(numbers).astype(str).tolist()
    expected, given = outcomes(numbers), factors(numbers)
    for i, name in enumerate(MEASURES):
        assert table[name].to_numpy().tobytes() == np.ascontiguousarray(expected.measured[:, i]).tobytes()
        assert table[name].null_count == 0
    for name in COLUMNS.factors:
        assert table[name].to_numpy().tobytes() == given[name].tobytes()
    assert table["system"].to_pylist() == given["system"].tolist()
    assert tuple(table["message"].to_pylist()) == expected.messages
