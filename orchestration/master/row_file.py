"""The file that receives the rows of a run while it makes them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from orchestration.master.texts import Texts
from orchestration.results.parquet_file import ParquetSink


@dataclass
class RowFile:
    """A Parquet file that takes rows of a run, in which texts are numbers; a sink of a `Recorder`."""

    file: ParquetSink
    texts: Texts

    @classmethod
    def of(
        cls, path: Path, columns: Sequence[str], units: Mapping[str, str], texts: Texts, about: Mapping[str, Any]
    ) -> "RowFile":
        """Describe the file at a path; `columns` are those of numbers, `about` are further arguments of its sink."""
        return cls(ParquetSink(path, columns, units, texts=texts.columns, **about), texts)

    def append(self, time: np.ndarray, rows: np.ndarray) -> None:
        """Write rows, shape (n, n_columns), and their times, s, shape (n,)."""
        numbers, texts = self.texts.split(rows)
        self.file.append(time, numbers, texts)
