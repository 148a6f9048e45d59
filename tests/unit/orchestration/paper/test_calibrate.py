"""The page of the calibration is written from its record, without a run."""

from pathlib import Path

import pytest

from orchestration.paper import calibrate
from orchestration.paper.studies.calibration.record import Record

DOCS = Path(__file__).parents[4] / "docs"


def test_the_page_alone_needs_no_fmu(monkeypatch: pytest.MonkeyPatch) -> None:
    built = []
    monkeypatch.setattr(calibrate, "laboratory", lambda: built.append(1))
    record = Record.read(DOCS / calibrate.RECORD)
    assert calibrate.renewed(record, lambda _: None, look=False, prove_all=False) is record
    assert not built
