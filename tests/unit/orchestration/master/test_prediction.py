"""Evidence that a result tells whether its run was stable, in the words of the command line, and only when asked."""

import pickle
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from orchestration import Result, StabilityWarning, System, SystemDescriptionError, prepare, scenario, simulate
from orchestration.analysis.stability import verdict
from orchestration.results.prediction import VERDICT, Prediction

LATE = 7e-3  # s; jacobi is unstable there


@pytest.fixture
def late() -> System:
    """A loop that jacobi makes unstable."""
    return scenario("fig2").with_sample_time(LATE)


@pytest.fixture
def unasked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of systems that were judged."""
    asked: list[str] = []
    plain = verdict.is_stable

    def counted(system: System, *given: object, **named: object) -> bool:
        asked.append(system.name)
        return plain(system, *given, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(verdict, "is_stable", counted)
    return asked


def test_a_run_whose_period_is_a_second_says_so_when_asked() -> None:
    """The run completes although the tip ends metres off."""
    result = simulate(scenario("fig2").with_sample_time(1.0))
    assert result.status == "complete"
    assert np.abs(result["controller.e"]).max() > 1.0  # m
    assert "unstable" not in repr(result)
    assert result.verdict is not None
    assert result.verdict.stable is False
    assert "UNSTABLE" in str(result.verdict)
    assert repr(result).endswith("unstable>")


def test_nobody_who_does_not_ask_waits_for_it(late: System, unasked: list[str]) -> None:
    result = simulate(late, stop_time=10 * LATE, algorithm="jacobi")
    without: Result = replace(result, judge=None)  # pyright: ignore[reportArgumentType]
    assert result == without
    assert len(repr(result)) > 0
    assert len(result.to_pandas()) == len(result.time)
    assert unasked == []
    assert VERDICT not in result.metadata
    assert result.verdict is result.verdict
    assert unasked == ["fig2"]


def test_asked_before_the_run_it_warns_and_is_kept(late: System, tmp_path: Path) -> None:
    with pytest.warns(StabilityWarning) as caught:
        result = simulate(late, stop_time=10 * LATE, algorithm="jacobi", verdict=True)
    assert [w.filename for w in caught] == [__file__]
    later = simulate(late, stop_time=10 * LATE, algorithm="jacobi")
    assert str(caught[0].message) == str(result.verdict) == str(later.verdict)
    result.write(tmp_path / "x.parquet")
    again = Result.read(tmp_path / "x.parquet")
    assert again == result
    assert again.verdict == result.verdict
    assert repr(again) == repr(result)


def test_a_stable_run_is_called_stable(late: System) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = simulate(late, stop_time=10 * LATE, verdict=True)
    assert result.verdict == Prediction(True, "fig2: gauss-seidel with a step of 0.007 s is stable at the start.")
    assert repr(result).endswith("stable>")


def test_words_are_those_of_the_command_and_are_in_its_file(
    late: System, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from orchestration.cli.app import app

    late.write(tmp_path / "late.ssp")
    words = [str(tmp_path / "late.ssp"), "--algorithm", "jacobi", "--stop", "0.07", "-o", str(tmp_path / "x.parquet")]
    app(["run", *words], standalone_mode=False)
    found = Result.read(tmp_path / "x.parquet").verdict
    assert found is not None
    assert f"Warning: {found}" in capsys.readouterr().err
    assert found == simulate(late, stop_time=0.07, algorithm="jacobi").verdict


def test_numbers_from_elsewhere_have_no_verdict(late: System, tmp_path: Path) -> None:
    simulate(late, stop_time=2 * LATE).write(tmp_path / "x.parquet")
    assert Result.read(tmp_path / "x.parquet").verdict is None
    assert Result(np.array([0.0]), ("a.x",), np.array([[1.0]])).verdict is None


@pytest.mark.parametrize("text", ["it went well", "3", '{"stable": true}'])
def test_words_of_somebody_else_are_no_verdict(text: str) -> None:
    result = Result(np.array([0.0]), ("a.x",), np.array([[1.0]]), metadata={VERDICT: text})
    assert result.verdict == Prediction(None, text)
    assert repr(result).endswith("no verdict on stability>")


def test_a_result_that_was_sent_elsewhere_can_be_judged(late: System) -> None:
    result = pickle.loads(pickle.dumps(simulate(late, stop_time=2 * LATE, algorithm="jacobi")))  # noqa: S301 - our own
    assert result.verdict is not None
    assert result.verdict.stable is False


def test_a_run_of_the_context_has_the_verdict_of_simulate(late: System) -> None:
    with prepare(late, stop_time=2 * LATE, algorithm="jacobi") as run:
        run.run()
        result = run.result()
    assert result.verdict == simulate(late, stop_time=2 * LATE, algorithm="jacobi").verdict


def test_what_cannot_be_judged_has_no_verdict_but_a_reason(late: System, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("orchestration.analysis.stability.prediction.MOST_JUDGED", 3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = simulate(late, stop_time=2 * LATE, verdict=True)
    assert result.verdict is not None
    assert result.verdict.stable is None
    assert str(result.verdict).startswith("no verdict on stability: it would take long with 20 connections")
    assert repr(result).endswith("no verdict on stability>")


@pytest.mark.parametrize("wrong", ["no", 1, None])
def test_a_wish_that_is_neither_true_nor_false_is_refused(late: System, unasked: list[str], wrong: Any) -> None:
    with pytest.raises(SystemDescriptionError, match=rf"^verdict is {wrong!r}; give True to predict the stability"):
        simulate(late, stop_time=2 * LATE, verdict=wrong)
    assert unasked == []


def test_a_result_with_a_prediction_differs_by_its_metadata(late: System) -> None:
    without = simulate(late, stop_time=2 * LATE)
    result = simulate(late, stop_time=2 * LATE, verdict=np.True_)  # pyright: ignore[reportArgumentType]
    assert result != without
    assert set(result.metadata) - set(without.metadata) == {VERDICT}
    assert all(np.array_equal(result[name], without[name]) for name in without)
