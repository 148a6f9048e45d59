"""Signals end a run as documented and keep its rows, and a crash at the very end loses nothing."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from orchestration import Result
from tests.unit.orchestration.checked import compiled, misbehaving

if sys.platform == "win32":
    pytest.skip("Windows has no such signals", allow_module_level=True)

PROGRAM = [sys.executable, "-c", "from orchestration.cli import main; main()"]
LONG = ["--set", "plant.dt_max=1e-7", "--stop", "200", "--no-verdict", "--record", "plant.x[1]", "--every", "10"]
PATIENCE = 300.0  # s that a process may take to end on a machine that is busy


@contextmanager
def running(folder: Path, *arguments: str, shows: bytes) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    """A command that has shown on its terminal that it is running, and the terminal."""
    terminal, end = os.openpty()

    def as_in_a_shell() -> None:
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL)

    environment = os.environ | {"TERM": "xterm", "COLUMNS": "200", "TMPDIR": str(folder / "temporary")}
    (folder / "temporary").mkdir()
    with subprocess.Popen(
        [*PROGRAM, *arguments],
        cwd=folder,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=end,
        preexec_fn=as_in_a_shell,
    ) as run:
        os.close(end)
        try:
            said_until(terminal, shows)
            yield run, terminal
        finally:
            run.kill()
            os.close(terminal)


def said_until(terminal: int, word: bytes) -> bytes:
    """What a terminal is sent up to a word, or up to the end of the last program."""
    said = b""
    while word not in said:
        try:
            more = os.read(terminal, 4096)
        except OSError:  # Linux reports the end as an error
            more = b""
        if not more:
            break
        said += more
    return said


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The library of the FMU that misbehaves."""
    return compiled(tmp_path_factory.mktemp("misbehaving"), "Misbehaving")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_a_signal_keeps_the_rows_that_are_complete(tmp_path: Path, number: signal.Signals, suffix: str) -> None:
    with running(tmp_path, "run", "fig2", *LONG, "--out", f"long.{suffix}", shows=b"running") as (run, terminal):
        run.send_signal(number)
        said = said_until(terminal, b"before that").decode(errors="replace")
        assert run.wait(PATIENCE) == 128 + number, said
    assert "Interrupted: the run was stopped." in said
    assert f"wrote long.partial.{suffix}" in said
    assert sorted(p.name for p in tmp_path.iterdir()) == [f"long.partial.{suffix}", "temporary"]
    assert list((tmp_path / "temporary").iterdir()) == []
    result = Result.read(tmp_path / f"long.partial.{suffix}")
    assert 1 < len(result.time) < 200_000
    assert np.isfinite(result["plant.x[1]"]).all()


def test_a_second_ctrl_c_ends_a_run_whose_fmu_never_returns(tmp_path: Path, library: Path) -> None:
    """Between the two, the program says that the first one has no effect."""
    misbehaving(library, tmp_path / "hang.fmu", "hang")
    arguments = ("run", "hang.fmu", "--stop", "1", "--step", "0.5", "--no-verdict", "--out", "x.csv")
    with running(tmp_path, *arguments, shows=b"running") as (run, terminal):
        run.send_signal(signal.SIGINT)
        assert b"press Ctrl-C again to end it without its rows" in said_until(terminal, b"without its rows")
        assert run.poll() is None
        run.send_signal(signal.SIGINT)
        said = said_until(terminal, b"streamed file")
        assert run.wait(PATIENCE) == 130
    assert b"Interrupted: the process ends while a call does not return." in said
    assert list((tmp_path / "temporary").iterdir()) == []
    assert not (tmp_path / "x.csv").exists()


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
@pytest.mark.parametrize("fault", ["crash in terminate", "crash in free", "terminate"])
def test_a_finished_run_is_saved_before_the_fmus_end(tmp_path: Path, library: Path, fault: str, suffix: str) -> None:
    misbehaving(library, tmp_path / "x.fmu", fault)
    (tmp_path / "temporary").mkdir()
    arguments = ("run", "x.fmu", "--stop", "5", "--step", "0.5", "--no-verdict", "--out", f"x.{suffix}")
    environment = os.environ | {"TMPDIR": str(tmp_path / "temporary")}
    done = subprocess.run(
        [*PROGRAM, *arguments], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == (1 if fault == "terminate" else -signal.SIGSEGV), done.stderr
    assert f"wrote x.{suffix}: 11 rows" in done.stdout
    result = Result.read(tmp_path / f"x.{suffix}")
    assert (len(result.time), result.status) == (11, "complete")
    assert not list(tmp_path.glob("*.part*"))
