"""Writes the rows of a run to a Parquet file while the run makes them."""

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orchestration.master.recorder import Sink
from orchestration.results.columns import ENDED
from orchestration.results.formats import require_parquet

if TYPE_CHECKING:
    from orchestration.results.parquet_file import ParquetSink


class Streaming:
    """The file that rows are streamed to, if there is one.

    Attributes
    ----------
    path
        The file; None if rows stay in memory.
    """

    def __init__(self) -> None:
        self.path: Path | None = None
        self._sink: ParquetSink | None = None

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
        self, stack: ExitStack, columns: tuple[str, ...], units: Mapping[str, str], **described: Any
    ) -> Sink | None:
        """Open the file until the end of a context; None without a file. Errors are those of `ParquetSink`."""
        if self.path is None:
            return None
        from orchestration.results.parquet_file import ParquetSink

        self._sink = stack.enter_context(ParquetSink(self.path, columns, units, **described))
        return self._sink

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
