"""Tutorials and how-to guides, followed literally: their commands do what the pages say, and print what they show."""

import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.faults.cli import Command, runner
from tests.scenarios.pages import ROOT
from tests.scenarios.tutorial import WAIT, Block, Printed, blocks

GUIDES = [
    "docs/first-ten-minutes.md",
    "docs/how-to/offline.md",
    "docs/how-to/other-tools.md",
    "docs/how-to/plot-and-compare.md",
    "docs/how-to/test-a-component.md",
]
"""Pages whose fences of ``sh`` hold one command in a line; all but those of `ELSEWHERE` run ``adaptimp``."""
ELSEWHERE = {
    "uv sync --all-extras": "it would change the installation that the tests run in",
    "export UV_OFFLINE=1": "it tells uv something, and the commands of the tests do not go through uv",
    "uv run mkdocs build --strict -f .mkdocs.yml": "tests.scenarios.test_site builds the site",
}
FOUND_SOMETHING = ("check", "compare", "doctor")
"""Commands whose exit code 1 says that they found something."""


@pytest.fixture
def adaptimp(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Command:
    """The command line in an empty folder."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    return runner(monkeypatch, capsys)


def typed(adaptimp: Command, block: Block) -> Iterator[str]:
    """What the commands of a fence print."""
    for line in block.text.splitlines():
        if line in ELSEWHERE:
            continue
        assert line.startswith("uv run adaptimp "), f"line {block.line}: {line!r} is no command of adaptimp"
        words = shlex.split(line.removeprefix("uv run adaptimp "), comments=True)
        outcome = adaptimp(*words[: words.index(">")] if ">" in words else words)
        allowed = (0, 1) if words[0] in FOUND_SOMETHING else (0,)
        assert outcome.code in allowed, f"line {block.line}: {line}\n{outcome.out}{outcome.err}"
        yield WAIT.sub("", outcome.err + outcome.out)


@pytest.mark.parametrize("page", GUIDES)
def test_commands_print_what_the_page_shows(adaptimp: Command, page: str) -> None:
    last, of_commands = "", False
    for block in blocks(ROOT / page):
        if block.kind == "sh":
            last, of_commands = "".join(typed(adaptimp, block)), True
        elif block.kind == "python":
            of_commands = False
        elif of_commands:
            printed = Printed(block.line, block.text, last)
            assert printed.agree, f"{page}, line {block.line}, shows\n{block.text}\nand the commands print\n{last}"


def test_every_reason_is_needed() -> None:
    lines = {line for page in GUIDES for b in blocks(ROOT / page) if b.kind == "sh" for line in b.text.splitlines()}
    assert set(ELSEWHERE) <= lines
