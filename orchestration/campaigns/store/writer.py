"""Writing of finished runs: what was appended is there whatever ends the process."""

from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Self

import numpy as np

from adaptimp_fmu.files.locks import waiting_lock
from orchestration.campaigns.engines.engine import Outcomes
from orchestration.campaigns.store.row_files import Place, StoreWarning, merge, replace_rows, store_errors, write_rows
from orchestration.campaigns.store.row_table import RowColumns
from orchestration.errors import StoreError, warn_caller

if TYPE_CHECKING:
    import pyarrow as pa

MOST_FILES = 64
"""Number of files of single appends from which on they become one file."""


class RowWriter:
    """Writer of the finished runs of one study; to be used as a context manager.

    Each `append` makes a small file with one group of rows. `MOST_FILES` of them become one file; at the end of the
    context all files of the study become one.

    Parameters
    ----------
    place
        Where the files go.
    columns
        Columns of the study's table.
    """

    def __init__(self, place: Place, columns: RowColumns) -> None:
        self.place, self.columns = place, columns
        self._small: dict[Path, pa.Table] = {}  # what was appended since files were last merged
        self._open = True

    def __enter__(self) -> Self:
        """Begin to write."""
        return self

    def append(self, keys: np.ndarray, factors: Mapping[str, np.ndarray], outcomes: Outcomes) -> None:
        """Append finished runs, which are kept from then on even if the process is killed (SIGKILL).

        A loss of power may cost what the operating system has not yet written to the disk.

        Parameters
        ----------
        keys
            Keys of the runs, shape (n,).
        factors
            Values of each factor in the columns, shape (n,) each.
        outcomes
            Numbers, measures and messages of the runs, in the same order.

        Raises
        ------
        StoreError
            If the rows do not fit the columns, the context has ended, or the rows cannot be written.
        """
        if not self._open:
            msg = f"{self.place.rows}: runs can be appended only within the writer's `with` block."
            raise StoreError(msg)
        if len(keys) == 0:
            return
        table = self.columns.table(keys, factors, outcomes)
        with store_errors(self.place.rows):
            self._small[write_rows(self.place, table)] = table
            if len(self._small) >= MOST_FILES:
                self._merge_small()

    def close(self) -> None:
        """End the writing, and make one file of all files of the study."""
        if not self._open:
            return
        self._open, self._small = False, {}
        try:
            with waiting_lock(self.place.drafts / f"{self.place.rows.name}.lock"):
                merge(self.place)
        except OSError as error:
            msg = f"{self.place.rows}: small files cannot be merged: {error.strerror or error}; no run is lost."
            warn_caller(msg, StoreWarning)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the writing; after a failure small files stay for the next writer."""
        if kind is None:
            self.close()
        self._open = False

    def _merge_small(self) -> None:
        """Make one file of what was appended since the last time, without reading it again."""
        import pyarrow as pa

        small, self._small = self._small, {}
        replace_rows(self.place, list(small), pa.concat_tables(small.values()).combine_chunks())
