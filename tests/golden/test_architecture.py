"""The picture in docs/architecture.md shows the rooms and contracts as they are."""

from tests.golden.architecture import PICTURE, ROOT, draw, floors


def test_picture_is_up_to_date() -> None:
    assert PICTURE.read_bytes() == draw(), "run: python -m tests.golden.architecture --write"


def test_every_folder_is_in_the_picture() -> None:
    drawn = {room.name.strip("/") for floor in floors("orchestration") for room in floor}
    there = {path.parent.name for path in (ROOT / "orchestration").glob("*/__init__.py")}
    assert there <= drawn
