"""NaN in an output: an error, or kept if allowed; where values are compared it is refused in any case."""

from pathlib import Path

import numpy as np
import pytest

from orchestration import (
    InitializationError,
    Options,
    OrchestrationError,
    Result,
    SimulationError,
    System,
    compare,
    simulate,
    stream,
)
from tests.faults.cli import Command, runner
from tests.strangers.conftest import Stranger
from tests.strangers.fmus import U, Y

ALONE, DEPENDS = '<Unknown index="1" dependencies=""/>', '<Unknown index="2" dependencies="1"/>'
STATES = 'canHandleVariableCommunicationStepSize="true" canGetAndSetFMUstate="true"'
KEEP = Options(allow_nan=True)


@pytest.fixture
def system(stranger: Stranger) -> System:
    """A component that shows the time until 0.35 s and NaN from then on, and one that shows its input tenfold."""
    source = stranger("nan", [Y], outputs=ALONE, flags=STATES, name="source")
    tenfold = stranger("feedthrough", [U, Y], outputs=DEPENDS, flags=STATES, name="tenfold")
    return System.of({"m": source, "n": tenfold}).connect("m.y -> n.u")


@pytest.mark.parametrize("algorithm", ["gauss-seidel", "jacobi"])
def test_it_ends_a_run_unless_it_is_allowed(system: System, algorithm: str) -> None:
    with pytest.raises(SimulationError, match=r"^m\.y is nan at t = 0\.4 s \(row 4\)") as failed:
        simulate(system, 0.6, 0.1, algorithm)
    assert isinstance(failed.value.result, Result)
    assert len(failed.value.result.time) == 4
    kept = simulate(system, 0.6, 0.1, algorithm, options=KEEP)
    assert (kept.status, len(kept.time)) == ("complete", 7)
    assert np.isnan(kept["m.y"]).tolist() == [False] * 4 + [True] * 3
    np.testing.assert_array_equal(kept["m.y"][:4], failed.value.result["m.y"])
    late = 1 if algorithm == "jacobi" else 0
    assert np.isnan(kept["n.y"]).tolist() == [False] * (4 + late) + [True] * (3 - late)


@pytest.mark.parametrize("algorithm", ["iterative", "newton", "adaptive"])
def test_what_compares_values_names_it(system: System, algorithm: str) -> None:
    for options in (Options(), KEEP):
        with pytest.raises(
            SimulationError, match=r"m\.y = nan.* at t = 0\.3.*: iterations and step control need finite"
        ):
            simulate(system, 0.6, 0.1, algorithm, options=options)


def test_a_verdict_refuses_it(system: System) -> None:
    assert system.stability(0.1, at=0.2)
    with pytest.raises(OrchestrationError, match=r"m\.y = nan at t = 0\.5 s: a verdict on stability needs finite"):
        system.stability(0.1, at=0.5)


def test_it_may_be_there_from_the_start(system: System) -> None:
    with pytest.raises(InitializationError, match=r"m\.y is nan at t = 1 s \(row 0\); start values are wrong"):
        simulate(system, 1.2, 0.1, options=Options(start_time=1.0))
    kept = simulate(system, 1.2, 0.1, options=Options(start_time=1.0, allow_nan=True))
    assert np.isnan(kept["m.y"]).tolist() == [True] * 3


def test_files_and_comparisons_keep_it(system: System, tmp_path: Path) -> None:
    result = simulate(system, 0.6, 0.1, options=KEEP)
    for name in ("x.csv", "x.parquet"):
        result.write(tmp_path / name)
        assert compare(result, Result.read(tmp_path / name)).identical
    assert stream(tmp_path / "y.parquet", system, 0.6, 0.1, options=KEEP) == 7
    assert (tmp_path / "y.parquet").read_bytes() == (tmp_path / "x.parquet").read_bytes()


def test_the_command_line_has_the_option(
    system: System, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    adaptimp: Command = runner(monkeypatch, capsys)
    package = system.write(tmp_path / "s.ssp")
    asked = ("run", package, "--step", "0.1", "--stop", "0.6", "--no-verdict")
    refused = adaptimp(*asked)
    assert refused.code == 1
    assert "Error: m.y is nan at t = 0.4 s (row 4)" in refused.err
    assert "--allow-nan" in refused.err
    assert adaptimp(*asked, "--allow-nan").code == 0
    assert adaptimp(*asked, "--allow-nan", "--json").code == 0


def test_the_option_is_a_truth_value() -> None:
    with pytest.raises(OrchestrationError, match="allow_nan is 'keep'"):
        Options(allow_nan="keep")  # type: ignore[arg-type]
