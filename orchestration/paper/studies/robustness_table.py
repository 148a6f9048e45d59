"""Makes the table of the robustness study: a row for each setting, with the answer to each question as 0 or 1.

The table is a CSV file. Rows that the file has already are kept, so an interrupted study goes on where it ended.
"""

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.errors import OrchestrationError
from orchestration.paper.studies.claims_at import QUESTIONS, SCENARIOS, evidence_at, verdicts
from orchestration.paper.studies.native_runs import Runner
from orchestration.paper.studies.open_values import setting_at, settings

COLUMNS = (*QUESTIONS, *(f"{name} failed" for name in SCENARIOS))
CHUNK = 32  # settings after which the file is written
Tell = Callable[[str], None]


class TableError(OrchestrationError):
    """The file of a table is not one of this study."""


def make_table(path: Path, n: int, laboratory: Runner, workers: int, tell: Tell) -> np.ndarray:
    """Answer the questions at the first n settings, and write the table.

    Parameters
    ----------
    path
        The CSV file; its rows are kept if it exists.
    tell
        Called with a sentence after every `CHUNK` settings.

    Returns
    -------
    ndarray
        0 or 1, shape (n, n_columns); the columns are `COLUMNS`.

    Raises
    ------
    TableError
        If the file exists and is not a table of this study.
    """
    answers = read_table(path) if path.exists() else np.zeros((0, len(COLUMNS)), dtype=int)
    points = settings(n)
    answer = partial(answer_at, laboratory, points)
    with ThreadPoolExecutor(workers) as pool:
        for first in range(len(answers), n, CHUNK):
            numbers = range(first, min(first + CHUNK, n))
            answers = np.vstack([answers, *pool.map(answer, numbers)])
            write_table(path, answers)
            tell(f"{len(answers)} of {n} settings")
    return answers[:n]


def answer_at(laboratory: Runner, points: Mapping[str, np.ndarray], number: int) -> np.ndarray:
    """The row of a setting; the seed of its noise is its number plus 1."""
    found = evidence_at(laboratory, setting_at(points, number), [number + 1])
    failed = [name not in found.noise for name in SCENARIOS]
    return np.array([*verdicts(found).values(), *failed], dtype=int)


def write_table(path: Path, answers: np.ndarray) -> None:
    """Write a table; the file is whole or as it was."""
    lines = (",".join(map(str, (number, *row))) for number, row in enumerate(answers))
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
        if len(fields) != len(COLUMNS) + 1 or fields[0] != str(number) or not {*fields[1:]} <= {"0", "1"}:
            msg = f"{path}: row {number} is {line!r}; a row has its number and {len(COLUMNS)} times 0 or 1."
            raise TableError(msg)
        yield [int(field) for field in fields[1:]]
