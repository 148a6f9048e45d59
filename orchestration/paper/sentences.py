"""What section V of the paper says, sentence by sentence in our words, and where each sentence can be seen.

A sentence names panels of figures, rows of docs/claims.md, or pages; a row says itself whether its claim holds.
"""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Panels:
    """Panels of a figure.

    Attributes
    ----------
    figure
        Name of the file without its suffix, such as ``fig5``.
    letters
        Letters of the panels, such as ``cd``; empty for a figure without panels.
    """

    figure: str
    letters: str = ""


@dataclass(frozen=True)
class Page:
    """A page or a file of the project: its path from the folder of the pages, and what the link says."""

    path: str
    text: str


@dataclass(frozen=True)
class Sentence:
    """A sentence of the paper.

    Attributes
    ----------
    words
        What the paper says, in our words.
    panels, rows, pages
        Where it is shown: panels of figures, claims by id, and pages.
    note
        What a reader must know besides.
    """

    words: str
    panels: Sequence[Panels] = ()
    rows: Sequence[str] = ()
    pages: Sequence[Page] = ()
    note: str = ""


NUMBERS = Page("../orchestration/paper/scenarios.py", "start values marked V")
CALIBRATION = Page("calibration.md", "calibration")
ROBUSTNESS = Page("robustness.md", "what the paper leaves open")
COMPONENTS = Page("components.md", "components")
ADAPTIVE = ("fig5", "fig6", "fig7")


def _of_all(letters: str) -> list[Panels]:
    return [Panels(figure, letters) for figure in ADAPTIVE]


SECTION_V = (
    Sentence(
        "Both algorithms are verified by simulation of a planar arm with two joints.",
        [Panels("fig1")],
        (),
        [COMPONENTS],
    ),
    Sentence(
        "The tip starts at (1.5, 0) and moves along an ellipse until it hits a wall at the point a.",
        [Panels("fig1"), Panels("fig2", "a")],
        ["C2"],
    ),
    Sentence(
        "In contact with the wall the tip then slides down its surface to the point b.",
        [Panels("fig2", "ad")],
        ["C2"],
        note="The wall is elastic and stiff, so the tip bounces before it slides.",
    ),
    Sentence("The tip leaves the wall and returns to (1.5, 0) along the ellipse.", [Panels("fig2", "a")], ["C2"]),
    Sentence(
        "The masses are points at the ends of the links: m1 = 2 kg, m2 = 1 kg, half of which is payload; both links are"
        " 1 m long.",
        [Panels("fig1")],
        (),
        [NUMBERS],
    ),
    Sentence(
        "The virtual trajectory is (1.5 cos pi t, sin pi t) from 0 to 2 s.",
        [Panels("fig1"), Panels("fig3", "a")],
        (),
        [NUMBERS],
    ),
    Sentence(
        "A small straight segment replaces the arc, so that the contact force is a proper one.",
        [Panels("fig1"), Panels("fig3", "b")],
        (),
        [CALIBRATION],
        note="The paper says neither where the wall is nor how deep the segment lies in it.",
    ),
    Sentence(
        "Fig. 2: with all parameters known and a perfect force sensor, conventional impedance control (5) gives the"
        " trajectories, torques, tracking error and contact force shown.",
        [Panels("fig2", "abcd")],
        ["C2", "C15"],
    ),
    Sentence(
        "The target impedance of Figs. 2 to 4 has B = 2 sqrt(M K), M = 2, K = 4000; the wall has K_f = 1e5.",
        (),
        (),
        [NUMBERS],
    ),
    Sentence(
        "Fig. 3: the TIRT and the virtual trajectory are nearly identical until a large force acts at the wall.",
        [Panels("fig3", "abcd")],
        ["C1"],
        note="Before the contact the sampled controller keeps them M h |d3x_v/dt3| / (2 K) apart, about 0.001 mm at"
        " h = 0.1 ms, since it predicts the virtual trajectory from one tick to the next; eq. (11) itself keeps them"
        " together.",
    ),
    Sentence(
        "Fig. 4: with m2 = 2.5 kg instead, conventional control degrades unacceptably.",
        [Panels("fig4", "abcd")],
        ["C3a", "C3b"],
    ),
    Sentence("The target impedance of Figs. 5 to 7 has B = 340, M = 2, K = 4000.", (), (), [NUMBERS]),
    Sentence(
        "Only m2 is unknown, and both algorithms start from 2.5 kg.",
        _of_all("b"),
        (),
        [NUMBERS],
    ),
    Sentence(
        "The measured force is the true one plus normally distributed noise, whose largest magnitude is about 15 % of"
        " the peak of the contact force.",
        [Panels("fig5", "d")],
        (),
        [NUMBERS, ROBUSTNESS],
        note="The paper says neither how often a new draw is taken nor whether there is noise without contact.",
    ),
    Sentence(
        "Fig. 5: algorithm 1 without saturation gives the trajectory, estimate, error and contact force shown.",
        [Panels("fig5", "abcd")],
        ["C4", "C5", "C6"],
    ),
    Sentence(
        "The actuators then provide 75 % of the largest torque of that run.",
        [Panels("torques", "abcd")],
        (),
        [CALIBRATION],
        note="The sentence has three readings: each joint's own largest torque, the largest of both, or their norm.",
    ),
    Sentence(
        "Fig. 6: with these actuators algorithm 1 has larger tracking errors and larger force errors.",
        [Panels("fig6", "cdgh")],
        ["C7"],
    ),
    Sentence("Its overall performance remains acceptable.", [Panels("fig6", "abcd")], ["C7", "C20"]),
    Sentence(
        "Fig. 7: algorithm 2 gives the trajectory, estimate, tracking error and contact force shown.",
        [Panels("fig7", "abcd")],
        ["C4", "C5", "C6"],
    ),
    Sentence("Algorithm 2 needs considerably less torque.", [Panels("torques", "abcd")], ["C8"]),
    Sentence(
        "So 75 % of the largest torque of algorithm 1 never saturates algorithm 2.", [Panels("torques", "abcd")], ["C8"]
    ),
    Sentence("Its tracking errors are very small in free motion.", [Panels("fig7", "c")], ["C9"]),
    Sentence(
        "Its tracking and force errors in contact are slightly larger than those of algorithm 1 without saturation.",
        [Panels("fig5", "cd"), Panels("fig7", "cd")],
        ["C10"],
    ),
    Sentence("In all cases the estimate of m2 quickly approaches 1 kg in the first free motion.", _of_all("b"), ["C4"]),
    Sentence("In contact the estimate fluctuates by less than 20 %.", _of_all("b"), ["C5"]),
    Sentence("The estimate recovers as soon as the tip leaves the wall at b.", _of_all("b"), ["C6"]),
    Sentence("Algorithm 2 appears to be the more efficient one to compute.", (), ["C12a", "C12b", "C12c"]),
    Sentence(
        "Psi and Gamma of algorithm 2 are less sensitive than those of algorithm 1 for a stable execution of the task.",
        (),
        ["C11a", "C11b"],
    ),
)
"""Section V, in its order."""

THEORY = (
    Sentence("II-B: the forms (4), (5) and (6)-(7) of impedance control agree.", (), ["C15"]),
    Sentence(
        "III-B: without contact the TIRT is the virtual trajectory, so it need only be integrated in contact.",
        [Panels("fig3", "cd")],
        ["C1", "C13"],
    ),
    Sentence("III-C: with F_c of (22) and (25) the Lyapunov function V_c decreases.", (), ["C14a"]),
    Sentence("III-C: gamma* of (26) says how large the gain of F_c may have to be.", (), ["C17"]),
    Sentence("III-C, remark 2: a variant needs one inverse, at fixed parameters.", (), ["C16"]),
    Sentence(
        "III-D: saturation may let V_c grow, but no faster than (28) says, and V_c falls again before the error grows"
        " large.",
        [Panels("saturation", "abcd"), Panels("fig6", "c")],
        ["C7", "C20"],
    ),
    Sentence("IV-A: the matrix dH_x/dt - 2 C_x is skew-symmetric.", (), ["C18"]),
    Sentence("IV-A: V_s decreases where |s| exceeds delta/k_d, so s, e and de are bounded.", (), ["C14b"]),
    Sentence("IV-A: a larger K_d makes s smaller.", (), ["C14c"]),
    Sentence(
        "IV-A: if a large force saturates the actuators or the sensor fails, the error likely grows and stays bounded.",
        (),
        ["C19a", "C19b"],
    ),
    Sentence("IV-B: algorithm 2 needs neither the acceleration nor an inverse of the inertia.", (), ["C12a"]),
    Sentence("IV-B: the estimate may be updated at a lower rate.", (), ["C12b"]),
    Sentence(
        "IV-B: the term C_x s may be ignored.",
        (),
        ["C12c"],
        note="The paper prints C_x dx_r beside + C_x s; with (31) they are C_x dx and - C_x s.",
    ),
)
"""Sentences of sections II to IV that can be measured."""
