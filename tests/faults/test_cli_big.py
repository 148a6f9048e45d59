"""Tests of what ``adaptimp run`` says of a system with very many components or connections."""

from dataclasses import replace
from pathlib import Path

import pytest

from orchestration.analysis.stability.verdict import is_stable
from tests.benchmarks.wide import STEP, Size, wide_fmu, wide_system
from tests.faults.cli import Command


def test_a_verdict_that_takes_long_is_left_out(adaptimp: Command, tmp_path: Path) -> None:
    system = wide_system(wide_fmu(tmp_path, 1), "star", Size(102, 1))
    outcome = adaptimp("run", system.write(tmp_path / "star.ssp"), "--stop", STEP, "--record", "c0.*", "-o", "x.csv")
    assert outcome.code == 0
    words = "Notice: no verdict on stability: it would take long with 101 connections; System.stability gives one."
    assert words in outcome.err
    assert "order c0 > c1 > c2 > c3 > c4 > c5 > c6 > c7 > c8 > c9 > ... > c101 (102 components), step" in outcome.out


def test_an_unstable_run_of_many_connections_is_told_without_a_search(
    adaptimp: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    system = wide_system(wide_fmu(tmp_path, 1), "ring", Size(70, 1))
    system = replace(system, connections=tuple(replace(c, factor=2.5) for c in system.connections))
    assert not is_stable(system)
    monkeypatch.setattr("orchestration.analysis.stability.verdict.stability", lambda *_: pytest.fail("is searched"))
    outcome = adaptimp("run", system.write(tmp_path / "ring.ssp"), "--stop", STEP, "-o", "x.csv")
    assert "Warning: ring: gauss-seidel with a step of 0.000976562 s is UNSTABLE at the start; " in outcome.err
