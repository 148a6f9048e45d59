"""Pages whose Python blocks are run in their order, in an empty folder, and show what the pages say."""

import re
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from tests.scenarios.pages import PAGES, ROOT, WITH_BLOCKS, cells, furnish, run_here

OBJECTS = [page for page in PAGES if page.startswith("docs/objects/")]
LINK = re.compile(r"\]\((?!https?:)([^)#\s]*)(?:#([^)\s]*))?\)")


@pytest.mark.parametrize("page", WITH_BLOCKS)
def test_blocks_run_and_show_what_the_page_says(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    furnish(tmp_path, ROOT / page)
    ran = run_here(ROOT / page)
    plt.close("all")
    assert ran
    for cell, said in ran:
        assert cell.agrees(said), f"{page}, line {cell.line}, shows\n{cell.shown}\nand its block shows\n{said}"


def headings(page: Path) -> set[str]:
    """Names of the headings of a page in links, as GitHub makes them."""
    lines = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", line.lower()).replace(" ", "-") for line in lines}


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page: str) -> None:
    for path, heading in LINK.findall((ROOT / page).read_text(encoding="utf-8")):
        target = (ROOT / page).parent / path if path else ROOT / page
        assert target.exists(), f"{page} links to {path}"
        assert not heading or heading in headings(target), f"{page} links to {path}#{heading}"


def test_the_pages_that_people_begin_with_have_blocks() -> None:
    assert {"README.md", "docs/own-fmus.md", "docs/two-masses.md"} <= set(WITH_BLOCKS)
    assert set(OBJECTS) <= set(WITH_BLOCKS)


def test_every_object_has_its_page_in_the_list() -> None:
    listed = (ROOT / "docs" / "master.md").read_text(encoding="utf-8")
    assert all(f"({Path(page).relative_to('docs').as_posix()})" in listed for page in OBJECTS)


def test_a_block_that_shows_something_else_is_noticed(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    fences = [("x = 1\nx + 1", "2"), ("print(x)\nx", "1\n1"), ("x", "2"), ("x", "1 ..."), ("x", None)]
    page.write_text("\n\n".join(f"```python\n{c}\n```\n" + (f"\n```text\n{s}\n```\n" if s else "") for c, s in fences))
    assert [(cell.line, cell.agrees(said)) for cell, said in run_here(page)][:2] == [(2, True), (12, True)]
    assert [cell.agrees(said) for cell, said in run_here(page)] == [True, True, False, True, True]
    assert len(cells(page)) == 5
