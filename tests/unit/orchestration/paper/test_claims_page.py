"""The page of the claims says in words what verdict and shares say together, and its links lead to its headings."""

import re
from dataclasses import replace

import pytest

from orchestration.paper.calibrations import CALIBRATIONS
from orchestration.paper.claims.claim import HOLDS, NO_RUNS, NOT_REPRODUCED, Claim
from orchestration.paper.claims.page import as_markdown, as_records, word
from orchestration.paper.share import Share
from orchestration.paper.strength import ClaimStrength, Effect, Strength


def claim(name: str, verdict: str, runs: str = "fig5, seeds 1-30", first: str = "") -> Claim:
    """A claim with a verdict."""
    return Claim(name, "It does", "V", "x <= 1", "x = 1", verdict, runs, first)


STRENGTH = Strength(
    settings=10000,
    seeds={"section-v": 1000, "first": 30},
    claims={
        "C1": ClaimStrength(Share(5000, 10000), {"section-v": Share(990, 1000)}, (("Psi_1", 0.2),)),
        "C2": ClaimStrength(Share(499, 10000)),
        "C3a": ClaimStrength(Share(1, 10000)),
        "C4": ClaimStrength(Share(0, 10000), {"first": Share(15, 30)}),
        "C5": ClaimStrength(None),
        "C7": ClaimStrength(Share(5000, 10000)),
        "C7 clearly": ClaimStrength(Share(400, 10000)),
    },
    effects={"section-v": {"fig6/fig5 e_contact": Effect(1.08, 1.01, 1.13, Share(650, 1000))}},
    calibrations={name: calibration.numbers for name, calibration in CALIBRATIONS.items()},
)


@pytest.mark.parametrize(
    ("asked", "expected"),
    [
        (claim("C1", HOLDS), "holds"),
        (claim("C2", HOLDS), "holds at the calibration only"),
        (claim("C3a", NOT_REPRODUCED), "fails here, holds elsewhere"),
        (claim("C4", NOT_REPRODUCED), "holds nowhere in the space searched"),
        (claim("C5", HOLDS), "holds here"),
        (claim("C7", HOLDS), "holds at the calibration only"),  # clearly larger in 4 % of the space
        (claim("C6", NOT_REPRODUCED), "fails here"),
        (claim("C15", HOLDS, NO_RUNS), "holds"),
    ],
)
def test_words(asked: Claim, expected: str) -> None:
    assert word(asked, STRENGTH) == expected


def test_every_link_of_the_table_leads_to_a_heading() -> None:
    claims = [claim("C1", HOLDS, first=HOLDS), claim("C2", HOLDS), claim("C4", NOT_REPRODUCED, first=NOT_REPRODUCED)]
    text = as_markdown(claims, {"fig5": "abc"}, STRENGTH)
    titles = [line[3:].lower() for line in text.splitlines() if line.startswith("## ")]
    headings = {re.sub(r"[^\w -]", "", title).replace(" ", "-") for title in titles}
    links = re.findall(r"\]\(#([^)]*)\)", text)
    assert len(links) == 3
    assert set(links) <= headings
    assert "2 of 3 claims hold at the calibration." in text
    assert "99.0 % (98.2 to 99.5) | 50.0 % (49.0 to 51.0) | Psi_1 20% |" in text
    assert "| C4 | not reproduced | not reproduced | 50.0 % (33.2 to 66.8) |" in text


def test_seeds_at_other_values_of_a_calibration_are_left_out() -> None:
    stale = replace(STRENGTH, calibrations={**STRENGTH.calibrations, "section-v": {"depth": 1.0}})
    text = as_markdown([claim("C1", HOLDS), claim("C7", HOLDS)], {}, stale)
    assert "The kept shares of the seeds at `section-v` were measured with other values" in text
    assert "99.0 %" not in text
    assert "Over 1000 seeds" not in text
    assert "Single seeds" not in text
    assert "50.0 % (49.0 to 51.0) | Psi_1 20% |" in text
    assert "were measured with other values" not in as_markdown([claim("C1", HOLDS)], {}, STRENGTH)
    (record,) = as_records([claim("C1", HOLDS)], {}, stale)
    assert record["seeds"] == {}


def test_shares_near_the_least_one_have_two_digits() -> None:
    text = as_markdown([claim("C2", HOLDS)], {}, STRENGTH)
    assert "4.99 % (4.58 to 5.43)" in text


def test_words_of_claims_that_compare_figures_count_what_is_clearly_larger() -> None:
    text = as_markdown([claim("C7", HOLDS)], {}, STRENGTH)
    assert "too, at 4.0 % (3.6 to 4.4) of 10000 settings. The word counts these." in text


def test_records_carry_the_strength() -> None:
    (record,) = as_records([claim("C4", NOT_REPRODUCED)], {"fig5": "abc", "fig6": "def"}, STRENGTH)
    assert record["strength"] == "holds nowhere in the space searched"
    assert record["space"] == {"yes": 0, "n": 10000}
    assert record["scenarios"] == {"fig5": "abc"}


def test_a_claim_that_compares_figures_has_its_effect() -> None:
    text = as_markdown([claim("C7", HOLDS), claim("C8", HOLDS)], {}, STRENGTH)
    line = "- Over 1000 seeds, fig6/fig5 of |e| in contact: median 1.080 (1.010 to 1.130), above 1 at 65.0 %"
    assert text.count(line) == 1
    assert text.index(line) < text.index("## C8")


def test_a_bar_in_a_sentence_does_not_end_its_cell() -> None:
    text = as_markdown([replace(claim("C1", HOLDS), claim="|e| is small")], {}, STRENGTH)
    row = next(line for line in text.splitlines() if line.startswith("| [C1]"))
    assert r"| \|e\| is small |" in row
    assert len(re.findall(r"(?<!\\)\|", row)) == 7


def test_a_record_names_no_scenario_whose_name_begins_that_of_another() -> None:
    runs = "sensor-spike-craig, sensor-stuck-craig, seeds 1-3"
    digests = {"sensor-spike": "a", "sensor-spike-craig": "b", "sensor-stuck-craig": "c"}
    (record,) = as_records([claim("C19b", NOT_REPRODUCED, runs)], digests, STRENGTH)
    assert record["scenarios"] == {"sensor-spike-craig": "b", "sensor-stuck-craig": "c"}
