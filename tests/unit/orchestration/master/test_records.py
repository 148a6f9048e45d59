"""Evidence that a type checker sees the very fields that the records of the kernel have."""

import numpy as np
import pytest

from orchestration.master.kernel import codes, records

TYPES = {int: np.dtype(np.int64), float: np.dtype(np.float64)}


@pytest.mark.parametrize(
    ("annotated", "record"),
    [
        (records.Operation, codes.OPERATION),
        (records.Link, codes.LINK),
        (records.Watched, codes.WATCHED),
        (records.Method, codes.METHOD),
        (records.State, codes.STATE),
    ],
)
def test_the_annotated_fields_are_those_of_the_record(annotated: type, record: np.dtype) -> None:
    fields = {name: TYPES[kind] for name, kind in annotated.__annotations__.items()}
    assert list(fields.items()) == [(name, record[name]) for name in record.names or ()]
