"""A scheduler and workers of Dask as processes, started by the commands that users give; all end with the context."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread
from typing import TextIO

ROOT = Path(__file__).resolve().parents[5]
# What a scheduler and a worker say when they are ready.
READY = re.compile(r"Scheduler at:\s+(tcp://\S+)")
REGISTERED = re.compile(r"Registered to:\s+(tcp://\S+)")
_END = 300.0  # s; longest time in which a worker notices that its scheduler is gone


class Machines:
    """Processes of one cluster on this machine.

    Attributes
    ----------
    address
        Address of the scheduler.
    """

    def __init__(self, folder: Path) -> None:
        self.address = ""
        self._folder = folder
        self._processes: list[subprocess.Popen[str]] = []  # that of the scheduler first

    def start(self, workers: int = 2) -> None:
        """Start a scheduler, at the address of the one before if there was one, and workers with one thread each."""
        port = self.address.rpartition(":")[2] or "0"
        places = "--host", "127.0.0.1", "--port", port, "--dashboard-address", ":0"
        self.address = self.started(READY, "scheduler", *places)[1]
        for _ in range(workers):
            self.started(REGISTERED, "worker", self.address, "--nthreads", "1", "--no-nanny")

    def kill_scheduler(self) -> None:
        """Kill the scheduler, and wait until its workers have ended, as they do by themselves."""
        self._processes[0].kill()
        for process in self._processes:
            process.wait(_END)
        self._processes.clear()

    def stop(self) -> None:
        """End everything."""
        for process in self._processes:
            process.kill()
        for process in self._processes:
            process.wait()
        self._processes.clear()

    def started(self, ready: "re.Pattern[str]", *arguments: str) -> "re.Match[str]":
        """Start a command of Dask, and wait for what it says when it is ready."""
        command = [sys.executable, "-m", "dask", *arguments, "--no-dashboard", *self._scratch(arguments[0])]
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment)
        self._processes.append(process)
        assert process.stderr is not None
        found = next((found for line in process.stderr if (found := ready.search(line))), None)
        # What the process says is read to its end, so that it never waits for a reader.
        Thread(target=_read_all, args=[process.stderr], daemon=True).start()
        assert found is not None, f"dask {arguments[0]} ended before it was ready"
        return found

    def _scratch(self, kind: str) -> list[str]:
        """Option for the folder of a worker."""
        return ["--local-directory", str(self._folder)] if kind == "worker" else []


@contextmanager
def machines(folder: Path, workers: int | None = 2) -> Iterator[Machines]:
    """A scheduler and workers, which have ended when the context does, also after an error.

    Parameters
    ----------
    folder
        Folder for the files of the workers.
    workers
        Number of workers; None starts nothing.
    """
    made = Machines(folder)
    try:
        if workers is not None:
            made.start(workers)
        yield made
    finally:
        made.stop()


def _read_all(lines: TextIO) -> None:
    """Read to the end, and close."""
    with lines:
        for _ in lines:
            pass
