"""docs/calibration.md is what docs/calibration.json gives, and a small part of the search repeats."""

from dataclasses import replace
from pathlib import Path

import pytest

from orchestration.paper.calibrate import KNOWN, laboratory
from orchestration.paper.calibrations import CALIBRATIONS, CHOSEN_CALIBRATION, FIRST
from orchestration.paper.studies.calibration import search
from orchestration.paper.studies.calibration.page import page
from orchestration.paper.studies.calibration.record import Period, Record
from orchestration.paper.studies.calibration.space import starts
from orchestration.paper.studies.fixed_values import FIXED
from orchestration.paper.studies.native_runs import NativeLaboratory
from orchestration.paper.studies.open_values import OPEN_VALUES
from orchestration.paper.studies.pages.text import filled

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


def test_the_sentence_on_the_sampling_period_has_the_numbers_of_the_record(record: Record) -> None:
    moved = replace(record, periods=(Period(2e-5, 0, 0.1, 0.123), Period(1e-5, 0, 0.01, 0.045)))
    sentence = (
        "At 2e-05 s m2_hat is off by up to 12.3% in contact of Fig. 5, at 1e-05 s by up to 4.5%, and C5 allows 20%."
    )
    assert sentence in " ".join(page(moved).split())


def test_small_moves_of_the_torque_limits_are_not_shown_as_none(record: Record) -> None:
    moved = replace(record, nudges=replace(record.nudges, moved=(1.6e-6, 0.02)))
    sentence = "differ from those above by up to 1.6e-06 and 2.0e-02 of their size"
    assert sentence in " ".join(page(moved).split())


def test_paragraphs_have_lines_of_even_length() -> None:
    given = (
        "# Title\n\nOne\ntwo.\n\n    code\n    code\n| a |\n| b |\n- item\n  goes on\n- next\n1. first\n   goes on\n"
    )
    assert filled(given) == (
        "# Title\n\nOne two.\n\n    code\n    code\n| a |\n| b |\n- item goes on\n- next\n1. first goes on\n"
    )
    long = filled("- " + "word " * 50)
    assert len(long.partition("\n")[0]) > 110
    assert long.split("\n")[1].startswith("  word")


def test_a_small_part_of_the_search_repeats(record: Record) -> None:
    """The first settings that the search looks at have the costs that are written down, on every machine."""
    natives = NativeLaboratory(laboratory().fmus)
    first = starts(KNOWN, search.ANYWHERE, search.AROUND, search.WIDTH)[: search.REPEATED]
    found = [search.tried_at(natives, shares, search.SEEDS[:1]).cost for shares in first]
    assert found == pytest.approx(list(record.found.first_costs), rel=1e-12)
