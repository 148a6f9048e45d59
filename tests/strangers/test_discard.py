"""fmi2Discard of a step: the end of the simulation, a shorter step, or a failure that says what to do."""

from pathlib import Path

import numpy as np
import pytest

from orchestration import Result, SimulationError, System, prepare, simulate, stream
from orchestration.master.kernel.step_control import SMALLEST_FACTOR
from orchestration.master.step_arrays import SMALLEST_SHARE
from tests.faults.cli import Command, runner
from tests.strangers.conftest import Stranger
from tests.strangers.fmus import Y

ALONE = '<Unknown index="1" dependencies=""/>'
ANY_STEP = 'canHandleVariableCommunicationStepSize="true" canGetAndSetFMUstate="true"'
SENTENCE = "m ends the simulation at t = 0.5 s (step 5)."


@pytest.fixture
def ending(stranger: Stranger) -> System:
    """A component that ends the simulation at 0.5 s; y = t."""
    return System.of({"m": stranger("ends", [Y], outputs=ALONE, flags=ANY_STEP)})


@pytest.fixture
def adaptimp(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """The command line."""
    return runner(monkeypatch, capsys)


def test_the_end_is_an_end(ending: System) -> None:
    result = simulate(ending, 1.0, 0.1)
    assert (result.status, result.message) == ("ended", SENTENCE)
    np.testing.assert_allclose(result.time, np.linspace(0, 0.5, 6))
    np.testing.assert_allclose(result["m.y"], result.time)


@pytest.mark.parametrize("algorithm", ["jacobi", "iterative", "newton"])
def test_it_is_an_end_for_other_algorithms(ending: System, algorithm: str) -> None:
    assert simulate(ending, 1.0, 0.1, algorithm).status == "ended"


def test_step_control_goes_to_the_end_but_for_its_smallest_step(ending: System) -> None:
    result = simulate(ending, 1.0, 0.1, "adaptive")
    assert result.status == "ended"
    largest_refused = SMALLEST_SHARE * 0.1 / SMALLEST_FACTOR  # the next one would be smaller than the smallest
    assert 0.5 - largest_refused <= result.time[-1] <= 0.5 + 1e-9
    np.testing.assert_allclose(result["m.y"], result.time)


def test_a_run_that_has_ended_stays_so_until_it_is_taken_back(stranger: Stranger) -> None:
    path = stranger("ends", [Y], outputs=ALONE, flags=f'{ANY_STEP} canSerializeFMUstate="true"')
    with prepare(System.of({"m": path}), 1.0, 0.1) as run:
        run.run(until=0.2)
        snapshot = run.save()
        run.run()
        run.run()
        assert (run.result().status, run.time) == ("ended", 0.5)
        run.restore(snapshot)
        assert run.result().status == "complete"
        run.run()
        assert run.result().status == "ended"


def test_files_keep_that_it_has_ended(ending: System, tmp_path: Path) -> None:
    assert stream(tmp_path / "x.parquet", ending, 1.0, 0.1) == 6
    read = Result.read(tmp_path / "x.parquet")
    assert (read.status, read.message) == ("ended", SENTENCE)


def test_the_command_line_says_so(ending: System, adaptimp: Command, tmp_path: Path) -> None:
    package = ending.write(tmp_path / "s.ssp")
    outcome = adaptimp("run", package, "--step", "0.1", "--stop", "1", "--no-verdict")
    assert (outcome.code, outcome.err) == (0, f"Notice: {SENTENCE}\n")


def test_a_step_is_made_shorter_under_step_control(stranger: Stranger) -> None:
    """The FMU takes steps of at most 0.05 s."""
    path = stranger("short", [Y], outputs=ALONE, flags=ANY_STEP)
    result = simulate(System.of({"m": path}), 1.0, 0.1, "adaptive")
    assert result.status == "complete"
    np.testing.assert_allclose(result["m.y"][-1], 1.0)
    assert np.diff(result.time).max() <= 0.1
    assert int(result.metadata["steps_rejected"]) > 0


@pytest.mark.parametrize(
    ("kind", "reached"), [("short", r"It has come to t = 0\.05 s; use smaller steps, or algorithm adaptive")]
)
def test_another_discard_says_how_far_it_came(stranger: Stranger, kind: str, reached: str) -> None:
    path = stranger(kind, [Y], outputs=ALONE)
    with pytest.raises(SimulationError, match=rf"fmi2DoStep returned fmi2Discard at t = 0 s .*{reached}") as failed:
        simulate(System.of({"m": path}), 1.0, 0.1)
    assert failed.value.result is not None
    assert len(failed.value.result.time) == 1


def test_a_stop_that_is_no_end_is_a_failure_under_step_control_too(stranger: Stranger) -> None:
    path = stranger("stops", [Y], outputs=ALONE, flags=ANY_STEP)
    with pytest.raises(SimulationError, match=r"returned fmi2Discard .*; steps below the smallest, 1e-07 s, would be"):
        simulate(System.of({"m": path}), 1.0, 0.1, "adaptive")


def test_a_stop_that_is_no_end_is_a_failure(stranger: Stranger) -> None:
    path = stranger("stops", [Y], outputs=ALONE)
    with pytest.raises(
        SimulationError, match=r"fmi2Discard at t = 0\.5 s .*the end is reached.*It has come to t = 0\.5 s"
    ):
        simulate(System.of({"m": path}), 1.0, 0.1)
