"""Fixtures: the main job, made once."""

import json
from pathlib import Path
from typing import NamedTuple

import pytest

from orchestration.paper.report import Report, reproduce


class Paper(NamedTuple):
    """What the main job left in its folder, and said."""

    folder: Path
    report: Report
    records: list[dict[str, str]]
    said: list[str]


@pytest.fixture(scope="session")
def paper(tmp_path_factory: pytest.TempPathFactory) -> Paper:
    """The main job, run once; warnings are errors."""
    folder = tmp_path_factory.mktemp("paper") / "new" / "out"
    folder.mkdir(parents=True)
    said: list[str] = []
    report = reproduce(folder, said.append)
    return Paper(folder, report, json.loads(report.claims_file.read_text(encoding="utf-8")), said)
