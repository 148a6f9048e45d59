"""Tests that every hostile archive is refused by its rule, whichever way it comes in, and that it leaves nothing."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from orchestration import ArchiveError, Fmu, System
from orchestration.check import Severity, check
from orchestration.sandbox.archive import screen
from tests.faults.cli import Command
from tests.strangers.hostile.archives import BASE, CASES, DAMAGED, WINDOWS, fmu
from tests.strangers.hostile.packages import package
from tests.strangers.hostile.zips import DEFLATED, Row, both, zipped

LONGEST = 300  # characters of a message, besides the folder of the file


def assert_said(message: object, path: Path, rule: str) -> None:
    """The message is a sentence that names the file and the rule."""
    text = str(message).replace(str(path), path.name)
    assert path.name in text
    assert re.search(rule, text), text
    assert len(text) <= LONGEST
    assert text.isprintable()
    assert text.endswith(".")


@pytest.fixture(params=CASES)
def hostile(request: pytest.FixtureRequest, tmp_path: Path, left_over: Callable[[], list[str]]) -> tuple[Path, str]:
    """A hostile FMU, and what must be said of it."""
    make, rule = CASES[request.param]
    path = tmp_path / "given" / "hostile.fmu"
    path.write_bytes(make())
    assert not left_over()
    return path, rule


def test_there_are_at_least_eighty() -> None:
    assert len(CASES) + len(DAMAGED) >= 80


def test_it_is_refused_whichever_way_it_comes_in(
    hostile: tuple[Path, str], adaptimp: Command, left_over: Callable[[], list[str]]
) -> None:
    path, rule = hostile
    for way in (Fmu, lambda p: System.of({"m": p})):
        with pytest.raises(ArchiveError) as refused:
            way(path)
        assert_said(refused.value, path, rule)
    (finding,) = [f for f in check(path).findings if f.severity == Severity.ERROR]
    assert finding.rule == "7"
    assert_said(finding.message, path, rule.replace("\\.", "."))
    for command in ("run", "info"):
        outcome = adaptimp(command, path)
        assert outcome.code == 2
        assert_said(outcome.sentence, path, rule)
    assert not left_over()


def test_it_is_refused_in_a_package(hostile: tuple[Path, str], adaptimp: Command, left_over) -> None:
    path, _ = hostile
    around = path.with_name("around.ssp")
    around.write_bytes(package({"m": path.read_bytes()}))
    with pytest.raises(ArchiveError) as refused:
        System.read(around)
    assert_said(refused.value, around, "resources/m.fmu")
    assert adaptimp("export", around, "-o", "out.fmu").code == 2
    assert not left_over()


@pytest.mark.parametrize("name", DAMAGED)
def test_damage_inside_is_one_sentence(name: str, tmp_path: Path, adaptimp: Command, left_over) -> None:
    row, rule = DAMAGED[name]
    path = tmp_path / "given" / "damaged.fmu"
    path.write_bytes(fmu(row))
    with pytest.raises(ArchiveError) as refused:
        Fmu(path)
    assert_said(refused.value, path, rule)
    outcome = adaptimp("run", path, "--step", 0.1, "--stop", 1)
    assert outcome.code == 2
    assert_said(outcome.sentence, path, rule)
    assert "damaged" in " ".join(f.message for f in check(path).findings)
    around = path.with_name("around.ssp")
    around.write_bytes(package({"m": path.read_bytes()}, entries=[Row("resources/more", **both(crc=1))]))
    with pytest.raises(ArchiveError, match=r"around\.ssp.* is damaged"):
        System.read(around)
    assert not left_over()


@pytest.mark.parametrize("on_windows", [True, False])
@pytest.mark.parametrize("name", WINDOWS)
def test_what_only_windows_cannot_unpack_is_refused_there_only(
    name: str, *, on_windows: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    make, rule = WINDOWS[name]
    path = tmp_path / "odd.fmu"
    path.write_bytes(make())
    monkeypatch.setattr("orchestration.sandbox.zip.names._ON_WINDOWS", on_windows)
    if on_windows:
        with pytest.raises(ArchiveError) as refused:
            screen(path)
        assert_said(refused.value, path, rule)
    else:
        (said,) = screen(path)
        assert re.fullmatch(rf"The archive cannot be unpacked on Windows: entry .* {rule}.*\.", said)


@pytest.mark.parametrize(
    "more",
    [
        {"around": {"before": b"#!/bin/sh\n"}},
        {"around": {"comment": b"a comment"}},
        {"around": {"after": b"\r\n"}},
        {"wide": {}},
    ],
    ids=str,
)
def test_what_is_odd_and_harmless_passes(more: dict, tmp_path: Path) -> None:
    """A stub before the archive whose offsets count it, a comment, a line end behind it, an end of 64 bits."""
    path = tmp_path / "odd.fmu"
    path.write_bytes(
        zipped([*BASE, Row("resources/a", b"a" * 999, DEFLATED), Row("resources/b.zip", b"PK\3\4")], **more)
    )
    assert System.of({"m": path})["m"].description.model_name == "Stranger"
