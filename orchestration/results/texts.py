"""Columns of texts, which a result has beside its columns of numbers."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from orchestration.fmi.names import arrays

if TYPE_CHECKING:
    import pyarrow as pa

ROW_BYTES = 64
"""Bytes that a text is counted with where the size of a part of a file is chosen."""


def text_column(texts: Mapping[str, np.ndarray], name: str) -> np.ndarray | None:
    """Return a column of texts, shape (n_rows,), or the columns of an array, (n_rows, k); None for another name."""
    if name in texts:
        return texts[name]
    positions = arrays(tuple(texts)).get(name)
    if positions is None:
        return None
    columns = list(texts.values())
    chosen = np.array([columns[i] for i in positions.ravel()], object).T
    return chosen.reshape(len(chosen), *positions.shape)


def same_texts(a: Mapping[str, np.ndarray], b: Mapping[str, np.ndarray]) -> bool:
    """Whether two results have the same columns of texts, in the same order, with the same texts."""
    return list(a) == list(b) and all(a[name].tolist() == b[name].tolist() for name in a)


def joined_texts(parts: Sequence[Mapping[str, np.ndarray]], names: Sequence[str]) -> dict[str, np.ndarray]:
    """Return the columns of the given names, from parts that follow each other."""
    return {name: np.concatenate([np.empty(0, object), *(part[name] for part in parts)]) for name in names}


def text_fields(names: Sequence[str]) -> "list[pa.Field]":
    """Return fields of an Arrow schema for columns of texts."""
    import pyarrow as pa

    return [pa.field(name, pa.string(), nullable=False) for name in names]


def text_array(texts: np.ndarray) -> "pa.Array":
    """Return an Arrow array of texts; one of a half of a character that UTF-8 lacks becomes a question mark."""
    import pyarrow as pa

    return pa.array([text.encode(errors="replace").decode() for text in texts.tolist()], pa.string())


def is_text(kind: "pa.DataType") -> bool:
    """Whether an Arrow type is one of texts."""
    import pyarrow.types as kinds

    return kinds.is_string(kind) or kinds.is_large_string(kind)
