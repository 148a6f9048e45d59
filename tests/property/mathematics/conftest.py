"""Fixture: the runtime's mathematics as a library."""

import pytest

from tests.property.mathematics.library import Mathematics


@pytest.fixture(scope="session")
def mathematics(tmp_path_factory: pytest.TempPathFactory) -> Mathematics:
    """The functions of ``mathematics.h``."""
    return Mathematics(tmp_path_factory.mktemp("mathematics"))
