"""A pytest fixture for tests of an FMU: it opens FMUs, and closes them after the test.

pytest_plugins = ["orchestration.fmi.testing"]  # in the test file or the outermost conftest.py

def test_the_arm_stays_where_it_is(fmu):
plant = fmu("Plant.fmu", q_start=[0.3, 1.0], dq_start=[0.0, 0.0])
outputs = plant.drive(1e-3, {"tau": np.zeros((100, 2))})
np.testing.assert_allclose(outputs["q"], np.tile([0.3, 1.0], (100, 1)))
"""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from typing import Any

import pytest

from orchestration.fmi.fmu import Fmu


@pytest.fixture
def fmu() -> Iterator[Callable[..., Fmu]]:
    """Opens FMUs as `orchestration.Fmu` does; they are closed after the test."""
    with ExitStack() as opened:

        def open_one(*arguments: Any, **start: Any) -> Fmu:
            return opened.enter_context(Fmu(*arguments, **start))

        yield open_one
