"""Two interrupts end a study whose FMUs hang, and the processes of the FMUs."""

import signal
import subprocess
import sys
import time
from pathlib import Path

from tests.pooled.conftest import Pooled

PROGRAM = """
import sys
from pathlib import Path
from orchestration import Isolation, Study, System

def noted(result):
    Path("first").touch()
    return float(result["m.y"][-1])

if __name__ == "__main__":
    patient = Isolation(["m"], time_limit=None)
    study = Study(System.read(sys.argv[1]), noted, stop_time=1.0, step=0.125, isolate=patient)
    study.grid({"m.deed": [0.0, 2.0, 5.0]}).run(workers=1)
"""
LONGEST = 300.0  # s, on a machine with much else to do


def children(process: int) -> list[int]:
    tasks = Path(f"/proc/{process}/task").glob("*/children")
    return [int(child) for task in tasks for child in task.read_text().split()]


def wait_for(what) -> None:
    end = time.monotonic() + LONGEST
    while not what():
        assert time.monotonic() < end
        time.sleep(0.05)


def test_two_interrupts_end_a_study_and_its_processes(pooled: Pooled, tmp_path: Path) -> None:
    pooled().write(tmp_path / "system.ssp")
    program = tmp_path / "program.py"
    program.write_text(PROGRAM)
    command = [sys.executable, str(program), "system.ssp"]
    study = subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    try:
        wait_for((tmp_path / "first").exists)
        time.sleep(1.0)  # the second run hangs by now; if it does not, the interrupts come early
        isolated = children(study.pid)
        assert isolated
        for _ in range(2):
            study.send_signal(signal.SIGINT)
            time.sleep(1.0)
        said = study.communicate(timeout=LONGEST)[1]
    finally:
        study.kill()
    assert "StudyInterrupted: The study was interrupted after 1 of 3 runs" in said
    wait_for(lambda: not any(Path(f"/proc/{child}").exists() for child in isolated))
