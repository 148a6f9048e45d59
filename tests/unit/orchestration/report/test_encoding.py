"""Evidence that packed columns come back within the rounding that is told; unpacked here as the page unpacks them."""

import base64
import gzip

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from orchestration.report.encoding import NO_NUMBERS, SIZES, Packed, extremes, pack, packed_bytes

COLUMNS = arrays(
    float, st.integers(0, 40), elements=st.floats(-1e300, 1e300) | st.sampled_from([np.nan, np.inf, -np.inf])
)


def unpack(packed: Packed) -> np.ndarray:
    """The numbers of a column, by the words of `orchestration.report.encoding`."""
    size, planes = 256**packed.bytes, gzip.decompress(base64.b64decode(packed.data))
    values, code = [], 0
    for i in range(packed.count):
        folded = sum(planes[plane * packed.count + i] << (8 * plane) for plane in range(packed.bytes))
        code = (code + (-(folded + 1) // 2 if folded % 2 else folded // 2)) % size
        beyond = code - (size - NO_NUMBERS)
        values.append(packed.low + packed.step * code if beyond < 0 else (np.nan, np.inf, -np.inf)[beyond])
    return np.array(values)


@settings(max_examples=60, deadline=None)
@given(COLUMNS, st.sampled_from(SIZES))
def test_a_column_comes_back_within_its_rounding(values: np.ndarray, size: int) -> None:
    packed = pack(values, size)
    found, finite = unpack(packed), np.isfinite(values)
    assert packed.bytes == size
    assert np.array_equal(found[~finite], values[~finite], equal_nan=True)
    # low + step * code is rounded three times, each relative to the largest value.
    rounded = 4 * np.finfo(float).eps * np.abs(values[finite]).max(initial=0.0)
    assert (np.abs(found[finite] - values[finite]) <= packed.rounding * (1 + 1e-9) + rounded).all()


@pytest.mark.parametrize("size", SIZES)
def test_zero_stays_zero_in_a_column_with_both_signs(size: int) -> None:
    values = np.array([-3.7, 0.0, 1e-9, 691.2, 0.0])
    found = unpack(pack(values, size))
    assert found[1] == found[4] == 0.0


def test_a_constant_and_an_empty_column_are_exact() -> None:
    assert unpack(pack(np.full(3, 0.1), 2)).tolist() == [0.1] * 3
    assert unpack(pack(np.zeros(0), 2)).tolist() == []
    assert np.isnan(unpack(pack(np.full(2, np.nan), 2))).all()


def test_the_same_bytes_give_the_same_text() -> None:
    assert packed_bytes(b"abc") == packed_bytes(b"abc")


def test_extremes_are_those_of_each_bin_in_their_order() -> None:
    values = np.array([1.0, 5.0, 3.0, 2.0, 9.0, 0.0, np.nan])
    assert extremes(values, 4).tolist() == [1.0, 5.0, 9.0, 0.0]
    assert extremes(values, 3).tolist()[:4] == [1.0, 5.0, 9.0, 0.0]
    assert np.isnan(extremes(values, 3)[4:]).all()
