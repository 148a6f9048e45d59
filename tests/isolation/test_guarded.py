"""What an FMU that is not isolated changes in the process is put back and said, and its exit is no success."""

import locale
import os
import signal
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from orchestration import Fmu, ProcessChangedWarning, System, prepare, simulate
from orchestration.master.simulation import Simulation
from orchestration.sandbox.guard import EXIT_CODE
from tests.isolation.conftest import Unruly

CHANGES = {
    "folder": "the working directory to /",
    "locale": "the locale",
    "rounding": "the rounding mode",
    "flush": r"the treatment of tiny numbers \(flush to zero\)",
    "signals": r"the handlers of signals \(SIGINT, SIGTERM\)",
}


def state() -> tuple[object, ...]:
    """What the FMUs here change."""
    numbers = np.add(1.0, 2.0**-53), np.multiply(np.float64(5e-324), 1.0)
    return os.getcwd(), locale.setlocale(locale.LC_ALL), signal.getsignal(signal.SIGINT), *numbers


@pytest.mark.parametrize("deed", CHANGES)
@pytest.mark.parametrize("place", ["instantiate", "step", "terminate"])
def test_changes_are_put_back_and_said_once(unruly: Unruly, place: str, deed: str) -> None:
    before = state()
    with pytest.warns(ProcessChangedWarning, match=f"^m changed {CHANGES[deed]}.* put back") as said:
        simulate(unruly(f"{place} {deed}"), 1.0, 0.1)
    assert [warning.filename for warning in said] == [__file__]
    assert state() == before


def test_a_library_that_is_loaded_with_fast_mathematics_changes_no_other_run(unruly: Unruly) -> None:
    with pytest.warns(ProcessChangedWarning, match="^m changed the treatment of tiny .* while it was loaded"):
        simulate(unruly("load flush"), 1.0, 0.1)
    assert np.multiply(np.float64(5e-324), 1.0) == 5e-324


def test_the_candidates_are_named(unruly_file: Callable[[str], Path]) -> None:
    system = System.of({"a": unruly_file("step none"), "b": unruly_file("step rounding")})
    with pytest.warns(ProcessChangedWarning, match="^One of the components a, b changed the rounding mode in a step"):
        simulate(system, 1.0, 0.1)
    with pytest.warns(ProcessChangedWarning, match="^b changed the rounding mode in a step after t = 0 s"):
        simulate(system, 1.0, 0.1, isolate=["a"])


def test_a_calm_fmu_is_not_blamed(unruly: Unruly) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        simulate(unruly("step none"), 1.0, 0.1)


@pytest.mark.parametrize(
    ("deed", "when"),
    [
        ("load exit", "while it was loaded and instantiated"),
        ("instantiate exit", "while it was loaded and instantiated"),
        ("step exit", "in a step after t = 0 s"),
        ("terminate exit", "while it was terminated"),
    ],
)
def test_an_exit_is_no_success(unruly_file: Callable[[str], Path], tmp_path: Path, deed: str, when: str) -> None:
    script = tmp_path / "run.py"
    system = f"System.of({{'m': {str(unruly_file(deed))!r}}})"
    script.write_text(f"from orchestration import System, simulate\nsimulate({system}, 1.0, 0.1)\nprint('done')\n")
    ended = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout) == (EXIT_CODE, "")
    assert ended.stderr.startswith(f"Error: m ended the process {when}, as if the program were at its end.")


def test_the_exit_of_a_program_within_a_run_is_its_own(unruly_file: Callable[[str], Path], tmp_path: Path) -> None:
    script = tmp_path / "run.py"
    system = f"System.of({{'m': {str(unruly_file('step none'))!r}}})"
    script.write_text(
        "import sys\nfrom orchestration import System, prepare\n"
        f"with prepare({system}, 1.0, 0.1) as run:\n    run.run(until=0.2)\n    sys.exit(7)\n"
    )
    ended = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr) == (7, "")


def test_an_exit_while_the_stability_is_judged_is_no_success(
    unruly_file: Callable[[str], Path], tmp_path: Path
) -> None:
    script = tmp_path / "judge.py"
    system = f"System.of({{'m': {str(unruly_file('step exit'))!r}}})"
    script.write_text(f"from orchestration import System\n{system}.stability(0.1, at=1.0)\nprint('done')\n")
    ended = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout) == (EXIT_CODE, "")
    assert ended.stderr.startswith("Error: m ended the process while its stability was judged, as if")


def test_changes_while_the_stability_is_judged_are_put_back_and_said_once(unruly: Unruly) -> None:
    before = state()
    with pytest.warns(ProcessChangedWarning, match="^m changed the working directory .* its stability was") as said:
        unruly("step folder").stability(0.1, at=1.0)
    assert len(said) == 1
    assert state() == before


def test_a_warning_that_is_an_error_leaves_nothing_behind(
    unruly: Unruly, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    system = unruly("terminate folder")
    with warnings.catch_warnings():
        warnings.simplefilter("error", ProcessChangedWarning)
        with pytest.raises(ProcessChangedWarning, match="while it was terminated"):
            simulate(system, 1.0, 0.1)
    assert list((tmp_path / "temporary").iterdir()) == []


def test_an_interrupt_at_the_end_leaves_nothing_behind(
    unruly: Unruly, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(_: Simulation) -> None:
        raise KeyboardInterrupt

    (tmp_path / "temporary").mkdir()
    (tmp_path / "rows").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    monkeypatch.setattr(Simulation, "complete", interrupted)
    run = prepare(unruly("step none"), 1.0, 0.1)
    run.stream_to(tmp_path / "rows" / "rows.parquet")
    with pytest.raises(KeyboardInterrupt), run:
        run.run()
    assert [*(tmp_path / "temporary").iterdir(), *(tmp_path / "rows").iterdir()] == []


def test_an_exit_leaves_no_folder_and_all_that_was_printed(unruly_file: Callable[[str], Path], tmp_path: Path) -> None:
    script, temporary = tmp_path / "run.py", tmp_path / "temporary"
    temporary.mkdir()
    system = f"System.of({{'m': {str(unruly_file('step exit'))!r}}})"
    script.write_text(f"from orchestration import System, simulate\nprint('begun')\nsimulate({system}, 1.0, 0.1)\n")
    command, environment = [sys.executable, str(script)], {**os.environ, "TMPDIR": str(temporary)}
    ended = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    assert (ended.returncode, ended.stdout) == (EXIT_CODE, "begun\n")
    assert list(temporary.iterdir()) == []


@pytest.mark.parametrize(
    ("deed", "calls", "when"),
    [
        ("instantiate exit", "", "while it was opened"),
        ("step exit", "fmu.drive([k / 10 for k in range(11)])", "in fmi2DoStep"),
        ("step exit", "[fmu.step(0.1) for _ in range(10)]", "in fmi2DoStep"),
        ("terminate exit", "fmu.close()", "in fmi2Terminate"),
    ],
)
def test_the_exit_of_a_single_fmu_is_no_success(
    unruly_file: Callable[[str], Path], tmp_path: Path, deed: str, calls: str, when: str
) -> None:
    script = tmp_path / "drive.py"
    opened = f"fmu = Fmu({str(unruly_file(deed))!r})"
    script.write_text(f"from orchestration import Fmu\n{opened}\n{calls}\nprint('done')\n")
    ended = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout) == (EXIT_CODE, "")
    assert f" ended the process {when}, as if the program were at its end." in ended.stderr
    assert "run it as a component of a System with isolate=True to keep it." in ended.stderr


def test_what_a_single_fmu_changes_is_put_back_and_said_once(unruly_file: Callable[[str], Path]) -> None:
    before = state()
    with Fmu(unruly_file("step folder")) as fmu:
        with pytest.warns(ProcessChangedWarning, match="changed the working directory .* in a step after t") as said:
            fmu.drive([k / 10 for k in range(11)])
        assert state() == before
    assert len(said) == 1
