"""The hash of the rows of a run, by which programs on different machines are compared.

It is that of docs/same-bits.md, of the program that `adaptimp export --as c` writes, and of the live page: SHA-256 of
all values, row by row, as little-endian float64, in the order of the columns and without the time.
"""

import hashlib

import numpy as np

from orchestration.results.columns import Columns

_PART = 2**16  # rows that are turned into bytes at once


def row_hash(columns: Columns) -> str:
    """Hash all rows of a result.

    Returns
    -------
    str
        SHA-256 as 64 hexadecimal digits. Texts take no part.

    Examples
    --------
    >>> from orchestration import scenario, simulate
    >>> from orchestration.results.row_hash import row_hash
    >>> row_hash(simulate(scenario("fig2")))
    'b30092b7945607e3b063c4af2673b878992d8e761b0df69e4b610b99e2938385'
    """
    found = hashlib.sha256()
    for first in range(0, len(columns.rows), _PART):
        found.update(np.ascontiguousarray(columns.rows[first : first + _PART], dtype="<f8").tobytes())
    return found.hexdigest()
