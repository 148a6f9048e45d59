"""Evidence for the main job: figures that show something, and a verdict on every claim."""

import re
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

from tests.scenarios.conftest import Paper

KEYS = {"id", "claim", "where", "criterion", "measured", "verdict", "strength", "space", "seeds", "deciding", "first"}
VERDICTS = {"holds", "not reproduced", "not evaluated"}
IDS = (
    "C1 C2 C3a C3b C4 C5 C6 C7 C8 C9 C10 C11a C11b C12a C12b C12c C13 C14a C14b C14c C15 C16 C17 C18 C19a C19b C20"
).split()
MUST_HOLD = ("C1", "C2", "C3a", "C15", "C18")  # what conventional control and the equations decide
FIGURES = ("fig2.png", "fig3.png", "fig4.png")
LARGEST_PAGE = 2.5e6  # bytes
PNG = b"\x89PNG\r\n\x1a\n"


def test_every_claim_has_its_row(paper: Paper) -> None:
    assert [record["id"] for record in paper.records] == IDS
    for record in paper.records:
        assert set(record) >= KEYS
        assert record["verdict"] in VERDICTS
        assert record["claim"]
        assert record["where"]
        assert record["measured"]
        assert record["criterion"] or record["verdict"] == "not evaluated"


@pytest.mark.parametrize("claim", MUST_HOLD)
def test_claim_holds_with_numbers(paper: Paper, claim: str) -> None:
    (record,) = (record for record in paper.records if record["id"] == claim)
    assert record["verdict"] == "holds", record["measured"]
    assert re.search(r"\d", record["criterion"])
    assert len(re.findall(r"\d+\.?\d*(?:e[+-]\d+)?", record["measured"])) >= 1


def test_measured_numbers_meet_the_stated_criteria(paper: Paper) -> None:
    """Read from the words, as a reader would: the verdict is no mere label."""
    measured = {record["id"]: record["measured"] for record in paper.records}
    before, after = map(float, re.findall(r"([\d.e-]+) mm", measured["C1"])[:2])
    assert before <= 0.01
    assert after >= 100 * before
    assert float(re.findall(r"\|e\| ([\d.e-]+) mm", measured["C2"])[0]) <= 1
    wrong, true = map(float, re.findall(r"([\d.e-]+) mm", measured["C3a"])[:2])
    assert wrong >= max(5, 10 * true)
    assert max(map(float, re.findall(r"[\d.]+e-\d+", measured["C15"]))) <= 1e-10
    assert max(map(float, re.findall(r"[\d.]+e-\d+", measured["C18"]))) <= 1e-10


def test_report_lists_what_was_written(paper: Paper) -> None:
    written = {path.name for path in paper.folder.iterdir()}
    assert {*FIGURES, "claims.json", "report.html"} <= written
    assert paper.report.page.stat().st_size < LARGEST_PAGE
    assert {path.name for path in paper.report.figures} | {paper.report.claims_file.name} <= written
    assert not [name for name in written if name.endswith(".part")]
    assert [claim.id for claim in paper.report.claims] == IDS
    assert any("fig2" in sentence for sentence in paper.said)


@pytest.mark.parametrize("name", FIGURES)
def test_figure_shows_something(paper: Paper, name: str) -> None:
    path: Path = paper.folder / name
    assert path.read_bytes().startswith(PNG)
    image = matplotlib.image.imread(path)[..., :3]
    height, width, _ = image.shape
    assert min(height, width) >= 600  # pixels, readable
    ink = (image < 0.9).any(axis=2)
    panels = [half for rows in np.array_split(ink, 2) for half in np.array_split(rows, 2, axis=1)]
    for panel in panels if name != "fig3.png" else [ink]:
        assert panel.mean() >= 0.01  # of a blank page with axes about 0.005 is ink
    coloured = np.ptp(image, axis=2) > 0.2
    assert coloured.sum() > 500  # pixels of coloured curves


def test_figures_differ(paper: Paper) -> None:
    assert len({(paper.folder / name).read_bytes() for name in FIGURES}) == len(FIGURES)
