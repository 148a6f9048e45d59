"""The pictures of docs/conventions.md are what their numbers give."""

import pytest

from tests.golden.convention_pictures import FOLDER, PICTURES


@pytest.mark.parametrize("name", PICTURES)
def test_picture_is_up_to_date(name: str) -> None:
    """Coordinates are written to a hundredth of a pixel, so that the last bits of sines do not show."""
    assert (FOLDER / name).read_text(encoding="utf-8") == PICTURES[name](), (
        f"{name} is out of date: python -m tests.golden.convention_pictures --write"
    )
