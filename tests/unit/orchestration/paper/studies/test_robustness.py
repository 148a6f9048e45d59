"""The table of the robustness study and its page: resumed, refused if foreign, the same rows wherever they are made."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from orchestration.paper.share import Share
from orchestration.paper.studies.open_values import settings
from orchestration.paper.studies.robustness import PAGE, TABLE, laboratory, text
from orchestration.paper.studies.robustness_page import word
from orchestration.paper.studies.robustness_table import (
    COLUMNS,
    TableError,
    answer_at,
    make_table,
    read_table,
    write_table,
)

DOCS = Path(__file__).parents[5] / "docs"


def test_kept_rows_are_made_again() -> None:
    """The quickest and the slowest rows of the first settings, to the last answer."""
    kept = read_table(DOCS / TABLE)
    points = settings(len(kept))
    lab = laboratory()
    numbers = [*np.flatnonzero(points["sample_time"] == 1e-4)[:6], *np.flatnonzero(points["sample_time"] == 1e-5)[:1]]
    for number in map(int, numbers):
        np.testing.assert_array_equal(answer_at(lab, points, number), kept[number], err_msg=f"setting {number}")


def test_page_shows_the_kept_table() -> None:
    assert (DOCS / PAGE).read_text(encoding="utf-8") == text(DOCS)


def test_an_interrupted_table_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = "orchestration.paper.studies.robustness_table"
    made: list[int] = []

    def fake(_lab: object, _points: object, number: int) -> np.ndarray:
        made.append(number)
        if number == 40 and len(made) < 50:
            raise KeyboardInterrupt
        return np.full(len(COLUMNS), number % 2)

    monkeypatch.setattr(f"{module}.answer_at", fake)
    path, told = tmp_path / "table.csv", list[str]()
    with pytest.raises(KeyboardInterrupt):
        make_table(path, 64, laboratory(), 1, told.append)
    assert len(read_table(path)) == 32
    del made[:]
    made += [-1] * 50
    answers = make_table(path, 64, laboratory(), 2, told.append)
    assert sorted(made[50:]) == list(range(32, 64))
    np.testing.assert_array_equal(answers[:, 0], np.arange(64) % 2)
    assert told == ["32 of 64 settings", "64 of 64 settings"]
    assert len(make_table(path, 10, laboratory(), 1, told.append)) == 10, "a longer table serves a shorter study"


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (lambda s: s.replace("C13", "C99"), "not a table of this study: its first line"),
        (lambda s: s.replace("\n1,", "\n7,"), "row 1 is '7,"),
        (lambda s: s.replace("\n2,1", "\n2,5"), "row 2 is '2,5"),
        (lambda s: s.rstrip("\n")[:-2], "row 2 is"),
        (lambda _: "", "its first line is"),
    ],
)
def test_a_file_of_another_kind_is_refused(tmp_path: Path, change: Callable[[str], str], match: str) -> None:
    path = tmp_path / "table.csv"
    write_table(path, np.ones((3, len(COLUMNS)), dtype=int))
    np.testing.assert_array_equal(read_table(path), 1)
    path.write_text(change(path.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(TableError, match=match):
        read_table(path)


@pytest.mark.parametrize(
    ("holds", "yes", "expected"),
    [
        (True, 500, "holds"),
        (True, 0, "holds at the chosen values only"),
        (False, 500, "fails at the chosen values, holds elsewhere"),
        (False, 0, "holds nowhere in the space searched"),
    ],
)
def test_words_of_a_claim(holds: bool, yes: int, expected: str) -> None:
    assert word(holds, Share(yes, 1000)) == expected
