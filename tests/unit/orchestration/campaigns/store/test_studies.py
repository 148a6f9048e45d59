"""Tests that a study can be continued from its store alone."""

import json
import os
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from orchestration import System
from orchestration.campaigns.engines.task import Task
from orchestration.campaigns.store.store import Store
from orchestration.campaigns.store.studies import read_studies
from orchestration.errors import StoreError

RECORD = {"factors": {"plant.K_f": [1e4, 0.1 + 0.2]}, "stop_time": 2.0, "who": "Größe"}


def test_a_record_and_its_systems_come_back(fig2: System, tmp_path: Path) -> None:
    store = Store.open(tmp_path / "runs")
    identity = store.save_study(RECORD, {"arm": fig2})
    (found,) = Store.open(tmp_path / "runs", new=False).studies()
    assert (found.identity, found.record) == (identity, RECORD)
    before, after = (Task(system, (), (), 2.0) for system in (fig2, found.system("arm")))
    assert (after.structure, after.start_values) == (before.structure, before.start_values)


def test_a_store_can_be_moved(fig2: System, tmp_path: Path) -> None:
    Store.open(tmp_path / "runs").save_study(RECORD, {"arm": fig2})
    shutil.move(tmp_path / "runs", tmp_path / "elsewhere")
    (found,) = Store.open(tmp_path / "elsewhere").studies()
    assert found.system("arm").connections == fig2.connections


def test_the_same_study_is_kept_once_and_another_beside_it(fig2: System, tmp_path: Path) -> None:
    store = Store.open(tmp_path)
    first = store.save_study(RECORD, {"arm": fig2})
    assert store.save_study(RECORD, {"arm": fig2}) == first
    assert store.save_study(RECORD, {"arm": fig2.set({"plant.mu": 0.5})}) != first
    assert store.save_study({**RECORD, "stop_time": 1.0}, {"arm": fig2}) != first
    assert len(store.studies()) == 3
    assert len(list((tmp_path / "systems").iterdir())) == 2


def test_the_study_that_was_saved_last_comes_last(fig2: System, tmp_path: Path) -> None:
    store = Store.open(tmp_path)
    first, second = (store.save_study({"n": n}, {"arm": fig2}) for n in (1, 2))
    for identity, when in ((first, 2), (second, 1)):
        os.utime(tmp_path / "studies" / f"{identity}.json", (when, when))
    assert [study.identity for study in store.studies()] == [second, first]


def test_what_json_lacks_is_refused(fig2: System, tmp_path: Path) -> None:
    store = Store.open(tmp_path)
    for value in (float("nan"), fig2):
        with pytest.raises(StoreError, match=r"the record of the study cannot be written: .*; use numbers, texts"):
            store.save_study({"x": value}, {})
    assert store.studies() == ()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda _: "{", "cannot be read"),
        (lambda _: "[]", "cannot be read"),
        (lambda text: text.replace('"study"', '"stud"'), "cannot be read"),
        (lambda text: json.dumps({**json.loads(text), "format": 2}), "has format 2, but 1 is known"),
    ],
)
def test_a_damaged_record_is_named(tmp_path: Path, change: Callable[[str], str], message: str) -> None:
    store = Store.open(tmp_path)
    path = tmp_path / "studies" / f"{store.save_study(RECORD, {})}.json"
    path.write_text(change(path.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(StoreError, match=message) as caught:
        read_studies(tmp_path)
    assert path.name in str(caught.value)


def test_a_package_that_cannot_be_written_is_an_error_of_the_store(
    fig2: System, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = Store.open(tmp_path)

    def refuse(self: System, path: Path) -> Path:  # noqa: ARG001
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(System, "write", refuse)
    with pytest.raises(StoreError, match="cannot be written: No space left on device"):
        store.save_study(RECORD, {"arm": replace(fig2)})
    assert store.studies() == ()
