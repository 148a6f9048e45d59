"""Results as Parquet files: every bit of every value, units, metadata and steps per tick.

The column ``time`` comes first, then one column per variable, one row per communication point. Units stand in
the field metadata ``unit``, the rest in file metadata whose keys begin with ``adaptimp.``. Same input, same bytes.
"""

import base64
import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from orchestration.errors import OrchestrationError
from orchestration.results.arrow_table import arrow_schema, arrow_table, columns_of, rows_per_group
from orchestration.results.columns import COMPLETE, FAILED, INTERRUPTED, Columns
from orchestration.results.whole_file import draft_path, partial_path, remove_draft, write_errors

PREFIX = "adaptimp."
UNITS, STEPS_PER_TICK, SAMPLE_TIMES = "units", "steps_per_tick", "sample_times"
STATUS, MESSAGE = "status", "message"
RESERVED = (UNITS, STEPS_PER_TICK, SAMPLE_TIMES, STATUS, MESSAGE)
"""Keys of metadata that a file has for itself; those of the status only where it is not complete."""

# Neighbouring values share sign and exponent: split into streams of bytes, a run of Fig. 2 needs half
# the space of the default dictionaries, and a third of the time.
_ENCODING = {"compression": "zstd", "use_dictionary": False, "use_byte_stream_split": True}


def write_parquet(columns: Columns, path: Path) -> None:
    """Write a Parquet file; see `ParquetSink`.

    Raises
    ------
    OrchestrationError
        If the file cannot be written.
    """
    ticks = {"steps_per_tick": columns.steps_per_tick, "sample_times": columns.sample_times}
    with ParquetSink(path, columns.names, columns.units, columns.metadata, **ticks) as sink:
        sink.status, sink.message = columns.status, columns.message
        sink.append(columns.time, columns.rows)


def read_parquet(path: Path) -> Columns:
    """Read a Parquet file of this or another tool whose first column is ``time``.

    Raises
    ------
    OSError, ValueError, pyarrow.ArrowException
        If the file cannot be read or holds no such columns.
    """
    from pyarrow.parquet import ParquetFile

    with path.open("rb") as file, ParquetFile(file) as source:
        table = source.read()
        raw = source.metadata.metadata or {}
    prefix = PREFIX.encode()
    found = {k.removeprefix(prefix).decode(): v.decode() for k, v in raw.items() if k.startswith(prefix)}
    declared = {field.name: (field.metadata or {}).get(b"unit", b"").decode() for field in table.schema}
    units = json.loads(found.pop(UNITS)) if UNITS in found else declared
    ratios, periods = (json.loads(found.pop(key, "{}")) for key in (STEPS_PER_TICK, SAMPLE_TIMES))
    status, message = json.loads(found.pop(STATUS, f'"{COMPLETE}"')), json.loads(found.pop(MESSAGE, '""'))
    kept = {"steps_per_tick": ratios, "sample_times": periods, "status": status, "message": message}
    return replace(columns_of(table), units=units, metadata=found, **kept)


class ParquetSink:
    """Writes rows as they come, in bounded memory; a context manager.

    If the block is left by an exception, the rows appended before are kept as
    ``STEM.partial.parquet``, and what was at the path before stays. If the file itself cannot be
    written, on a full disk for example, nothing is kept: Parquet has its table of contents at the end.

    Parameters
    ----------
    path
        Where the file appears when the block ends well.
    names
        Columns as ``component.variable``, without time.
    units
        Unit of each column, empty where none is declared.
    metadata
        See `Result`; may not have the keys of `RESERVED`.
    steps_per_tick, sample_times
        See `Result`.

    Attributes
    ----------
    metadata
        A dictionary that may be supplemented until the block ends.
    status, message
        See `Columns`; may be set until the block ends, and are set by an exception.
    count
        Number of rows appended.
    written
        The file that holds them, None before the end of the block and where nothing is kept.

    Raises
    ------
    OrchestrationError
        If a key of the metadata is taken; at the end of the block, the rows are kept as above.
    """

    def __init__(
        self,
        path: Path,
        names: Sequence[str],
        units: Mapping[str, str] | None = None,
        metadata: Mapping[str, str] | None = None,
        *,
        steps_per_tick: Mapping[str, int] | None = None,
        sample_times: Mapping[str, float] | None = None,
    ) -> None:
        self.path = path
        self.names = tuple(names)
        self.metadata = dict(metadata or {})
        self.status, self.message = COMPLETE, ""
        self.count = 0
        self.written: Path | None = None
        ticks = {STEPS_PER_TICK: dict(steps_per_tick or {}), SAMPLE_TIMES: dict(sample_times or {})}
        self._own = {UNITS: dict(units or {}), **ticks}
        self._file_metadata()
        self._schema = arrow_schema(self.names, self._own[UNITS])
        self._buffer = np.empty((0, 0))  # (n_columns + 1, rows of a group), s and the columns' units
        self._filled = 0
        self._file: Any = None
        self._writer: Any = None

    def __enter__(self) -> Self:
        """Open the draft.

        Raises
        ------
        OrchestrationError
            If the file cannot be written.
        """
        import pyarrow.parquet

        with write_errors(self.path):
            self.path.parent.mkdir(parents=True, exist_ok=True)
            if self.path.is_dir():  # to be known before the run, not after it
                raise IsADirectoryError(None, "Is a directory")
            self._file = draft_path(self.path).open("wb")
        # The schema goes into the file at the end, when its metadata is complete.
        self._writer = pyarrow.parquet.ParquetWriter(self._file, self._schema, store_schema=False, **_ENCODING)
        self._buffer = np.empty((len(self.names) + 1, rows_per_group(len(self.names))))
        return self

    def append(self, time: np.ndarray, rows: np.ndarray) -> None:
        """Append rows; how they are dealt out to calls does not change the file.

        Parameters
        ----------
        time
            Communication points, s, shape (n,).
        rows
            Values, shape (n, n_columns).

        Raises
        ------
        OrchestrationError
            If the shapes do not fit, the sink is not open, or the file cannot be written.
        """
        if self._writer is None:
            msg = f"{self.path}: rows can be appended only within the sink's `with` block, and not after a failure."
            raise OrchestrationError(msg)
        if time.ndim != 1 or rows.shape != (time.size, len(self.names)):
            msg = (
                f"{self.path}: times of shape {time.shape} and rows of shape {rows.shape} were given;"
                f" (n,) and (n, {len(self.names)}) are needed."
            )
            raise OrchestrationError(msg)
        done = 0
        while done < time.size:
            if self._filled == self._buffer.shape[1]:
                self._flush()
            taken = min(time.size - done, self._buffer.shape[1] - self._filled)
            place = self._buffer[:, self._filled : self._filled + taken]
            place[0] = time[done : done + taken]
            place[1:] = rows[done : done + taken].T
            self._filled += taken
            self.count += taken
            done += taken

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Move the whole file, or the part that there is, to its place.

        Raises
        ------
        OrchestrationError
            If the file cannot be written, or a key of the metadata is taken.
        """
        if self._writer is None:
            return
        fault = error
        try:
            self._file_metadata()
        except OrchestrationError as taken:
            fault, self.metadata = fault or taken, {}
        if fault is not None:
            self.status = INTERRUPTED if isinstance(fault, KeyboardInterrupt) else FAILED
            self.message = str(fault)
        try:
            self._close(self.path if fault is None else partial_path(self.path))
        except OrchestrationError as lost:
            if fault is None:
                raise
            fault.add_note(f"{lost} Nothing is kept.")
        if fault is not error and fault is not None:
            raise fault

    def _close(self, target: Path) -> None:
        """Write what is left, and move the draft; without rows only to the path itself."""
        try:
            self._flush()
            metadata = self._file_metadata()
            with write_errors(self.path):
                schema = base64.b64encode(self._schema.with_metadata(metadata).serialize()).decode()
                self._writer.add_key_value_metadata({**metadata, "ARROW:schema": schema})
                self._writer.close()
                self._file.close()
                if self.count or target == self.path:
                    draft_path(self.path).replace(target)
                    self.written = target
        finally:
            self._abandon()

    def _flush(self) -> None:
        """Write the buffer as a row group; a sink that fails to is closed."""
        filled, self._filled = self._filled, 0  # first, or an interrupt could have it written twice
        if filled == 0:
            return
        try:
            with write_errors(self.path):
                self._writer.write_table(arrow_table(self._schema, [column[:filled] for column in self._buffer]))
        except Exception:
            self._abandon()
            raise

    def _abandon(self) -> None:
        """Let go of the draft, whatever state it is in."""
        if self._writer is None:
            return
        self._writer = None
        self._buffer = np.empty((0, 0))
        with suppress(OSError):
            self._file.close()
        remove_draft(self.path)

    def _file_metadata(self) -> dict[str, str]:
        for key, value in self.metadata.items():
            if key in RESERVED or not isinstance(value, str):
                taken = ", ".join(RESERVED)
                msg = f"{self.path}: metadata {key!r} = {value!r}: a text is needed, under another key than {taken}."
                raise OrchestrationError(msg)
        ended = {} if self.status == COMPLETE else {STATUS: self.status, MESSAGE: self.message}
        own = {key: json.dumps(value, ensure_ascii=False) for key, value in {**self._own, **ended}.items()}
        return {PREFIX + key: value for key, value in sorted({**self.metadata, **own}.items())}
