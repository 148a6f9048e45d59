"""The strength of claims: its words, and the data file of the package."""

from dataclasses import replace
from pathlib import Path

import pytest

from orchestration.paper.calibrations import CALIBRATIONS, FIRST
from orchestration.paper.share import Share
from orchestration.paper.strength import ClaimStrength, Effect, Strength, read_strength, strength_word

FOUND = Strength(
    100,
    {"first": 30},
    {"C4": ClaimStrength(Share(5, 100), {"first": Share(29, 30)}, (("Gamma_1", 0.13),)), "C12a": ClaimStrength()},
    {"first": {"fig6/fig5 e_contact": Effect(1.1, 1.0, 1.2, Share(20, 30))}},
    {"first": FIRST.numbers},
)


@pytest.mark.parametrize(
    ("holds", "yes", "expected"),
    [
        (True, 5, "holds"),
        (True, 4, "holds at the calibration only"),
        (True, 0, "holds at the calibration only"),
        (False, 50, "fails here, holds elsewhere"),
        (False, 1, "fails here, holds elsewhere"),
        (False, 0, "holds nowhere in the space searched"),
    ],
)
def test_words(holds: bool, yes: int, expected: str) -> None:
    assert strength_word(holds, Share(yes, 100)) == expected


def test_numbers_are_read_as_they_were_written(tmp_path: Path) -> None:
    FOUND.write(tmp_path / "strength.json")
    assert Strength.read((tmp_path / "strength.json").read_text(encoding="utf-8")) == FOUND


def test_seeds_at_other_values_of_a_calibration_are_left_out() -> None:
    assert FOUND.stale(CALIBRATIONS) == []
    assert FOUND.at(CALIBRATIONS) == FOUND
    moved = {"first": replace(FIRST, values={**FIRST.values, "depth": 9e-3})}
    assert FOUND.stale(moved) == ["first"]
    assert FOUND.stale({}) == ["first"]
    found = FOUND.at(moved)
    assert found.claims["C4"].space == Share(5, 100), "the space hangs on no calibration"
    assert found.claims["C4"].seeds == {}
    assert found.seeds == found.effects == {}


def test_the_package_brings_its_numbers() -> None:
    found = read_strength()
    assert found.settings >= 1024
    assert found.claims["C13"].space == Share(0, found.settings)
