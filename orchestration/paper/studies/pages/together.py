"""The part of the page on claims together: whether those of Section V hold at once, and which exclude each other."""

from collections.abc import Mapping
from itertools import combinations

import numpy as np

from orchestration.paper.laboratory import SEEDS
from orchestration.paper.studies.claims_at import CLEARLY
from orchestration.paper.studies.open_values import OPEN_VALUES
from orchestration.paper.studies.pages.claims import COMPARED
from orchestration.paper.studies.pages.text import listed, percent, table
from orchestration.paper.studies.pages.values import name_of
from orchestration.paper.studies.shares import share
from orchestration.paper.studies.together import CANDIDATES, NEIGHBOURS, SECTION_V, STARTS, WIDTH, Search

PAIRS = (*SECTION_V, "C7 clearly", "C10 clearly")
RARE = 0.5  # of what chance gives: below, two claims are said to be at odds
Answers = Mapping[str, np.ndarray]


def together(columns: Answers) -> str:
    """How many of C4 to C10 hold at once."""
    held = np.array([columns[claim] for claim in SECTION_V])
    count = held.sum(axis=0)
    every = count == len(SECTION_V)
    counts = [[str(k), percent(share(count == k))] for k in range(len(SECTION_V) + 1)]
    alone = []
    for i, claim in enumerate(SECTION_V):
        others = np.delete(held, i, axis=0).all(axis=0)
        alone.append([claim, f"{int((others & ~every).sum()):,}"])
    found = share(every)
    clear = share(every & (columns["C7 clearly"] == 1) & (columns["C10 clearly"] == 1))
    return f"""## Do C4 to C10 hold together?

All seven claims hold in {found.yes:,} of {found.n:,} settings, {percent(found)}. In {clear.yes:,} of them the errors of
C7 and C10 are also clearly larger, by {100 * (CLEARLY - 1):.0f} % or more.

{table(("number of the seven claims that hold", "share of the settings"), counts)}
Settings in which one claim alone fails:

{table(("claim", "settings"), alone)}"""


def at_odds(columns: Answers) -> str:
    """Pairs of claims that hold together more rarely than chance would have it."""
    n = len(columns[SECTION_V[0]])
    rows = []
    for one, two in combinations(PAIRS, 2):
        if {one, two} in ({"C7", "C7 clearly"}, {"C10", "C10 clearly"}):
            continue
        both = int(((columns[one] == 1) & (columns[two] == 1)).sum())
        expected = (columns[one] == 1).mean() * (columns[two] == 1).mean() * n
        if both < RARE * expected:
            rows.append((both / expected, [f"{one} and {two}", f"{both:,}", f"{expected:.0f}"]))
    shown = [row for _, row in sorted(rows)]
    heads = ("claims", "settings in which both hold", "expected if they were independent")
    rare = table(heads, shown) if shown else "There is no such pair.\n"
    clear_and_cheap = int(((columns["C7 clearly"] == 1) & (columns["C8"] == 1)).sum())
    return f"""## What rarely holds at once

Two claims are at odds if they hold together in less than {100 * RARE:.0f} % of the settings that one would expect of
independent claims with their shares.

{rare}
A Fig. 6 that is visibly worse than Fig. 5 (C7 clearly) and a Fig. 7 that needs a quarter less torque (C8) stand
together in {clear_and_cheap:,} of {n:,} settings. C13 holds in {int((columns["C13"] == 1).sum())} of {n:,}.
"""


def best(search: Search) -> str:
    """What the search for the best setting has found."""
    first = search.best[0]
    missing = [claim for claim in SECTION_V if not first.verdicts[claim]]
    outcome = (
        "so there are settings at which they hold together"
        if not missing
        else f"so they do not hold together; what fails is {listed(missing)}"
    )
    values = [[name_of(v), f"{first.setting[v.name]:.4g}"] for v in OPEN_VALUES]
    others = [
        [
            judged.origin,
            str(judged.held),
            listed(claim for claim in SECTION_V if not judged.verdicts[claim]),
            listed(claim for claim in COMPARED if judged.verdicts[f"{claim} clearly"]),
        ]
        for judged in search.best
    ]
    return f"""## The best settings

    uv run python -m orchestration.paper.studies.robustness --search

looks at {search.looked_at:,} settings of the table, and takes the {STARTS} at which most of the seven claims hold. It
tries {NEIGHBOURS} neighbours of each, in a box of {100 * WIDTH:.0f} % of each range, {search.tried} settings in all.
With one seed all seven hold at {search.all_hold} settings, counting the table and the neighbours. The best {CANDIDATES}
are judged over {len(SEEDS)} seeds. So are the chosen values, those of the calibration `first`, and a setting that
independent code has found by an optimization of its own. Over {len(SEEDS)} seeds {_number_of(first.held)} hold at the
best setting, {outcome}. The search takes the bound of the noise and the limits as they come, not rounded as the
calibrations have them, so a claim at its limit may turn.

{table(("origin", f"hold over {len(SEEDS)} seeds", "fail", "errors clearly larger"), others)}
The best setting ({first.origin}):

{table(("value", "best"), values)}"""


def _number_of(held: int) -> str:
    """How many of the claims of Section V, in words."""
    return "all seven claims" if held == len(SECTION_V) else f"{held} of the seven claims"
