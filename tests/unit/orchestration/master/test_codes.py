"""The numbers of the compiled loops: a name means one number, and a number of a table has one name."""

from collections import Counter
from enum import IntEnum

import numpy as np

from orchestration.master.kernel import codes

CLASSES = [found for found in vars(codes).values() if isinstance(found, type)]
ENUMERATIONS = [found for found in CLASSES if issubclass(found, IntEnum) and found is not IntEnum]
RECORDS = [found for found in vars(codes).values() if isinstance(found, np.dtype)]


def test_a_name_is_in_one_enumeration_only() -> None:
    assert len(ENUMERATIONS) > 5
    names = Counter(name for enumeration in ENUMERATIONS for name in enumeration.__members__)
    assert [name for name, count in names.items() if count > 1] == []


def test_a_number_has_one_name_in_an_enumeration() -> None:
    for enumeration in ENUMERATIONS:
        assert len(enumeration.__members__) == len({int(member) for member in enumeration}), enumeration


def test_groups_of_columns_do_not_overlap() -> None:
    calls = [column for column in codes.Column if column.name.startswith(("SET_", "GET_"))]
    groups = [column for column in calls if column.name.endswith(("REAL", "INTEGER", "BOOLEAN"))]
    taken = Counter(int(column) + i for column in groups for i in range(codes.GROUP_SIZE))
    taken.update(int(codes.Column.SET_RATES) + i for i in range(len(codes.Group)))
    taken.update(int(column) for column in codes.Column if column not in (*groups, codes.Column.SET_RATES))
    assert set(taken.values()) == {1}
    assert max(taken) < codes.N_COLUMNS


def test_records_are_packed_in_words() -> None:
    """Addresses of fields are computed as multiples of eight bytes."""
    for record in RECORDS:
        assert record.itemsize == 8 * len(record.names or ())
