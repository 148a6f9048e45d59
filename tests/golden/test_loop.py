"""docs/images/loop.svg is the drawing that the FMUs hold."""

from tests.golden.loop import PICTURE, draw


def test_picture_of_the_loop_is_up_to_date() -> None:
    assert PICTURE.read_text(encoding="utf-8") == draw() + "\n", "run: python -m tests.golden.loop --write"
