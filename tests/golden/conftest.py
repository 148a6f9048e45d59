"""The option ``--update``: rewrite the golden files instead of comparing with them.

pytest reads it when this folder is named: ``pytest tests/golden --update``.
"""

from collections.abc import Callable
from difflib import unified_diff
from pathlib import Path

import pytest

FILES = Path(__file__).parent / "files"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare ``--update``."""
    parser.addoption("--update", action="store_true", help="rewrite the golden files of tests/golden")


@pytest.fixture
def assert_golden(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """Compares a text with the golden file of that name, or writes it with ``--update``."""

    def compare(name: str, text: str) -> None:
        path = FILES / name
        if request.config.getoption("--update", default=False):
            path.parent.mkdir(exist_ok=True)
            path.write_text(text, encoding="utf-8", newline="\n")
        golden = path.read_text(encoding="utf-8") if path.exists() else ""
        changes = unified_diff(golden.splitlines(), text.splitlines(), "golden", "now", lineterm="", n=1)
        message = "\n".join(changes)
        hint = "If this is meant: pytest tests/golden --update, and say so in CHANGELOG."
        assert golden == text, f"{name} has changed.\n{message}\n{hint}"

    return compare
