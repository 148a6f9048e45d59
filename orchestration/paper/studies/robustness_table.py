"""The table of the robustness study: a row for each setting, with the answer to each question as 0 or 1.

The table is a CSV file. A question that was not asked at a setting has an empty field.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.errors import OrchestrationError
from orchestration.paper.studies.claims_at import COSTLY as COSTLY_QUESTIONS
from orchestration.paper.studies.claims_at import QUESTIONS, RUNS, Evidence, verdicts
from orchestration.paper.studies.raw_rows import Row
from orchestration.paper.studies.survey import COSTLY

COLUMNS = (*QUESTIONS, *(f"{name} failed" for name in RUNS))
NOT_ASKED = -1
_FIELDS = {"0": 0, "1": 1, "": NOT_ASKED}
_TEXTS = {value: text for text, value in _FIELDS.items()}


class TableError(OrchestrationError):
    """The file of a table is not one of this study."""


def answers_of(rows: Sequence[Row]) -> np.ndarray:
    """Answer the questions at each setting.

    Returns
    -------
    ndarray
        0, 1 or `NOT_ASKED`, shape (n, n_columns); the columns are `COLUMNS`.
    """
    return np.array([answer(row, costly=number < COSTLY) for number, row in enumerate(rows)]).reshape(-1, len(COLUMNS))


def answer(row: Row, *, costly: bool) -> list[int]:
    """The answers at one setting; those that need costly runs if these were made."""
    found = Evidence([row])
    answered = verdicts(found, costly=costly)
    failed = {f"{name} failed": name not in found.noise for name in RUNS}
    given = {**dict.fromkeys(COSTLY_QUESTIONS, NOT_ASKED), **answered, **failed}
    return [int(given[name]) for name in COLUMNS]


def write_table(path: Path, answers: np.ndarray) -> None:
    """Write a table; the file is whole or as it was."""
    lines = (",".join([str(number), *(_TEXTS[int(value)] for value in row)]) for number, row in enumerate(answers))
    write_whole(path, "\n".join([",".join(("number", *COLUMNS)), *lines, ""]).encode())


def read_table(path: Path) -> np.ndarray:
    """Read the answers of a table, shape (n, n_columns).

    Raises
    ------
    TableError
        If the file is not a table of this study.
    """
    lines = path.read_text(encoding="utf-8").splitlines()
    if not lines or tuple(lines[0].split(",")) != ("number", *COLUMNS):
        msg = f"{path} is not a table of this study: its first line is {lines[:1]}; name another file."
        raise TableError(msg)
    return np.array([row for row in _rows(path, lines[1:])], dtype=int).reshape(-1, len(COLUMNS))


def _rows(path: Path, lines: list[str]) -> Iterator[list[int]]:
    for number, line in enumerate(lines):
        fields = line.split(",")
        if len(fields) != len(COLUMNS) + 1 or fields[0] != str(number) or not {*fields[1:]} <= {*_FIELDS}:
            msg = f"{path}: row {number} is {line!r}; a row has its number and {len(COLUMNS)} times 0, 1 or nothing."
            raise TableError(msg)
        yield [_FIELDS[field] for field in fields[1:]]
