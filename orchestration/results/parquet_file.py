"""Files of results in Parquet format: values without loss, units, metadata and steps per tick.

The first column is ``time``; every variable has one more column, and every communication point has one row. The
unit of a column is its field metadata ``unit``. All other metadata are file metadata with keys that begin with
``adaptimp.``. The same result gives the same bytes.
"""

import base64
import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import chain
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np

from adaptimp_fmu.files.whole_file import Draft
from orchestration.errors import OrchestrationError
from orchestration.results.arrow_table import arrow_schema, arrow_table, columns_of, rows_per_group
from orchestration.results.columns import COMPLETE, FAILED, INTERRUPTED, TIME, Columns
from orchestration.results.cut_off import CutOff, description
from orchestration.results.places import partial_path, write_errors
from orchestration.results.texts import joined_texts

if TYPE_CHECKING:
    from pyarrow.parquet import ParquetFile, ParquetWriter

PREFIX = "adaptimp."
"""Beginning of the keys of all metadata in a file."""
UNITS, STEPS_PER_TICK, SAMPLE_TIMES = "units", "steps_per_tick", "sample_times"
STATUS, MESSAGE = "status", "message"
RESERVED = (UNITS, STEPS_PER_TICK, SAMPLE_TIMES, STATUS, MESSAGE)
"""Keys of metadata that this module writes itself; those of the status only if it is not complete."""

# Neighbouring values share sign and exponent, so the values are split into streams of bytes. A run of Fig. 2 then
# needs half the space and a third of the time of Parquet's default encoding by dictionaries.
_ENCODING = {"compression": "zstd", "use_dictionary": False, "use_byte_stream_split": True}


def write_parquet(columns: Columns, path: Path) -> None:
    """Write columns to a Parquet file.

    Parameters
    ----------
    columns
        Names, values, units and metadata.
    path
        File to write. An existing file is replaced when the new file is complete.

    Raises
    ------
    OrchestrationError
        If the file cannot be written.
    """
    ticks = {"steps_per_tick": columns.steps_per_tick, "sample_times": columns.sample_times}
    texts = tuple(columns.texts)
    with ParquetSink(path, columns.names, columns.units, columns.metadata, texts=texts, **ticks) as sink:
        sink.status, sink.message = columns.status, columns.message
        sink.append(columns.time, columns.rows, columns.texts)


def read_parquet(path: Path) -> Columns:
    """Read a Parquet file of this tool or of another tool, with ``time`` as the first column.

    Raises
    ------
    OSError, ValueError, pyarrow.ArrowException
        If the file cannot be read, or does not hold columns of numbers with ``time`` as the first.
    """
    from pyarrow.parquet import ParquetFile

    with path.open("rb") as file, ParquetFile(file) as source:
        return described(columns_of(source.read()), source)


def parquet_parts(path: Path) -> Iterator[Columns]:
    """Read a Parquet file by its groups of rows, so that one group is in memory at a time; errors as `read_parquet`."""
    from pyarrow.parquet import ParquetFile

    with path.open("rb") as file, ParquetFile(file) as source:
        if source.num_row_groups == 0:
            yield described(columns_of(source.read()), source)
        for i in range(source.num_row_groups):
            yield described(columns_of(source.read_row_group(i)), source)


def described(columns: Columns, source: "ParquetFile") -> Columns:
    """Return columns with the units and the metadata of their file."""
    raw, schema = source.metadata.metadata or {}, source.schema_arrow
    prefix = PREFIX.encode()
    found = {k.removeprefix(prefix).decode(): v.decode() for k, v in raw.items() if k.startswith(prefix)}
    declared = {field.name: (field.metadata or {}).get(b"unit", b"").decode() for field in schema}
    units = json.loads(found.pop(UNITS)) if UNITS in found else declared
    ratios, periods = (json.loads(found.pop(key, "{}")) for key in (STEPS_PER_TICK, SAMPLE_TIMES))
    status, message = json.loads(found.pop(STATUS, f'"{COMPLETE}"')), json.loads(found.pop(MESSAGE, '""'))
    kept = {"steps_per_tick": ratios, "sample_times": periods, "status": status, "message": message}
    return replace(columns, units=units, metadata=found, **kept)


def cut_off_parts(path: Path) -> Iterator[Columns]:
    """Read the complete groups of rows of a file that a killed process left unfinished, without metadata.

    Raises
    ------
    OSError, ValueError
        If the file cannot be read, or is not such a file, or has no complete group.
    """
    found = CutOff.open(path)
    units, ratios, periods = (found.described.get(key, {}) for key in (UNITS, STEPS_PER_TICK, SAMPLE_TIMES))
    kept = {"units": units, "steps_per_tick": ratios, "sample_times": periods, "message": "The process was killed."}
    names, count = tuple(found.described["names"]), 0
    for rows, texts in found.groups():
        count += 1
        yield replace(Columns(rows[:, 0].copy(), names, rows[:, 1:].copy(), status=INTERRUPTED, texts=texts), **kept)
    if not count:
        msg = "it ends before its first group of rows was complete"
        raise ValueError(msg)


def read_cut_off(path: Path) -> Columns:
    """Read the rows of an unfinished file at once; errors as `cut_off_parts`."""
    parts = list(cut_off_parts(path))
    whole = {"time": np.concatenate([p.time for p in parts]), "rows": np.concatenate([p.rows for p in parts])}
    return replace(parts[0], texts=joined_texts([p.texts for p in parts], tuple(parts[0].texts)), **whole)


def _rescue(draft: Path, path: Path) -> None:
    """Keep the rows of an unfinished file as a partial file; a file without a complete group is not kept."""
    parts = cut_off_parts(draft)
    try:
        first = next(parts)
    except ValueError:
        return
    ticks = {"steps_per_tick": first.steps_per_tick, "sample_times": first.sample_times}
    with ParquetSink(partial_path(path), first.names, first.units, texts=tuple(first.texts), **ticks) as sink:
        sink.status, sink.message = first.status, first.message
        for part in chain([first], parts):
            sink.append(part.time, part.rows, part.texts)


class _Draft(NamedTuple):
    """Draft of a file while its rows are written."""

    writer: "ParquetWriter"
    draft: Draft


class ParquetSink:
    """Writer of a Parquet file that takes rows during a run and needs limited memory.

    The writer is a context manager. If an exception ends the context, the rows so far are kept as
    ``STEM.partial.parquet``, and an existing file at the path stays as it is. If the file itself cannot be written,
    for example on a full disk, no row is kept: a Parquet file has its table of contents at the end.

    If the process is killed, its unfinished file stays as ``NAME.<random>.part``. `orchestration.Result.read` reads the
    groups of rows in it that are complete, and the next writer of the same path makes ``STEM.partial.parquet`` of it.

    Parameters
    ----------
    path
        Path of the file when the context ends without an exception.
    names
        Columns as ``component.variable``, without time.
    units
        Unit of each column; the text is empty where the FMU declares no unit.
    metadata
        Texts by key; the keys of `RESERVED` are not allowed.
    steps_per_tick
        Number of steps per sampling period, by the name of a sampled component.
    sample_times
        Sampling periods, s, by the name of a sampled component.
    texts
        Columns of texts as ``component.variable``.

    Attributes
    ----------
    metadata
        Dictionary that a caller may extend until the context ends.
    status, message
        As of `Columns`. A caller may set them until the context ends; an exception sets them.
    count
        Number of rows so far.
    written
        File that holds the rows; None before the end of the context, and if no row is kept.

    Raises
    ------
    OrchestrationError
        If a key of the metadata is not allowed. At the end of the context, the rows are then kept as a partial
        file.
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
        texts: Sequence[str] = (),
    ) -> None:
        self.path = path
        self.names, self.texts = tuple(names), tuple(texts)
        self.metadata = dict(metadata or {})
        self.status, self.message = COMPLETE, ""
        self.count = 0
        self.written: Path | None = None
        ticks = {STEPS_PER_TICK: dict(steps_per_tick or {}), SAMPLE_TIMES: dict(sample_times or {})}
        self._own = {UNITS: dict(units or {}), **ticks}
        self._file_metadata()
        self._schema = arrow_schema(self.names, self._own[UNITS], self.texts)
        self._buffer = np.empty((0, 0))  # later (n_columns + 1, rows of a group): time, s, and all columns
        self._texts: list[Mapping[str, np.ndarray]] = []  # of the rows in the buffer
        self._filled = 0
        self._draft: _Draft | None = None

    def __enter__(self) -> Self:
        """Create the draft of the file.

        Raises
        ------
        OrchestrationError
            If the file cannot be written.
        """
        import pyarrow.parquet

        with write_errors(self.path):
            if self.path.is_dir():  # an error before the run is better than one after the run
                raise IsADirectoryError(None, "Is a directory")
            draft = Draft(self.path, lambda left: _rescue(left, self.path))
        length = rows_per_group(len(self.names), len(self.texts))
        stream = pyarrow.PythonFile(draft.file, mode="w")
        # The schema goes into the file at the end, when its metadata is complete.
        writer = pyarrow.parquet.ParquetWriter(stream, self._schema, store_schema=False, **self._encoding())
        self._draft = _Draft(writer, draft)
        with self._abandoning():
            texts = {"texts": self.texts} if self.texts else {}
            stream.write(description(self.names, length, **self._own, **texts))
            draft.file.flush()
        self._buffer = np.empty((len(self.names) + 1, length))
        return self

    def append(self, time: np.ndarray, rows: np.ndarray, texts: Mapping[str, np.ndarray] | None = None) -> None:
        """Append rows. The number of rows per call does not change the file.

        Parameters
        ----------
        time
            Communication points, s, shape (n,).
        rows
            Values, shape (n, n_columns), in the units of the columns.
        texts
            Columns of texts by name, shape (n,).

        Raises
        ------
        OrchestrationError
            If the shapes do not fit, the context is not open, or the file cannot be written.
        """
        if self._draft is None:
            msg = f"{self.path}: rows can be appended only within the sink's `with` block, and not after a failure."
            raise OrchestrationError(msg)
        texts = texts or {}
        if tuple(texts) != self.texts or any(column.shape != time.shape for column in texts.values()):
            msg = f"{self.path}: texts of {', '.join(texts) or 'no column'} were given; columns of {time.size} for"
            msg = f"{msg} {', '.join(self.texts) or 'no column'} are needed."
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
            self._texts.append({name: column[done : done + taken] for name, column in texts.items()})
            self._filled += taken
            self.count += taken
            done += taken

    def close(self) -> None:
        """Complete the file and move it to its path before the context ends; then no rows can be appended.

        Raises
        ------
        OrchestrationError
            If the file cannot be written, or a key of the metadata is not allowed.
        """
        self.__exit__(None, None, None)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Complete the file and move it to its path, or to the path of a partial file.

        Raises
        ------
        OrchestrationError
            If the file cannot be written, or a key of the metadata is not allowed.
        """
        if self._draft is None:
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
            fault.add_note(f"{lost} No row is kept.")
        if fault is not error and fault is not None:
            raise fault

    def _close(self, target: Path) -> None:
        """Write the last rows, and move the draft to the target; a partial file without rows is not kept."""
        if self._draft is None:
            return
        try:
            self._flush()
            metadata = self._file_metadata()
            with write_errors(self.path):
                schema = base64.b64encode(self._schema.with_metadata(metadata).serialize()).decode()
                self._draft.writer.add_key_value_metadata({**metadata, "ARROW:schema": schema})
                self._draft.writer.close()
                if self.count or target == self.path:
                    self._draft.draft.publish(target)
                    self.written = target
        finally:
            self._abandon()

    def _flush(self) -> None:
        """Write the buffer as a group of rows; remove the draft if that fails."""
        filled, self._filled = self._filled, 0  # emptied first, so that an interrupt cannot cause a second write
        texts, self._texts = list(joined_texts(self._texts, self.texts).values()), []
        if filled == 0 or self._draft is None:
            return
        with self._abandoning():
            numbers = [column[:filled] for column in self._buffer]
            self._draft.writer.write_table(arrow_table(self._schema, numbers, texts))
            self._draft.draft.file.flush()  # what a killed process has written can be read

    @contextmanager
    def _abandoning(self) -> Iterator[None]:
        """Remove the draft if something cannot be written to it."""
        try:
            with write_errors(self.path):
                yield
        except Exception:
            self._abandon()
            raise

    def _abandon(self) -> None:
        """Close and remove the draft, in any state of the writer."""
        if self._draft is None:
            return
        draft, self._draft = self._draft.draft, None  # the writer ends first, while its file is still open
        self._buffer = np.empty((0, 0))
        draft.abandon()

    def _encoding(self) -> dict[str, Any]:
        """Encoding of the columns; texts cannot be split into streams of bytes."""
        return {**_ENCODING, "use_byte_stream_split": [TIME, *self.names]} if self.texts else _ENCODING

    def _file_metadata(self) -> dict[str, str]:
        """Metadata of the file with prefixed keys, in alphabetical order; an error names a key that is not allowed."""
        for key, value in self.metadata.items():
            if key in RESERVED or not isinstance(value, str):
                taken = ", ".join(RESERVED)
                msg = f"{self.path}: metadata {key!r} = {value!r}: a text is needed, under another key than {taken}."
                raise OrchestrationError(msg)
        ended = {} if self.status == COMPLETE else {STATUS: self.status, MESSAGE: self.message}
        own = {key: json.dumps(value, ensure_ascii=False) for key, value in {**self._own, **ended}.items()}
        return {PREFIX + key: value for key, value in sorted({**self.metadata, **own}.items())}
