"""The Python blocks of README and of the documentation have no error of types.

docs/components.md is left out: it gives numbers to equations, whose arguments are declared as symbols.
"""

import json
import subprocess
import sys
from pathlib import Path

from tests.scenarios.pages import ROOT, WITH_BLOCKS, cells
from tests.scenarios.tutorial import blocks

DOCS = ROOT / "docs"
TUTORIAL = "write-your-own-controller.md"
STRICTNESS = {"typeCheckingMode": "standard", "reportUnusedExpression": False, "reportUnusedCoroutine": False}


def errors_of(sources: dict[str, str], folder: Path) -> list[str]:
    """Errors that pyright finds in files by name, as ``name:line: message``."""
    for name, text in sources.items():
        (folder / name).write_text(text, encoding="utf-8")
    config = {"extraPaths": [str(ROOT), str(ROOT / "typings")], "stubPath": str(ROOT / "typings"), **STRICTNESS}
    (folder / "pyrightconfig.json").write_text(json.dumps(config), encoding="utf-8")
    command = [sys.executable, "-m", "pyright", "--outputjson", "--pythonpath", sys.executable, "-p", str(folder)]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    found = json.loads(run.stdout)["generalDiagnostics"]
    return [
        f"{Path(d['file']).name}:{d['range']['start']['line'] + 1}: {d['message']}"
        for d in found
        if d["severity"] == "error"
    ]


def as_module(page: Path) -> str:
    """All blocks of a page in one file, each on its lines of the page."""
    lines: list[str] = []
    for cell in cells(page):
        lines += [""] * (cell.line - 1 - len(lines)) + cell.code.splitlines()
    return "\n".join(lines) + "\n"


def test_blocks_have_no_error_of_types(tmp_path: Path) -> None:
    tutorial = {b.file.replace("/", "_"): b.text for b in blocks(DOCS / TUTORIAL) if b.file.endswith(".py")}
    pages = {page.replace("/", "_").replace(".md", "_md.py"): as_module(ROOT / page) for page in WITH_BLOCKS}
    assert tutorial
    wrong = "from orchestration import simulate\n\nsimulate(3.0, stop_time='soon')\n"
    found = errors_of({**tutorial, **pages, "wrong.py": wrong}, tmp_path)
    assert [error for error in found if error.startswith("wrong.py:3:")], "an error is noticed"
    assert [error for error in found if not error.startswith("wrong.py:")] == []


def test_lines_are_those_of_the_page() -> None:
    page = DOCS / "two-masses.md"
    text, module = page.read_text(encoding="utf-8").splitlines(), as_module(page).splitlines()
    assert all(line == text[i] for i, line in enumerate(module) if line)
