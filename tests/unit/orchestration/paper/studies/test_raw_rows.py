"""Rows of what was measured: found again by their content, resumed after an interrupt, with all their sentences."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from adaptimp_fmu.files.cache_contents import KINDS, Amount, amount, clear
from orchestration.campaigns.store.store import Store
from orchestration.paper.studies.raw_rows import CHUNK, Row, Survey, identity_of_files, kept_rows, kept_store, make_rows

SETTINGS = [{"x": float(i), "y": 0.1 * i} for i in range(3 * CHUNK)]


class Measured:
    """Measures a setting, fails at some, and is interrupted at one."""

    def __init__(self, interrupted: int = -1) -> None:
        self.interrupted = interrupted
        self.seeds: list[int] = []

    def __call__(self, setting: Mapping[str, float], seed: int) -> Row:
        """Measure a setting."""
        if seed - 1 == self.interrupted:
            raise KeyboardInterrupt
        self.seeds.append(seed)
        failures = {"fig6": f"It diverged at {seed}."} if seed % 5 == 0 else {}
        return Row({"sum": setting["x"] + setting["y"], **({} if failures else {"seed": seed})}, failures)


def survey(measure: Measured, identity: str = "code") -> Survey:
    return Survey(identity, {"sum": "m", "seed": ""}, measure)


def test_an_interrupted_survey_goes_on(tmp_path: Path) -> None:
    store, told = Store.open(tmp_path / "rows"), list[str]()
    broken = Measured(interrupted=CHUNK + 3)
    with pytest.raises(KeyboardInterrupt):
        make_rows(survey(broken), SETTINGS, store, 1, told.append)
    assert told == [f"{CHUNK} of {len(SETTINGS)} settings"]
    whole = Measured()
    rows = make_rows(survey(whole), SETTINGS, store, 2, told.append)
    assert sorted(whole.seeds) == list(range(CHUNK + 1, len(SETTINGS) + 1))
    assert told[-1] == f"{len(SETTINGS)} of {len(SETTINGS)} settings"
    for i, row in enumerate(rows):
        assert row.numbers["sum"] == SETTINGS[i]["x"] + SETTINGS[i]["y"]
        assert row.failures == ({"fig6": f"It diverged at {i + 1}."} if (i + 1) % 5 == 0 else {})
        assert np.isnan(row.numbers["seed"]) == bool(row.failures)
    again = Measured()
    assert [row.failures for row in make_rows(survey(again), SETTINGS[:7], store, 1, told.append)] == [
        row.failures for row in rows[:7]
    ]
    assert not again.seeds, "a longer survey serves a shorter one"
    kept = kept_rows(store, survey(again).study)
    assert [row.numbers["sum"] for row in kept] == [row.numbers["sum"] for row in rows]
    assert [row.failures for row in kept] == [row.failures for row in rows]


def test_other_code_measures_anew(tmp_path: Path) -> None:
    store = Store.open(tmp_path / "rows")
    make_rows(survey(Measured()), SETTINGS[:3], store, 1, lambda _: None)
    other = Measured()
    make_rows(survey(other, "other code"), SETTINGS[:3], store, 1, lambda _: None)
    assert other.seeds == [1, 2, 3]


def test_the_rows_end_where_one_is_missing(tmp_path: Path) -> None:
    store = Store.open(tmp_path / "rows")
    make_rows(survey(Measured()), SETTINGS[:2], store, 1, lambda _: None)
    moved = [{"x": -1.0, "y": 0.0}] * 3 + SETTINGS[3:5]
    make_rows(survey(Measured(), "moved"), moved, store, 1, lambda _: None)
    assert len(kept_rows(store, survey(Measured()).study)) == 2


def test_an_identity_tells_files_apart(tmp_path: Path) -> None:
    for name, content in (("a", "1"), ("b", "2")):
        (tmp_path / name).write_text(content, encoding="utf-8")
    one, two = tmp_path / "a", tmp_path / "b"
    cases = (([one], []), ([two], []), ([one], ["x"]), ([one, two], []))
    found = {identity_of_files(files, more) for files, more in cases}
    assert len(found) == 4
    assert identity_of_files([one], []) == identity_of_files([one], [])


def test_the_kept_store_is_not_removed_under_a_study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ADAPTIMP_CACHE", str(tmp_path))
    store = kept_store()
    assert store.folder == tmp_path / "robustness"
    assert amount(tmp_path, KINDS["robustness"]).files == 1
    assert clear(tmp_path, KINDS["robustness"]) == Amount(used=1)
