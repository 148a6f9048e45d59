"""The parts of the page on single claims: the share of the settings in which each holds, and what decides it."""

from collections.abc import Mapping

import numpy as np

from orchestration.paper.laboratory import SEEDS
from orchestration.paper.share import Share
from orchestration.paper.studies.claims_at import CLEARLY
from orchestration.paper.studies.open_values import OPEN_VALUES
from orchestration.paper.studies.pages.text import percent, table
from orchestration.paper.studies.shares import SURE, best_part, deciding, parts, share

SENTENCES: Mapping[str, str] = {
    "C1": "the TIRT and the virtual trajectory nearly coincide until the wall is hit, and then differ",
    "C2": "with true parameters and a perfect sensor the tip follows its TIRT, slides from a to b and returns",
    "C3a": "with m2 = 2.5 kg conventional control tracks much worse",
    "C3b": "with m2 = 2.5 kg the contact force is worse, too",
    "C4": "m2_hat quickly approaches 1 kg during the first free motion",
    "C5": "during contact m2_hat fluctuates visibly, and by less than 20 %",
    "C6": "m2_hat recovers as soon as the tip leaves the wall at b",
    "C7": "saturation at 75 % gives larger tracking and force errors, which stay bounded",
    "C8": "algorithm 2 needs considerably less torque, and 75 % of algorithm 1's maximum never saturates it",
    "C9": "the tracking error of algorithm 2 is very small in free motion, and half of that without adaptation at most",
    "C10": "errors of algorithm 2 in contact are slightly larger than those of algorithm 1 without saturation",
    "C12b": "m2_hat may be updated at a lower rate",
    "C12c": "the term C_x s of algorithm 2 may be ignored",
    "C13": "the TIRT need only be integrated during contact",
    "C14a": "V_c does not grow during contact (the order of its rises in the sampling period is not asked here)",
    "C14b": "V_s decreases where s is at least delta/k_d, and s and e keep their bounds",
    "C14c": "a larger K_d gives a smaller s, from m2_hat = 2.5 kg on",
    "C16": "the variant with a fixed inverse does the same task",
    "C17": "gamma* of (26) bounds the needed gamma",
    "C19a": "if the sensor fails, or a large force saturates the actuators, the error of algorithm 2 stays bounded",
    "C19b": "the same of algorithm 1",
    "C20": "saturation lets V_c grow no faster than (28) says, and not outside of a region of small errors",
}
"""What each claim says, in our words; docs/claims.md has the criteria."""
CLAIMS = tuple(SENTENCES)
COMPARED = ("C7", "C10")
"""Claims that compare errors of two figures."""
LEAST_INDEX = 0.02  # of a value that is said to decide
MOST_VALUES = 4  # that are shown for a claim
Answers = Mapping[str, np.ndarray]
Points = Mapping[str, np.ndarray]


def asked(answers: np.ndarray, points: Points) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Answers and settings where a question was asked."""
    where = answers >= 0
    return answers[where], {name: values[where] for name, values in points.items()}


def space(claim: str, columns: Answers) -> Share:
    """The share of the settings in which a claim holds."""
    return share(columns[claim][columns[claim] >= 0])


def clear_space(claim: str, columns: Answers) -> Share:
    """The share of the settings in which a claim holds, and clearly so if it compares errors."""
    return space(f"{claim} clearly" if claim in COMPARED else claim, columns)


def overview(columns: Answers, chosen: Mapping[str, bool], n: int) -> str:
    """The table of all claims.

    Parameters
    ----------
    chosen
        Verdicts at the chosen values, over n seeds at once.
    """
    rows = []
    for claim in CLAIMS:
        found = space(claim, columns)
        here = "not judged here" if claim not in chosen else "holds" if chosen[claim] else "fails"
        clear = percent(clear_space(claim, columns)) if claim in COMPARED else ""
        rows.append([f"[{claim}](#{claim.lower()})", SENTENCES[claim], percent(found), clear, f"{found.n:,}", here])
    heads = (
        "claim",
        "sentence",
        "share of the settings",
        "clearly",
        "settings",
        f"{n:,} seeds at the chosen values",
    )
    return f"""## The claims

{table(heads, rows)}
C7 and C10 compare errors of two figures, and with one seed either may be larger by chance. In the column *clearly*
stands the share in which both errors are larger by {100 * (CLEARLY - 1):.0f} % or more.

The verdict at the chosen values is that of all seeds at once. Where the worst of all seeds decides, as in C4 to C6,
more seeds ask for more. [claims.md](claims.md) judges the claims over {len(SEEDS)} seeds, and says in words how
strongly each of them holds.

Below, a value is said to decide a claim if it alone explains {100 * LEAST_INDEX:.0f} % or more of the variance of the
answers, and more than chance gives to a value without effect in all but {1000 * (1 - SURE):.0f} of 1,000 cases. At most
{MOST_VALUES} values are shown.
"""


def claim_section(claim: str, columns: Answers, points: Points) -> str:
    """What decides a claim."""
    found = space(claim, columns)
    text = f"## {claim}\n\nThe claim: {SENTENCES[claim]}. It holds in {percent(found)} of {found.n:,} settings."
    if claim in COMPARED:
        text += (
            f" Both errors are larger by {100 * (CLEARLY - 1):.0f} % or more in {percent(clear_space(claim, columns))}."
        )
    return f"{text}\n{what_decides(columns[claim], points)}"


def what_decides(answers: np.ndarray, points: Points) -> str:
    """The values that decide, and the part of the space in which most settings answer yes."""
    answers, given = asked(answers, points)
    if answers.all() or not answers.any():
        return "\nThe answer is the same at all settings.\n"
    values = deciding(OPEN_VALUES, given, answers, LEAST_INDEX)[:MOST_VALUES]
    rows = [
        [
            value.name,
            f"{100 * index:.0f} %",
            "; ".join(f"{name}: {100 * s.value:.0f} %" for name, s in parts(value, given[value.name], answers)),
        ]
        for value, index in values
    ]
    shown = table(("deciding value", "explains", "share where the value is"), rows) if rows else ""
    where, best = best_part(OPEN_VALUES, given, answers)
    said = ", and there where ".join(f"{name} is {part}" for name, part in where)
    alone = "" if rows else "No single value decides it.\n"
    return f"\n{alone}{shown}\nIt holds most often where {said}: {percent(best)}.\n"


def sensitivity(columns: Answers, points: Points) -> str:
    """C11: which algorithm is less sensitive to its gains."""
    common = points["Psi_2"] <= points["Psi_1"].max()
    there = {name: values[common] for name, values in points.items()}
    rows = []
    for text, name in (("stable", "stable"), ("stable and accurate", "accurate")):
        one, two = share(columns[f"{name} 1"][common]), share(columns[f"{name} 2"][common])
        apart = one.high < two.low or two.high < one.low
        less = "algorithm 2" if two.value > one.value else "algorithm 1"
        rows.append([text, percent(one), percent(two), less if apart else "not told apart"])
    return f"""## C11: which algorithm is less sensitive?

C11 has a study of its own, a grid of Psi and Gamma. The settings of this page give a second answer, in the part of the
space that both algorithms share: Psi_2 lies in the range of Psi_1, which leaves {int(common.sum()):,} settings. Both
gains Gamma have the same range. Algorithm 2 runs without limits of torque here, as algorithm 1 does.

{table(("run", "algorithm 1", "algorithm 2", "less sensitive"), rows)}
Where algorithm 1 is stable and accurate, in this part:
{what_decides(columns["accurate 1"][common], there)}
Where algorithm 2 is so:
{what_decides(columns["accurate 2"][common], there)}"""


def gains(columns: Answers) -> str:
    """C14c with other starts."""
    rows = [
        [text, percent(space(name, columns))]
        for text, name in (
            ("from 2.5 kg, as in the paper", "C14c"),
            ("from the true mass", "C14c true"),
            ("from 2.5 kg, with a Gamma that grows in proportion to K_d", "C14c proportional"),
        )
    ]
    return f"""
A larger K_d makes the adaptation slower, so s is not smaller while m2_hat is wrong. Other starts show it:

{table(("K_d from 30 to 3000 N.s/m", "share in which each larger K_d gives a smaller s"), rows)}"""
