"""``adaptimp run --isolate``: a crash leaves the rows before it in the file, and an exit is no success without it."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from orchestration import Result
from orchestration.cli.isolation import EVERY, completed, isolation_of
from tests.faults.cli import Command

STEPS = ("--step", "0.1", "--stop", "1")


@pytest.mark.parametrize("names", [(), ("unruly",)])
def test_the_rows_before_a_crash_are_in_a_file(
    adaptimp: Command, unruly_file: Callable[[str], Path], tmp_path: Path, names: tuple[str, ...]
) -> None:
    file = unruly_file("step crash").rename(tmp_path / "unruly.fmu")
    done = adaptimp("run", file, "--no-verdict", "--isolate", *names, *STEPS, "-o", tmp_path / "rows.csv")
    assert done.code == 1
    assert done.sentence == "unruly: fmi2DoStep died of SIGSEGV at t = 0.5 s (step 5); it logged nothing."
    assert not (tmp_path / "rows.csv").exists()
    rows = Result.read(tmp_path / "rows.partial.csv")
    np.testing.assert_allclose(rows.time, np.linspace(0, 0.5, 6))


def test_the_verdict_is_isolated_too(adaptimp: Command, unruly_file: Callable[[str], Path]) -> None:
    done = adaptimp("run", unruly_file("instantiate exit"), "--isolate", *STEPS)
    assert done.code == 2
    assert "fmi2Instantiate ended its process with exit code 0" in done.sentence


def test_the_doctor_survives_an_fmu_that_is_isolated(adaptimp: Command, unruly_file: Callable[[str], Path]) -> None:
    done = adaptimp("doctor", unruly_file("step exit"), "--isolate", *STEPS)
    assert done.code == 1
    assert "ERROR run: step_exit" in done.out
    assert "The run fails: step_exit: fmi2DoStep ended its process with exit code 0" in " ".join(done.out.split())


def test_an_exit_without_isolation_has_its_own_code(unruly_file: Callable[[str], Path], tmp_path: Path) -> None:
    command = "from orchestration.cli import main; main()"
    arguments = ("run", str(unruly_file("step exit")), *STEPS, "-o", str(tmp_path / "rows.csv"))
    ended = subprocess.run([sys.executable, "-c", command, *arguments], capture_output=True, text=True, check=False)
    assert ended.returncode == 4
    assert "step_exit ended the process in a step after t = 0 s" in ended.stderr
    assert not (tmp_path / "rows.csv").exists()


def test_an_unknown_name_is_refused(adaptimp: Command, unruly_file: Callable[[str], Path]) -> None:
    done = adaptimp("run", unruly_file("step none"), "--isolate", "step_nome", *STEPS)
    assert done.code == 2
    assert done.sentence == "isolate names 'step_nome', which is no component; did you mean step_none?"


def test_words_after_the_option() -> None:
    assert completed(["run", "--isolate", "--step", "1"]) == ["run", "--isolate", EVERY, "--step", "1"]
    assert completed(["run", "--isolate"]) == ["run", "--isolate", EVERY]
    assert completed(["run", "--isolate", "a"]) == ["run", "--isolate", "a"]
    chosen = isolation_of(["a,b", "c"])
    assert chosen is not None
    assert chosen.components == ("a", "b", "c")
    assert isolation_of([]) is None


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_ends_a_run_whose_fmu_does_not_return(
    unruly_file: Callable[[str], Path], tmp_path: Path, number: signal.Signals, code: int
) -> None:
    command = "from orchestration.cli import main; main()"
    arguments = (
        "run",
        str(unruly_file("step hang")),
        "--isolate",
        "--no-verdict",
        *STEPS,
        "-o",
        str(tmp_path / "r.csv"),
    )
    with subprocess.Popen([sys.executable, "-c", command, *arguments], stderr=subprocess.PIPE, text=True) as process:
        _wait_for_a_busy_child(process.pid)
        process.send_signal(number)
        said = process.communicate()[1]
    assert process.returncode == code, said
    assert "Traceback" not in said
    assert "ignored" not in said
    assert len(Result.read(tmp_path / "r.partial.csv").time) == 6


def _wait_for_a_busy_child(pid: int) -> None:
    """Wait until the process of an FMU has computed for a second, which nothing but the step that hangs does."""
    children = Path(f"/proc/{pid}/task/{pid}/children")
    for _ in range(1200):
        for child in children.read_text().split():
            fields = Path(f"/proc/{child}/stat").read_text().rpartition(")")[2].split()
            if int(fields[11]) > 3 * os.sysconf("SC_CLK_TCK"):  # user time, of which starting takes half a second
                return
        time.sleep(0.1)
    raise AssertionError(pid)
