"""The table of the robustness study and its page: the same rows wherever they are made, refused if foreign."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from orchestration.paper.strength import read_strength
from orchestration.paper.studies.claims_at import COSTLY as COSTLY_QUESTIONS
from orchestration.paper.studies.open_values import ADAPTIVE, OPEN_VALUES, settings
from orchestration.paper.studies.raw_rows import Row
from orchestration.paper.studies.robustness import PAGE, SEEDS, TABLE, laboratory, text
from orchestration.paper.studies.robustness_table import (
    COLUMNS,
    NOT_ASKED,
    TableError,
    answer,
    answers_of,
    read_table,
    write_table,
)
from orchestration.paper.studies.runs_at import row_at
from orchestration.paper.studies.seeds import read_seeds
from orchestration.paper.studies.strength_of import strength_of
from orchestration.paper.studies.survey import COSTLY, first_settings

DOCS = Path(__file__).parents[5] / "docs"


def test_kept_rows_are_made_again() -> None:
    """Quick rows among the later settings, in all that does not need the switching of algorithm 1."""
    kept = read_table(DOCS / TABLE)
    quick = np.flatnonzero(settings(len(kept))["sample_time"] == 1e-4)
    lab, found = laboratory(), first_settings(len(kept))
    numbers = quick[quick >= COSTLY][:5].tolist()
    again = np.array([answer(row_at(lab, found[number], number + 1), costly=False) for number in numbers])
    same = [COLUMNS.index(name) for name in ("C1", "C2", "C3a", "C3b", "C9", "C13", "fig7 failed")]
    np.testing.assert_array_equal(again[:, same], kept[numbers][:, same])


def test_page_and_strength_are_those_of_the_kept_table() -> None:
    assert (DOCS / PAGE).read_text(encoding="utf-8") == text(DOCS)
    assert read_strength() == strength_of(read_table(DOCS / TABLE), read_seeds(DOCS / SEEDS))


def test_costly_questions_are_asked_at_the_first_settings_only() -> None:
    answers = answers_of([Row({}, {})] * (COSTLY + 2))
    costly = [COLUMNS.index(name) for name in COSTLY_QUESTIONS]
    assert (answers[COSTLY:, costly] == NOT_ASKED).all()
    assert (answers[:COSTLY] != NOT_ASKED).all()
    failed = [i for i, name in enumerate(COLUMNS) if name.endswith(" failed")]
    assert (answers[:, failed] == 1).all(), "nothing was measured"


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
    answers = np.ones((3, len(COLUMNS)), dtype=int)
    answers[1, 3] = NOT_ASKED
    write_table(path, answers)
    np.testing.assert_array_equal(read_table(path), answers)
    path.write_text(change(path.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(TableError, match=match):
        read_table(path)


def test_values_decide_only_claims_that_they_are_said_to_take_part_in() -> None:
    """What the table of open values says of each value agrees with what decides at the settings of the study."""
    values = {value.name: value for value in OPEN_VALUES}
    for claim, found in strength_of(read_table(DOCS / TABLE), {}).claims.items():
        number = re.match(r"C(\d+)", claim)
        if number is None:
            continue
        for name, index in found.deciding:
            assert int(number[1]) in claims_in(values[name].claims), f"{name} decides {claim} by {index:.0%}"


def test_values_are_said_to_take_part_in_the_claims_whose_runs_have_them() -> None:
    said = {value.name: claims_in(value.claims) for value in OPEN_VALUES}
    assert not said["sample_time"] & {1, 2, 3}, "Figs. 2 to 4 have a sampling period of their own"
    assert {12, 13} <= said["Psi_1"] & said["noise_hold"], "they are asked of Fig. 5"


def claims_in(said: str) -> set[int]:
    """Numbers of the claims that a text such as "C4 to C8, C10" names."""
    if said in ("all", ADAPTIVE):
        return set(range(1 if said == "all" else 4, 21))
    ends = [[int(end) for end in re.findall(r"C(\d+)", part)] for part in said.split(", ")]
    return {number for pair in ends for number in range(pair[0], pair[-1] + 1)}
