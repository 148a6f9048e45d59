"""Writes the rows of a run to a Parquet file while the run makes them."""

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from orchestration.master.recorder import Sink
from orchestration.master.texts import Texts
from orchestration.results.columns import ENDED
from orchestration.results.formats import require_parquet

if TYPE_CHECKING:
    from orchestration.results.parquet_file import ParquetSink


class Streaming:
    """The file that rows are streamed to, if there is one; then it is the sink of a `Recorder`.

    Attributes
    ----------
    path
        The file; None if rows stay in memory.
    """

    def __init__(self) -> None:
        self.path: Path | None = None
        self._sink: ParquetSink | None = None
        self._texts: Texts | None = None

    def to(self, path: Path) -> None:
        """Choose a file.

        Raises
        ------
        OrchestrationError
            If the file has another suffix than ``.parquet``.
        """
        require_parquet(path)
        self.path = path

    def sink(
        self, stack: ExitStack, columns: tuple[str, ...], units: Mapping[str, str], texts: Texts, **described: Any
    ) -> Sink | None:
        """Open the file until the end of a context; None without a file. Errors are those of `ParquetSink`.

        Parameters
        ----------
        columns, units
            Columns of numbers, and their units.
        texts
            Columns of texts, which are numbers in the rows of the run.
        described
            Further arguments of `ParquetSink`.
        """
        if self.path is None:
            return None
        from orchestration.results.parquet_file import ParquetSink

        self._texts = texts
        self._sink = stack.enter_context(ParquetSink(self.path, columns, units, texts=texts.columns, **described))
        return self

    def append(self, time: np.ndarray, rows: np.ndarray) -> None:
        """Write rows, shape (n, n_columns), and their times, s, shape (n,)."""
        if self._sink is not None and self._texts is not None:
            self._sink.append(time, *self._texts.split(rows))

    def complete(self, metadata: Mapping[str, str], ended: str) -> None:
        """Complete the file.

        Parameters
        ----------
        metadata
            All that is known of the run.
        ended
            A sentence, if a component has ended the simulation.
        """
        if self._sink is None:
            return
        self._sink.metadata |= metadata
        if ended:
            self._sink.status, self._sink.message = ENDED, ended
        self._sink.close()
