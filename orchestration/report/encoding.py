"""Packs columns of numbers for a page: rounded to steps of their range, and in bins where there are too many rows.

A number becomes a code of 2, 3 or 6 bytes: code = round((value - low) / step). The codes are written as differences
from one to the next, folded to numbers without a sign, byte by byte, and packed by gzip. The last three codes stand for
NaN, +infinity and -infinity. ``orchestration/report/script/data.js`` reads this.
"""

import base64
import gzip
import math
from dataclasses import dataclass

import numpy as np

NO_NUMBERS = 3
SIZES = (6, 3, 2)
"""Bytes of a code, the finest first."""


@dataclass(frozen=True)
class Packed:
    """A column as a page holds it.

    Attributes
    ----------
    bytes
        Of a code.
    low, step
        Value of code 0, and of the difference between codes, in the unit of the column.
    count
        Number of values.
    data
        The packed codes, in base64.
    """

    bytes: int
    low: float
    step: float
    count: int
    data: str

    @property
    def span(self) -> float:
        """The largest value minus the least, in the unit of the column."""
        return self.step * (256**self.bytes - 1 - NO_NUMBERS)

    @property
    def rounding(self) -> float:
        """Largest difference between a value and what is stored, in the unit of the column."""
        return self.step / 2


def packed_bytes(content: bytes) -> str:
    """Bytes packed by gzip, in base64; the same bytes give the same text."""
    return base64.b64encode(gzip.compress(content, compresslevel=9, mtime=0)).decode("ascii")


def pack(values: np.ndarray, size: int) -> Packed:
    """Pack a column.

    Parameters
    ----------
    values
        Shape (n,).
    size
        Bytes of a code, one of `SIZES`.
    """
    values = np.asarray(values, dtype=float)
    finite = np.isfinite(values)
    low, high = (float(values[finite].min()), float(values[finite].max())) if finite.any() else (0.0, 0.0)
    largest = 256**size - 1 - NO_NUMBERS
    step = (high / (largest - 1) - low / (largest - 1)) if high > low else 0.0
    step = max(step, float(np.finfo(float).tiny)) if step else 0.0  # smaller numbers have fewer digits
    low = step * math.floor(low / step) if step and low <= 0 <= high else low  # zero stays zero
    codes = np.full(values.shape, largest + 1, dtype=np.int64)  # NaN
    codes[values == np.inf] = largest + 2
    codes[values == -np.inf] = largest + 3
    codes[finite] = np.rint((values[finite] - low) / step).astype(np.int64).clip(0, largest) if step else 0
    return Packed(size, low, step, len(values), packed_bytes(_planes(codes, size)))


def _planes(codes: np.ndarray, size: int) -> bytes:
    """Differences of codes as bytes: first the lowest of all, then the next."""
    half = 256**size // 2
    changes = (np.diff(codes, prepend=0) + half) % (2 * half) - half
    folded = np.where(changes < 0, -2 * changes - 1, 2 * changes).astype("<u8")
    return folded.view(np.uint8).reshape(-1, 8).T[:size].tobytes()


def extremes(values: np.ndarray, rows: int) -> np.ndarray:
    """The least and the largest value of each bin of so many rows, in the order in which they occur.

    Returns
    -------
    ndarray
        Shape (2 n_bins,); the last bin may hold fewer rows. NaN is left out unless a bin holds nothing else.
    """
    missing = -len(values) % rows
    bins = np.concatenate([values, np.full(missing, np.nan)]).reshape(-1, rows)
    least = np.where(np.isnan(bins), np.inf, bins).argmin(axis=1)
    most = np.where(np.isnan(bins), -np.inf, bins).argmax(axis=1)
    ends = np.sort(np.stack([least, most], axis=1), axis=1)
    return np.take_along_axis(bins, ends, axis=1).ravel()
