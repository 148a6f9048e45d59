"""Pages whose Python blocks are run in their order, in an empty folder, and show what the pages say."""

from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from tests.scenarios import drive
from tests.scenarios.pages import cells, run_here

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
OBJECTS = sorted(path.relative_to(DOCS).as_posix() for path in (DOCS / "objects").glob("*.md"))


@pytest.mark.parametrize("page", ["own-fmus.md", "two-masses.md", *OBJECTS])
def test_blocks_run_and_show_what_the_page_says(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    drive.write(tmp_path)
    ran = run_here(DOCS / page)
    plt.close("all")
    assert ran
    for cell, said in ran:
        assert cell.agrees(said), f"{page}, line {cell.line}, shows\n{cell.shown}\nand its block shows\n{said}"


def test_a_block_that_shows_something_else_is_noticed(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    fences = [("x = 1\nx + 1", "2"), ("print(x)\nx", "1\n1"), ("x", "2"), ("x", "1 ..."), ("x", None)]
    page.write_text("\n\n".join(f"```python\n{c}\n```\n" + (f"\n```text\n{s}\n```\n" if s else "") for c, s in fences))
    assert [(cell.line, cell.agrees(said)) for cell, said in run_here(page)][:2] == [(2, True), (12, True)]
    assert [cell.agrees(said) for cell, said in run_here(page)] == [True, True, False, True, True]
    assert len(cells(page)) == 5
