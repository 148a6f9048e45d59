"""The table of `docs/check-rules.md`: ``python -m tests.golden.rules --write`` writes it anew."""

import sys
from pathlib import Path

from orchestration.check import rules
from orchestration.check.rules import RULES

PAGE = Path(__file__).parents[2] / rules.PAGE
HEAD = "| rule | severity | what is wrong | FMI 2.0.4 | what to do |\n|---|---|---|---|---|\n"


def page(text: str) -> str:
    """The page with the table of today in the place of the one that it has."""
    before, head, rest = text.partition(HEAD)
    _, end, after = rest.partition("\n\n")
    rows = [(r.id, r.severity, r.fault, r.section or "-", r.remedy) for r in RULES]
    return before + head + "\n".join(f"| {' | '.join(row)} |" for row in rows) + end + after


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
