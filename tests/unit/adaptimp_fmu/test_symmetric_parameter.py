"""Tests of the declaration of a symmetric matrix: its elements, what it checks, and what it refuses."""

import math
from typing import Any

import casadi as ca
import numpy as np
import pytest

from adaptimp_fmu import NOT_NEGATIVE, DefinitionError, Role
from tests.unit.adaptimp_fmu.test_model import sampled


def test_a_symmetric_parameter_is_a_whole_array_and_must_be_symmetric() -> None:
    model = sampled()
    entries = [f"entry {i}" for i in range(4)]
    A = model.symmetric_parameter("A", [1.0, 2.0], limits=NOT_NEGATIVE, tunable=True, description=entries)
    declared = model.with_role(Role.TUNABLE_PARAMETER)
    assert [v.name for v in declared] == ["A[1,1]", "A[1,2]", "A[2,1]", "A[2,2]"]
    assert [(v.start, v.minimum) for v in declared] == [(1, 0), (0, -math.inf), (0, -math.inf), (2, 0)]
    values = ca.Function("values", [model.parameter_symbols[-1]], [A, model.static_checks[-1].value])
    matrix, check = values([11, 12, 12, 22])
    assert np.array(matrix).tolist() == [[11, 12], [12, 22]]
    assert float(check) > 0
    assert float(values([11, 12, 12.5, 22])[1]) < 0
    assert float(values([11, 12, 12 * (1 + 1e-15), 22])[1]) > 0  # rounding of a matrix that somebody has turned
    assert float(values([11, 1e-16, -1e-16, 22])[1]) > 0


@pytest.mark.parametrize(
    ("diagonal", "more", "message"),
    [
        ([-1.0, 1.0], {}, r"A\[1,1\]: start -1.0 must be at least 0"),
        ("ab", {}, "start 'ab' is not a number"),
        ([1.0, 1.0], {"unit": ["N", "m"]}, "4 elements but 2 units"),
    ],
)
def test_a_symmetric_parameter_that_cannot_be_declared_is_refused(diagonal: Any, more: Any, message: str) -> None:
    with pytest.raises(DefinitionError, match=message):
        sampled().symmetric_parameter("A", diagonal, limits=NOT_NEGATIVE, description="A", **more)
