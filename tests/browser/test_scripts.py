"""Evidence that the scripts of pages are typed, linted, and few."""

import re
from pathlib import Path

from tests.browser.conftest import run_tool

ROOT = Path(__file__).parents[2]
FOLDERS = (ROOT / "orchestration" / "report" / "script", ROOT / "orchestration" / "paper" / "page" / "script")
MOST_LINES = 799  # of code of report and live page together
COMMENT = re.compile(r"/\*.*?\*/|^\s*//.*?$", re.DOTALL | re.MULTILINE)


def test_the_types_of_the_scripts_are_right() -> None:
    assert run_tool("tsc", "-p", ".") == ""


def test_the_linter_finds_nothing() -> None:
    config = Path(__file__).with_name("eslint.config.js")
    folders = [folder.relative_to(ROOT).as_posix() for folder in FOLDERS]
    assert run_tool("eslint", "-c", str(config), *folders, cwd=ROOT) == ""


def test_report_and_live_page_need_few_lines() -> None:
    files = [file for folder in FOLDERS for file in sorted(folder.glob("*.js"))]
    texts = [COMMENT.sub("", file.read_text(encoding="utf-8")) for file in files]
    lines = sum(bool(line.strip()) for text in texts for line in text.splitlines())
    assert 100 < lines <= MOST_LINES
