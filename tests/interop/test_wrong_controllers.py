"""Tests that `check` finds a mistake in a controller, and that the mistake cannot spoil a run of Fig. 5 in silence.

A controller that ends the process, or never returns, is not run here: a master calls FMUs in its own process,
dies or waits with them, and nothing can be asserted afterwards. One such run is made in a process of its own;
this is what `check`, whose workers may die, is for. Where a mistake is in what a plain run never uses (states,
reset), the run must be the right one, bitwise; where the numbers alone are wrong, only the loop can tell.
"""

import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from orchestration import Options, Result, SimulationError, System, prepare, simulate
from orchestration.check import Severity
from orchestration.paper.closed_loop import LOST, paper_loop
from tests.interop.foreign.builders import MAPPING, hand_written, without_compiler
from tests.interop.foreign.wrong import WRONG, Outcome
from tests.unit.orchestration.checked import PATIENT, check, hasty

STOP = 0.1  # s, 5000 steps in free motion
TIP = [f"{name}[{i}]" for name in ("plant.x", "trajectory.x_v", "controller.tau_cmd") for i in (1, 2)]

pytestmark = pytest.mark.skipif(bool(without_compiler()), reason=str(without_compiler()))
RUNNABLE = [name for name, wrong in WRONG.items() if wrong.run is not Outcome.DEAD]


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The FMU of each mistake."""
    return {
        name: hand_written(tmp_path_factory.mktemp("wrong"), wrong.source, wrong.description)
        for name, wrong in WRONG.items()
    }


def run(fig5: System, controller: Path) -> Result:
    """The beginning of Fig. 5."""
    system = fig5.replace("controller", controller, MAPPING)
    return simulate(system, stop_time=STOP, options=Options(strict=True, record=TIP))


def test_there_are_ten_at_least() -> None:
    assert len(WRONG) >= 10


@pytest.mark.parametrize("name", list(WRONG))
def test_check_names_the_mistake_first(files: dict[str, Path], name: str) -> None:
    rule, severity, message = WRONG[name].found
    patience = hasty() if "does not return" in message else PATIENT
    report = check(files[name], "controller", mapping=MAPPING, loop=paper_loop, timeout=patience)
    first = report.findings[0]
    assert (first.rule, first.severity) == (rule, severity)
    assert re.search(message, first.message), first.message
    assert report.failed == (severity == Severity.ERROR)


@pytest.mark.parametrize("name", RUNNABLE)
def test_a_run_says_so_or_is_right(files: dict[str, Path], fig5: System, right: Path, name: str) -> None:
    expected = WRONG[name].run
    if expected is Outcome.SAME:
        np.testing.assert_array_equal(run(fig5, files[name]).rows, run(fig5, right).rows)
    elif expected is Outcome.LOST:
        result = run(fig5, files[name])
        assert np.linalg.norm(result["plant.x"] - result["trajectory.x_v"], axis=1).max() > LOST
    else:
        assert not isinstance(expected, Outcome)
        kind, message = expected
        with pytest.raises(kind, match=message) as caught:
            run(fig5, files[name])
        assert type(caught.value) is kind


def test_the_sign_of_the_force_shows_at_the_wall_only(fig5: System, right: Path, tmp_path: Path) -> None:
    """In Fig. 5 the blow is nearly twice as hard, 860 N for 478 N, and the run goes on."""
    path = hand_written(tmp_path, WRONG["the sign of the force"].source)
    options = Options(strict=True, record=["plant.F_ext[1]"])
    wrong, usual = (
        np.abs(simulate(fig5.replace("controller", fmu, MAPPING), options=options)["plant.F_ext[1]"]).max()
        for fmu in (path, right)
    )
    assert wrong > 1.5 * usual > 600  # N


def test_a_crash_takes_the_master_with_it(files: dict[str, Path]) -> None:
    """In a process of its own: it dies of the signal that `check` named, without a result."""
    names = [option for ours, theirs in MAPPING.items() for option in ("--map", f"{ours}={theirs}")]
    entry = [sys.executable, "-c", "from orchestration.cli import main; main()"]
    command = [*entry, "run", "fig5", "--stop", "0.001", "--no-verdict"]
    path = str(files["a file that is not there"])
    ended = subprocess.run([*command, "--controller", path, *names], capture_output=True, text=True, check=False)
    assert -ended.returncode in (signal.SIGSEGV, signal.SIGBUS), ended.stderr


@pytest.mark.parametrize("name", ["a restored state forgets the time", None])
def test_a_clock_that_is_not_restored_shows_when_a_run_goes_back(
    files: dict[str, Path], fig5: System, right: Path, name: str | None
) -> None:
    """A plain run is right; one that a snapshot takes back fails in the first step, with both times."""
    system = fig5.replace("controller", files[name] if name else right, MAPPING)
    with prepare(system, stop_time=2e-3, options=Options(strict=True, record=TIP)) as simulation:
        simulation.run(until=1e-3)
        snapshot = simulation.save()
        simulation.run()
        rows = simulation.result().rows.copy()
        simulation.restore(snapshot)
        if name is None:
            simulation.run()
            np.testing.assert_array_equal(simulation.result().rows, rows)
            return
        said = r"controller: fmi2DoStep returned fmi2Error at t = 0.001 s \(step 50\); .* but this unit is at 0.002"
        with pytest.raises(SimulationError, match=said) as caught:
            simulation.run()
        assert caught.value.result is not None
        np.testing.assert_array_equal(caught.value.result.rows, rows[:51])
