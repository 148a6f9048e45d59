"""Looks for a setting at which C4 to C10 hold together: from the best of the table, its neighbours, over all seeds."""

import json
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import numpy as np

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.paper.calibrations import FIRST, Setting
from orchestration.paper.laboratory import SEEDS, Runner
from orchestration.paper.studies.claims_at import evidence_at, verdicts
from orchestration.paper.studies.open_values import CHOSEN, EARLIER, setting_at, settings, settings_near
from orchestration.paper.studies.robustness_table import COLUMNS

SECTION_V = ("C4", "C5", "C6", "C7", "C8", "C9", "C10")
STARTS, NEIGHBOURS, CANDIDATES = 5, 32, 6
BY_OTHERS, AT_FIRST = "found by independent code", "the calibration `first`"
CHOSEN_ORIGIN = "the chosen values"
WIDTH = 0.2  # of the box around a setting, as a share of each range
Tell = Callable[[str], None]
Score = tuple[int, int]


@dataclass(frozen=True)
class Judged:
    """A setting and its verdicts over the seeds `SEEDS`.

    Attributes
    ----------
    origin
        Where the setting comes from.
    """

    origin: str
    setting: Mapping[str, float]
    verdicts: Mapping[str, bool]

    @property
    def held(self) -> int:
        """How many of C4 to C10 hold."""
        return sum(self.verdicts[claim] for claim in SECTION_V)


@dataclass(frozen=True)
class Search:
    """What the search has found.

    Attributes
    ----------
    chosen
        The setting of the scenarios.
    best
        The settings that were judged over the seeds, the best first, the chosen one included.
    looked_at
        Number of settings of the table that the search began with.
    tried
        Number of settings near those of the table, each with one seed.
    all_hold
        Number of settings, of the table and near it, at which C4 to C10 hold with one seed.
    """

    chosen: Judged
    best: tuple[Judged, ...]
    looked_at: int
    tried: int
    all_hold: int


def search(answers: np.ndarray, laboratory: Runner, pool: Executor, tell: Tell) -> Search:
    """Look for settings at which C4 to C10 hold.

    1. Take the `STARTS` settings of the table at which most of the seven claims hold.
    2. Judge `NEIGHBOURS` settings in a box around each, with one seed.
    3. Judge the `CANDIDATES` best of all these over the seeds `SEEDS`. The chosen values, the calibration `FIRST` and
       the setting `EARLIER` are judged as well.

    Of settings at which equally many claims hold, those are better at which errors of C7 and C10 are clearly larger.

    Parameters
    ----------
    answers
        The table, shape (n, n_columns).
    tell
        Called with a sentence after each step.
    """
    scores = [_score(dict(zip(COLUMNS, (row == 1).tolist(), strict=True))) for row in answers]
    points = settings(len(answers))
    starts = sorted(range(len(answers)), key=lambda number: scores[number], reverse=True)[:STARTS]
    known = [(scores[i], f"setting {i}", setting_at(points, i)) for i in starts]
    near = list(_neighbours(known))
    near_scores = list(pool.map(partial(_scored, laboratory), [setting for _, setting in near]))
    found = known + [(score, origin, setting) for score, (origin, setting) in zip(near_scores, near, strict=True)]
    every = sum(held == len(SECTION_V) for held, _ in (*scores, *near_scores))
    tell(f"{len(near)} neighbours; C4 to C10 hold at {every} settings, with one seed")
    found.sort(key=lambda row: row[0], reverse=True)
    candidates = [(origin, setting) for _, origin, setting in found[:CANDIDATES]]
    jobs = [(CHOSEN_ORIGIN, CHOSEN), (BY_OTHERS, EARLIER), (AT_FIRST, FIRST.values), *candidates]
    chosen, *rest = pool.map(partial(_judged, laboratory), jobs)
    best = tuple(sorted((chosen, *rest), key=lambda judged: -judged.held))
    tell(f"{len(best)} candidates over {len(SEEDS)} seeds: at most {best[0].held} of C4 to C10 hold")
    return Search(chosen, best, len(answers), len(near), every)


def write_search(path: Path, found: Search) -> None:
    """Write what a search has found as JSON."""
    write_whole(path, f"{json.dumps(asdict(found), indent=1)}\n".encode())


def read_search(path: Path) -> Search:
    """Read what a search has found."""
    record = json.loads(path.read_text(encoding="utf-8"))
    best = tuple(Judged(**entry) for entry in record["best"])
    return Search(**{**record, "chosen": Judged(**record["chosen"]), "best": best})


def _neighbours(known: list[tuple[Score, str, Setting]]) -> Iterator[tuple[str, Setting]]:
    for _, origin, setting in known:
        box = settings_near(setting, NEIGHBOURS, WIDTH)
        for number in range(NEIGHBOURS):
            yield f"near {origin}", setting_at(box, number)


def _scored(laboratory: Runner, setting: Setting) -> Score:
    return _score(verdicts(evidence_at(laboratory, setting, SEEDS[:1])))


def _score(found: Mapping[str, bool]) -> Score:
    """How many of C4 to C10 hold, and of how many the errors are clearly larger."""
    return sum(found[claim] for claim in SECTION_V), sum(found[f"{claim} clearly"] for claim in ("C7", "C10"))


def _judged(laboratory: Runner, job: tuple[str, Setting]) -> Judged:
    origin, setting = job
    return Judged(origin, dict(setting), verdicts(evidence_at(laboratory, setting, SEEDS)))
