"""Opens variants of the catalog for the tests of FMUs."""

from collections.abc import Iterator

import pytest

from tests.driver import Driver
from tests.unit.fmus.variants import Open
from tests.variant_files import file_of


@pytest.fixture
def open_variant() -> Iterator[Open]:
    """Opens a variant by its identifier; everything opened is freed after the test."""
    drivers: list[Driver] = []

    def open_one(name: str) -> Driver:
        drivers.append(Driver(file_of(name)))
        return drivers[-1]

    yield open_one
    for driver in drivers:
        driver.close()
