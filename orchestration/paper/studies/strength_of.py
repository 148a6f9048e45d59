"""Gathers how strongly each claim holds, from the table of verdicts and the verdicts over many seeds."""

from collections.abc import Mapping

import numpy as np

from orchestration.paper.share import Share
from orchestration.paper.strength import ClaimStrength, Strength
from orchestration.paper.studies.claims_at import QUESTIONS
from orchestration.paper.studies.open_values import OPEN_VALUES, settings
from orchestration.paper.studies.pages.claims import LEAST_INDEX, MOST_VALUES, asked
from orchestration.paper.studies.robustness_table import COLUMNS
from orchestration.paper.studies.seeds import OverSeeds
from orchestration.paper.studies.shares import deciding, share
from orchestration.paper.studies.together import SECTION_V

ALL = f"{SECTION_V[0]} to {SECTION_V[-1]}"
"""Key of the claims of Section V together."""


def strength_of(answers: np.ndarray, seeds: Mapping[str, OverSeeds]) -> Strength:
    """How strongly the claims hold.

    Parameters
    ----------
    answers
        The answers at each setting, shape (n, n_columns), as `robustness_table` makes them.
    seeds
        The verdicts over many seeds, by the name of a calibration.
    """
    columns = dict(zip(COLUMNS, answers.T, strict=True))
    points = dict(settings(len(answers)))
    claims = {name: _strength(name, columns[name], points, seeds) for name in QUESTIONS}
    claims[ALL] = ClaimStrength(share(np.all([columns[claim] == 1 for claim in SECTION_V], axis=0)))
    effects = {name: found.effects for name, found in seeds.items()}
    return Strength(
        len(answers),
        {name: found.n for name, found in seeds.items()},
        claims,
        effects,
        {name: found.numbers for name, found in seeds.items()},
    )


def _strength(
    name: str, answers: np.ndarray, points: Mapping[str, np.ndarray], seeds: Mapping[str, OverSeeds]
) -> ClaimStrength:
    over: dict[str, Share] = {
        calibration: found.share(name) for calibration, found in seeds.items() if name in found.yes
    }
    answers, given = asked(answers, points)
    values = deciding(OPEN_VALUES, given, answers, LEAST_INDEX)[:MOST_VALUES]
    return ClaimStrength(share(answers), over, tuple((value.name, round(index, 3)) for value, index in values))
