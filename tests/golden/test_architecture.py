"""The picture in docs/architecture.md shows the rooms and contracts as they are."""

from tests.golden.architecture import PICTURE, ROOT, draw, floors


def test_picture_is_up_to_date() -> None:
    assert PICTURE.read_bytes() == draw(), "run: python -m tests.golden.architecture --write"


def test_every_folder_is_in_the_picture() -> None:
    drawn = {room.name.strip("/") for floor in floors("orchestration") for room in floor}
    there = {path.parent.name for path in (ROOT / "orchestration").glob("*/__init__.py")}
    assert there <= drawn


def test_every_module_is_in_the_picture() -> None:
    """In rooms within rooms too."""
    drawn = {text for floor in floors("orchestration") for room in floor for text in room.modules}
    words = {word for text in drawn for word in text.split()}
    rooms = {path.parent.name for path in (ROOT / "orchestration").glob("*/__init__.py")}
    files = [path for room in rooms for path in (ROOT / "orchestration" / room).rglob("*.py")]
    assert {path.stem for path in files if not path.stem.startswith("__")} <= words
