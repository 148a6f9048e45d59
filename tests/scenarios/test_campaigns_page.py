"""docs/campaigns.md, followed literally: its commands print what the page shows, and its pictures are there.

The Python blocks of the page are run by `tests.scenarios.test_documents`.
"""

import json
from pathlib import Path

import pandas as pd
import pytest

from tests.scenarios.tutorial import Printed, blocks, follow

PAGE = Path(__file__).parents[2] / "docs" / "campaigns.md"


@pytest.fixture(scope="module")
def followed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Printed]]:
    """The reader's folder when all is done, and what was printed."""
    folder = tmp_path_factory.mktemp("reader")
    return folder, follow(PAGE, folder)


def test_commands_print_what_the_page_shows(followed: tuple[Path, list[Printed]]) -> None:
    printed = followed[1]
    assert len(printed) >= 3
    for one in printed:
        assert one.agree, f"{PAGE.name}, line {one.line}, shows\n{one.shown}\nand the commands print\n{one.real}"


def test_nothing_on_the_page_is_left_out() -> None:
    """Each fence is typed, compared, run as a cell or written to a named file."""
    text, found = PAGE.read_text(encoding="utf-8"), blocks(PAGE)
    assert text.count("```") == 2 * len(found)
    assert {block.kind for block in found} <= {"sh", "text", "python", "toml"}
    assert all(block.file for block in found if block.kind == "toml")


def test_the_table_and_the_pictures_are_there(followed: tuple[Path, list[Printed]]) -> None:
    folder, _ = followed
    table = pd.read_csv(folder / "gains.csv")
    assert len(table) == 72
    assert set(table["status"]) == {"complete"}
    page = (folder / "pictures" / "index.html").read_text(encoding="utf-8")
    assert "adaptimp sweep fig7 --vary controller.K_d=50:400:8" in page
    assert [picture.suffix for picture in folder.glob("pictures/*.png")] == [".png"] * 2


def test_the_object_that_the_page_describes_is_printed(followed: tuple[Path, list[Printed]]) -> None:
    found = json.loads((followed[0] / "gains.json").read_text(encoding="utf-8"))
    assert (found["runs"], found["from_store"], found["status"]) == (72, 72, "complete")
