"""docs/calibration.md is what docs/calibration.json gives, and a small part of the search repeats."""

from pathlib import Path

import pytest

from orchestration.paper.calibrate import laboratory
from orchestration.paper.calibrations import CALIBRATIONS, CHOSEN_CALIBRATION, FIRST
from orchestration.paper.studies.calibration import search
from orchestration.paper.studies.calibration.page import page
from orchestration.paper.studies.calibration.record import Record
from orchestration.paper.studies.calibration.space import starts
from orchestration.paper.studies.fixed_values import FIXED
from orchestration.paper.studies.native_runs import NativeLaboratory
from orchestration.paper.studies.open_values import EARLIER, OPEN_VALUES

DOCS = Path(__file__).parents[6] / "docs"


@pytest.fixture(scope="module")
def record() -> Record:
    return Record.read(DOCS / "calibration.json")


def test_the_page_is_what_the_record_gives(record: Record) -> None:
    assert (DOCS / "calibration.md").read_text(encoding="utf-8") == page(record)


def test_a_record_is_read_as_it_was_written(record: Record, tmp_path: Path) -> None:
    record.write(tmp_path / "calibration.json")
    assert (tmp_path / "calibration.json").read_bytes() == (DOCS / "calibration.json").read_bytes()


def test_the_proofs_are_of_the_calibrations(record: Record) -> None:
    assert set(record.proofs) == set(CALIBRATIONS)
    for name, proof in record.proofs.items():
        assert proof.setting == dict(CALIBRATIONS[name].values)
        assert round(proof.noise_bound, 2) == CALIBRATIONS[name].noise_bound


def test_all_sentences_hold_at_the_chosen_calibration(record: Record) -> None:
    chosen, first = record.proofs[CHOSEN_CALIBRATION.name], record.proofs[FIRST.name]
    assert max(chosen.excesses.values()) < 0
    assert chosen.cost < 0 < first.cost
    assert chosen.kept > first.kept


def test_everything_that_is_open_is_on_the_page(record: Record) -> None:
    text = page(record)
    for value in OPEN_VALUES:
        assert f"| {value.name}" in text
        assert value.reason in text
    for fixed in FIXED:
        assert f"| {fixed.name} | {fixed.value} |" in text


def test_a_small_part_of_the_search_repeats(record: Record) -> None:
    """The first settings that the search looks at have the costs that are written down, on every machine."""
    natives = NativeLaboratory(laboratory().fmus)
    first = starts((EARLIER, FIRST.values), search.ANYWHERE, search.AROUND, search.WIDTH)[: search.REPEATED]
    found = [search.tried_at(natives, shares, search.SEEDS[:1]).cost for shares in first]
    assert found == pytest.approx(list(record.found.first_costs), rel=1e-12)
