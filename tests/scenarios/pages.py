"""Runs the Python blocks of a page of Markdown in their order, and compares what they show with what the page shows.

A fence of ``python`` is a cell of a notebook: it may print, and its last line may be an expression, whose value is
shown. A fence of ``text`` right behind it holds what it shows; ``...`` stands for anything.

    uv run python -m tests.scenarios.pages [PAGE...]    writes into pages what their blocks show now
"""

import ast
import io
import re
import sys
import tempfile
from contextlib import chdir, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from adaptimp_fmu import build
from fmus.catalog import MODELS
from tests.scenarios import drive

FENCE = re.compile(r"^```python\n(?P<code>.*?)^```\n(?:\n```text\n(?P<shown>.*?)^```\n)?", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Cell:
    """A Python block of a page.

    Attributes
    ----------
    line
        Number of the first line of its code.
    shown
        What the page says that it shows; None if the page shows nothing.
    """

    page: Path
    line: int
    code: str
    shown: str | None

    def run(self, names: dict[str, Any]) -> str:
        """Run the block with the names of the blocks before it; return what a notebook would show."""
        tree = ast.parse("\n" * (self.line - 1) + self.code, str(self.page))  # errors name lines of the page
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        said = io.StringIO()
        with redirect_stdout(said):
            exec(compile(tree, str(self.page), "exec"), names)
            value = None
            if isinstance(last, ast.Expr):
                value = eval(compile(ast.Expression(last.value), str(self.page), "eval"), names)
        return said.getvalue() + (f"{value!r}\n" if value is not None else "")

    def agrees(self, real: str) -> bool:
        """Whether the page shows what is shown; line breaks and blanks do not count."""
        if self.shown is None:
            return True
        parts = [re.escape(" ".join(part.split())) for part in self.shown.split("...")]
        return re.fullmatch(r"\s*" + r"\s*.*?\s*".join(parts) + r"\s*", " ".join(real.split())) is not None


def cells(page: Path) -> list[Cell]:
    """Python blocks of a page in their order."""
    text = page.read_text(encoding="utf-8")
    return [Cell(page, text.count("\n", 0, m.start("code")) + 1, m["code"], m["shown"]) for m in FENCE.finditer(text)]


ROOT = Path(__file__).parents[2]
PAGES = sorted(p.relative_to(ROOT).as_posix() for p in (*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")))
ELSEWHERE = (
    "docs/components.md",
    "docs/containers.md",
    "docs/write-your-own-controller.md",
    "docs/your-robot.md",
)
"""Pages with tests of their own: `tests.unit.fmus.test_documented_examples`, `tests.scenarios.test_containers_page`,
`tests.scenarios.test_tutorial` and `tests.scenarios.test_your_robot`."""
WITH_BLOCKS = [page for page in PAGES if page not in ELSEWHERE and cells(ROOT / page)]
"""Pages whose blocks run in their order in an empty folder."""


def furnish(folder: Path, page: Path) -> None:
    """Write the FMUs that a page takes for granted into a folder."""
    text = page.read_text(encoding="utf-8")
    if '"Pump.fmu"' in text:
        drive.write(folder)
    for name, declare in MODELS.items():
        if f"fmus_built/{name}.fmu" in text:
            build(declare(), folder / "fmus_built")


def run_here(page: Path) -> list[tuple[Cell, str]]:
    """Run all blocks of a page in the present folder; return each with what it shows."""
    names: dict[str, Any] = {}
    return [(cell, cell.run(names)) for cell in cells(page)]


def with_what_is_shown(page: Path) -> str:
    """The text of a page with what its blocks show now."""
    real = iter(run_here(page))

    def renewed(match: re.Match[str]) -> str:
        cell, said = next(real)
        if cell.shown is None or cell.agrees(said):
            return match[0]
        return f"```python\n{cell.code}```\n\n```text\n{said}```\n"

    return FENCE.sub(renewed, page.read_text(encoding="utf-8"))


if __name__ == "__main__":
    for page in [Path(name).resolve() for name in sys.argv[1:]] or [ROOT / name for name in WITH_BLOCKS]:
        with tempfile.TemporaryDirectory() as folder, chdir(folder):
            furnish(Path(folder), page)
            page.write_text(with_what_is_shown(page), encoding="utf-8")
