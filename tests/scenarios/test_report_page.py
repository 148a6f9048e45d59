"""docs/report.md, followed literally: each command writes the page that it names."""

import shlex
from pathlib import Path

import pytest

from tests.faults.cli import runner
from tests.scenarios.tutorial import blocks

PAGE = Path(__file__).parents[2] / "docs" / "report.md"


def test_the_commands_write_pages(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)
    adaptimp = runner(monkeypatch, capsys)
    commands = [shlex.split(line) for block in blocks(PAGE) if block.kind == "sh" for line in block.text.splitlines()]
    assert len(commands) == 5
    for name, *words in commands:
        assert name == "adaptimp"
        assert adaptimp(*words).code == 0
    pages = {path.name: path.read_text(encoding="utf-8") for path in tmp_path.glob("*.html")}
    assert pages.keys() == {"fig2.html", "hogan.html", "both.html"}
    assert 'id="difference-panels"' in pages["both.html"]
    for text in pages.values():
        assert 'id="arm"' in text
        assert len(text) < 2.5e6
