"""What FMUs are told of an experiment, and what a single FMU suggests."""

from pathlib import Path

import pytest

from orchestration import Fmu, Options, Result, System, SystemDescriptionError, simulate
from tests.faults.cli import Command, runner
from tests.strangers.conftest import Stranger
from tests.strangers.fmus import Y

OUTPUTS = '<Unknown index="1" dependencies=""/><Unknown index="2" dependencies=""/>'
STOP = Y.replace('"y" valueReference="1"', '"stop" valueReference="3"')
SUGGESTED = '<DefaultExperiment startTime="1" stopTime="1.5" tolerance="1e-5" stepSize="0.1"/>'


def told(stranger: Stranger, before: str = "") -> Path:
    """An FMU that shows the tolerance as y and the stop time as stop, -1 for what it is not told."""
    return stranger("experiment", [Y, STOP], outputs=OUTPUTS, before=before)


@pytest.mark.parametrize(
    ("suggested", "options", "expected"),
    [
        ("", Options(), (-1.0, 0.5)),
        (SUGGESTED, Options(), (1e-5, 0.5)),
        (SUGGESTED, Options(fmu_tolerance=1e-3), (1e-3, 0.5)),
        ("", Options(fmu_tolerance=1e-3, fmu_stop_time=False), (1e-3, -1.0)),
    ],
)
@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
def test_a_run_tells_it(
    stranger: Stranger, suggested: str, options: Options, expected: tuple[float, float], algorithm: str
) -> None:
    result = simulate(System.of({"m": told(stranger, suggested)}), 0.5, 0.1, algorithm, options=options)
    assert (result["m.y"][0], result["m.stop"][0]) == expected


def test_rounding_does_not_bring_a_step_behind_the_stop_time(stranger: Stranger) -> None:
    """With steps of 0.1 s from 0 s, the last one of three begins at 0.2 s, and 0.2 + 0.1 > 0.3 as doubles are."""
    result = simulate(System.of({"m": told(stranger)}), 0.3, 0.1)
    assert result["m.stop"][-1] >= result.time[-2] + 0.1


def test_one_fmu_is_told(stranger: Stranger) -> None:
    path = told(stranger, SUGGESTED)
    with Fmu(path) as fmu:
        assert (float(fmu.outputs()["y"]), float(fmu.outputs()["stop"])) == (1e-5, -1.0)
    with Fmu(path, stop_time=2.0, tolerance=1e-3) as fmu:
        assert (float(fmu.outputs()["y"]), float(fmu.outputs()["stop"])) == (1e-3, 2.0)


@pytest.mark.parametrize("wrong", [0.0, -1e-3, float("nan")])
def test_a_tolerance_is_positive(wrong: float) -> None:
    with pytest.raises(SystemDescriptionError, match="fmu_tolerance is"):
        Options(fmu_tolerance=wrong)


def test_a_single_fmu_suggests_its_run(
    stranger: Stranger, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    adaptimp: Command = runner(monkeypatch, capsys)
    path, out = told(stranger, SUGGESTED), tmp_path / "x.csv"
    assert adaptimp("run", path, "--no-verdict", "-o", out).code == 0
    result = Result.read(out)
    assert (result.time[0], round(float(result.time[-1]), 9), len(result.time)) == (1.0, 1.5, 6)
    assert (result["stranger.y"][0], round(float(result["stranger.stop"][0]), 9)) == (1e-5, 1.5)
    more = ("--start", "0", "--stop", "1", "--step", "0.5", "--fmu-tolerance", "1e-3", "--no-fmu-stop-time")
    assert adaptimp("run", path, "--no-verdict", "-o", out, *more).code == 0
    result = Result.read(out)
    assert result.time.tolist() == [0.0, 0.5, 1.0]
    assert (result["stranger.y"][0], result["stranger.stop"][0]) == (1e-3, -1.0)


def test_a_single_fmu_without_one_asks_for_it(
    stranger: Stranger, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    adaptimp: Command = runner(monkeypatch, capsys)
    assert "has no communication step; give one" in adaptimp("run", told(stranger)).err
