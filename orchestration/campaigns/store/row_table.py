"""Tables of finished runs, as they stand in the Parquet files of a store.

The columns are ``number``, ``key``, the factors, the measures and ``message``. Numbers are doubles with all their
bits; the unit of a column is its field metadata ``unit``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from orchestration.campaigns.engines.engine import Outcomes
from orchestration.campaigns.store.keys import KEY_LENGTH
from orchestration.errors import StoreError

if TYPE_CHECKING:
    import pyarrow as pa

NUMBER, KEY, MESSAGE = "number", "key", "message"
RESERVED = (NUMBER, KEY, MESSAGE, "study")
"""Columns of every table, and the one that readers of Parquet make of a folder's name."""
MARK = b"adaptimp.runs"
"""Key in the metadata of a file, whose value is the version of the format."""
FORMAT = b"1"


@dataclass(frozen=True)
class RowColumns:
    """Columns of a study's table besides the number, the key and the message of a run.

    Attributes
    ----------
    factors
        Units of the factors that are numbers, by column; an empty text where there is none.
    measures
        Units of the measures, by column.
    texts
        Columns of the factors that are texts.
    """

    factors: Mapping[str, str]
    measures: Mapping[str, str]
    texts: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        """Refuse a name that is used twice, or that every table has."""
        names = [*RESERVED, *self.texts, *self.factors, *self.measures]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            msg = f"The columns {', '.join(twice)} would be there twice; every table has {', '.join(RESERVED)} itself."
            raise StoreError(msg)

    def schema(self) -> "pa.Schema":
        """The Arrow schema of the table."""
        import pyarrow as pa

        def number(name: str, unit: str) -> "pa.Field":
            return pa.field(name, pa.float64(), nullable=False, metadata={"unit": unit})

        def text(name: str) -> "pa.Field":
            return pa.field(name, pa.string(), nullable=False)

        fields = [pa.field(NUMBER, pa.int64(), nullable=False), text(KEY), *map(text, self.texts)]
        fields += [number(name, unit) for name, unit in self.factors.items()]
        fields += [number(name, unit) for name, unit in self.measures.items()]
        return pa.schema([*fields, text(MESSAGE)], metadata={MARK: FORMAT})

    def table(self, keys: np.ndarray, factors: Mapping[str, np.ndarray], outcomes: Outcomes) -> "pa.Table":
        """The table of some runs.

        Parameters
        ----------
        keys
            Keys of the runs, shape (n,).
        factors
            Values of each factor, shape (n,).
        outcomes
            Numbers, measures and messages of the runs, in the same order.

        Raises
        ------
        StoreError
            If columns or numbers of rows do not fit together.
        """
        import pyarrow as pa

        self._require_fit(keys, factors, outcomes)
        measured = np.asarray(outcomes.measured, np.float64)
        columns = [_array(outcomes.numbers, np.int64), _texts(keys.tolist())]
        columns += [_texts([_encoded(value) for value in factors[name]]) for name in self.texts]
        columns += [_array(factors[name], np.float64) for name in self.factors]
        columns += [_array(measured[:, i], np.float64) for i in range(len(self.measures))]
        columns.append(_texts([_encoded(message) for message in outcomes.messages]))
        return pa.table(columns, schema=self.schema())

    def _require_fit(self, keys: np.ndarray, factors: Mapping[str, np.ndarray], outcomes: Outcomes) -> None:
        """Refuse rows that are not those of the table."""
        missing = [name for name in (*self.texts, *self.factors) if name not in factors]
        if missing:
            msg = f"The factors {', '.join(missing)} are missing; give the values of each factor."
            raise StoreError(msg)
        n = len(keys)
        if np.shape(outcomes.measured) != (n, len(self.measures)):
            msg = f"Measures of shape {np.shape(outcomes.measured)} were given; ({n}, {len(self.measures)}) is needed."
            raise StoreError(msg)
        lengths = {"numbers": len(outcomes.numbers), "messages": len(outcomes.messages)}
        lengths |= {name: len(values) for name, values in factors.items()}
        for what, length in lengths.items():
            if length != n:
                msg = f"{what}: {length} values were given for {n} runs; give one for each."
                raise StoreError(msg)


@dataclass(frozen=True, eq=False)
class Found:
    """Runs that a store already has.

    Attributes
    ----------
    present
        Whether the store has the run, bool, shape (n,).
    own
        Whether the rows of the study itself have it, bool, shape (n,).
    measured
        Measures, float64, shape (n, n_measures); NaN where the run failed or is not there.
    messages
        Why the run failed; empty where it succeeded or is not there; objects, shape (n,).
    """

    present: np.ndarray
    own: np.ndarray
    measured: np.ndarray
    messages: np.ndarray


class Search:
    """Search for runs by their keys in one table after the other.

    A run that succeeded is preferred to the same run that failed, which happens where a process crashed.
    """

    def __init__(self, keys: np.ndarray, measures: Sequence[str]) -> None:
        n = len(keys)
        self.measures = tuple(measures)
        self._order = np.argsort(keys, kind="stable")
        self._sorted = keys[self._order]
        self.found = Found(
            np.zeros(n, bool), np.zeros(n, bool), np.full((n, len(self.measures)), np.nan), np.full(n, "", object)
        )

    @property
    def columns(self) -> list[str]:
        """Columns that a table must have."""
        return [KEY, *self.measures, MESSAGE]

    def look_in(self, table: "pa.Table", *, own: bool) -> None:
        """Take the runs of a table; `own` tells whether the table is one of the study itself."""
        keys = keys_of(table)
        first, behind = (np.searchsorted(self._sorted, keys, side) for side in ("left", "right"))
        counts = behind - first
        rows = np.repeat(np.arange(len(keys)), counts)
        steps = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
        runs = self._order[np.repeat(first, counts) + steps]  # a study may have one run at several numbers
        messages = np.array(table[MESSAGE].to_pylist(), object)
        failed_first = np.argsort(messages[rows] == "", kind="stable")  # of several rows of a run the last one counts
        runs, rows = runs[failed_first], rows[failed_first]
        better = ~self.found.present[runs] | ((self.found.messages[runs] != "") & (messages[rows] == ""))
        self.found.own[runs] |= own
        runs, rows = runs[better], rows[better]
        self.found.present[runs] = True
        self.found.messages[runs] = messages[rows]
        for i, name in enumerate(self.measures):
            self.found.measured[runs, i] = table[name].to_numpy()[rows]


def keys_of(table: "pa.Table") -> np.ndarray:
    """Keys of the runs in a table, bytes, shape (n,)."""
    return np.array(table[KEY].to_pylist(), f"S{KEY_LENGTH}")


def without_duplicates(tables: "Sequence[pa.Table]") -> "pa.Table":
    """The rows of tables in the order of their numbers, each run once; one that succeeded is preferred."""
    import pyarrow as pa

    table = pa.concat_tables(tables)
    number, failed = table[NUMBER].to_numpy(), np.array(table[MESSAGE].to_pylist(), object) != ""
    order = np.lexsort((keys_of(table), failed, number))
    kept = order[np.flatnonzero(np.diff(number[order], prepend=number[order][:1] - 1))]
    return table.take(kept).combine_chunks()


def _array(values: np.ndarray, kind: type[np.number]) -> "pa.Array":
    """Arrow array on the memory of numbers; ``pyarrow.array`` would import pandas, while workers wait for a second."""
    import pyarrow as pa

    memory = np.ascontiguousarray(values, kind)
    return pa.Array.from_buffers(pa.from_numpy_dtype(memory.dtype), len(memory), [None, pa.py_buffer(memory)])


def _texts(encoded: Sequence[bytes]) -> "pa.Array":
    """Arrow array of texts in UTF-8."""
    import pyarrow as pa

    ends = np.cumsum([0, *map(len, encoded)]).astype(np.int32)
    buffers = [None, pa.py_buffer(ends), pa.py_buffer(b"".join(encoded))]
    return pa.Array.from_buffers(pa.string(), len(encoded), buffers)


def _encoded(text: object) -> bytes:
    """A text in UTF-8; half of a character that UTF-8 lacks becomes a question mark."""
    return str(text).encode(errors="replace")
