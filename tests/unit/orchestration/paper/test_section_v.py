"""The page of section V's sentences: each has a place, and every place that it names is there."""

import re
from pathlib import Path

import pytest

from orchestration.paper.claims.evaluation import QUESTIONS
from orchestration.paper.claims.page import anchor
from orchestration.paper.section_v import CLAIMS, IMAGES, PAGE, UnknownRowError, page
from orchestration.paper.sentences import SECTION_V, THEORY, Panels, Sentence

DOCS = Path(__file__).parents[4] / "docs"
ALL = (*SECTION_V, *THEORY)


@pytest.mark.parametrize("sentence", ALL, ids=lambda sentence: sentence.words[:40])
def test_every_sentence_has_a_place(sentence: Sentence) -> None:
    assert sentence.panels or sentence.rows or sentence.pages


def test_every_claim_has_a_sentence_and_every_row_a_claim() -> None:
    """Claims of section V are named by sentences of section V."""
    named = {row for sentence in ALL for row in sentence.rows}
    assert named == {question.id for question in QUESTIONS}
    of_v = {row for sentence in SECTION_V for row in sentence.rows}
    assert {question.id for question in QUESTIONS if re.match(r"V\b", question.where)} <= of_v


def test_every_panel_is_there() -> None:
    """A figure's SVG holds the letter of a panel as text, or as the comment before a text drawn as paths."""
    for panels in {panels for sentence in ALL for panels in sentence.panels}:
        text = (DOCS / IMAGES / f"{panels.figure}.svg").read_text(encoding="utf-8")
        assert text.startswith("<?xml")
        missing = [letter for letter in panels.letters if not re.search(rf"(<!-- |>)\({letter}\) \S", text)]
        assert not missing, f"{panels.figure} has no panel {missing}"


def test_the_page_is_the_one_that_the_claims_make() -> None:
    assert (DOCS / PAGE).read_text(encoding="utf-8") == page((DOCS / CLAIMS).read_text(encoding="utf-8"))


def test_a_sentence_is_a_row_with_links() -> None:
    panels = [Panels("fig5", "ac"), Panels("fig6", "abcd"), Panels("torques")]
    sentence = Sentence("It moves by |e|.", panels, ["C12a"], note="Slowly.")
    text = page("# Claims\n\n## C12a: holds (equations)\n\nWords.\n", {"Part": [sentence]})
    assert text.endswith(
        "## Part\n\n| the paper says | figures | claims and pages |\n|---|---|---|\n"
        r"| It moves by \|e\|. *Slowly.* | [Fig. 5 (a), (c)](images/fig5.svg), [Fig. 6 (a) to (d)](images/fig6.svg),"
        " [Torques](images/torques.svg)"
        " | [C12a: holds (equations)](claims.md#c12a-holds-equations) |\n"
    )


def test_every_sentence_is_one_row_of_three_cells() -> None:
    claims = "\n".join(f"## {row}: holds\n" for sentence in ALL for row in sentence.rows)
    rows = re.findall(r"^\|.*\|$", page(claims), re.MULTILINE)
    assert len(rows) == len(ALL) + 4, "two tables with two lines above their rows"
    assert {len(re.split(r"(?<!\\)\|", row)) for row in rows} == {5}


def test_an_unknown_row_names_the_known_ones() -> None:
    with pytest.raises(UnknownRowError, match=r"no heading of claim C3; it has C1, C2\."):
        page("## C1: holds\n\n## C2: holds\n", {"Part": [Sentence("It holds.", (), ["C3"])]})


def test_an_anchor_is_that_of_the_pages() -> None:
    assert anchor("C7: fails here, holds elsewhere") == "c7-fails-here-holds-elsewhere"
