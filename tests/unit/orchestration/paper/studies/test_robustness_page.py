"""The page of the robustness study, from a table whose shares are known."""

import numpy as np
import pytest

from orchestration.paper.studies.claims_at import QUESTIONS
from orchestration.paper.studies.open_values import CHOSEN, OPEN_VALUES, settings
from orchestration.paper.studies.robustness_page import page
from orchestration.paper.studies.robustness_table import COLUMNS
from orchestration.paper.studies.seeds import CLAIMS, OverSeeds
from orchestration.paper.studies.together import Judged, Search

N = 256
SEEDS = OverSeeds(1000, dict.fromkeys(CLAIMS, 1000) | {"C8": 960}, dict.fromkeys(CLAIMS, True))


def table() -> np.ndarray:
    """All claims hold everywhere, but C9 at small depths only, and C13 nowhere."""
    answers = dict(zip(COLUMNS, np.ones((len(COLUMNS), N), dtype=int), strict=True))
    answers["C9"] = (settings(N)["depth"] < 15e-3).astype(int)
    answers["C13"][:] = 0
    return np.array([answers[name] for name in COLUMNS]).T


@pytest.fixture(scope="module")
def text() -> str:
    verdicts = dict.fromkeys(QUESTIONS, True) | {"C7": False, "C13": False}
    chosen = Judged("chosen", CHOSEN, verdicts)
    best = Judged("near setting 5", CHOSEN, dict.fromkeys(QUESTIONS, True))
    return page(table(), Search(chosen, (best, chosen), N, 512, 300), SEEDS)


def test_shares_and_words(text: str) -> None:
    assert "| C9 | " in text
    row = {line.split(" | ")[0].strip("| "): line for line in text.splitlines() if line.startswith("| C")}
    assert "| holds | 50.0 % (43.9 to 56.1) | holds |" in text
    assert "| fails | 100.0 % (98.5 to 100.0) | fails at the chosen values, holds elsewhere |" in text
    assert "| fails | 0.0 % (0.0 to 1.5) | holds nowhere in the space searched |" in text
    assert row["C8"] == "| C8 | 96.0 % (94.6 to 97.0) | holds |"  # of the seeds


def test_what_decides(text: str) -> None:
    section = text.partition("## C9: holds")[2].partition("\n## ")[0]
    # Of 16 equal parts of the range 8 hold everywhere; chance would give 15 / 255 of the variance.
    assert "| depth | 94 % | 0.005 to 0.0117: 100 %; 0.0117 to 0.0183: 51 %; 0.0183 to 0.025: 0 % |" in section
    assert "No single value decides it." in text.partition("## C13: ")[2].partition("\n## ")[0]


def test_claims_together(text: str) -> None:
    assert f"All seven claims hold in 128 of {N} settings, 50.0 % (43.9 to 56.1)." in text
    assert "| C9 | 128 |" in text, "it fails alone"
    assert "so there are settings at which all seven hold." in text
    assert "| chosen | 6 | C7 |" in text


def test_every_open_value_has_its_reason(text: str) -> None:
    for value in OPEN_VALUES:
        assert value.reason in text
    assert "1e-05 to 0.001, log" in text
    assert "| contact_gated | 1 | 1 or 0 |" in text
