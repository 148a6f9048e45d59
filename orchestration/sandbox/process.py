"""Runs a job in a confined child process that may crash or hang without harm, and reports how the process ended."""

import json
import os
import secrets
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, cast

from adaptimp_fmu.files.cache_folder import VARIABLE, cache_folder
from orchestration.sandbox.channel import KEY_BYTES, Receiver
from orchestration.sandbox.confinement import end, environment, starting
from orchestration.sandbox.interpreter import LONGEST_START, command, death, search_path
from orchestration.sandbox.leftovers import empty, files_in
from orchestration.sandbox.worker import COUNT_BYTES, DONE, STARTED, TRACE_BYTES

if TYPE_CHECKING:
    from orchestration.sandbox.denials import Denials

POLL = 0.01  # s
LONGEST_READING = 60.0  # s that the parent reads on what a child has left in the pipe
HOME = "work"  # name of the child's folder
MOST_KEPT = 1024**3  # bytes of all files in the child's folder
LOOKS = 1.0  # s between looks at these files
PRINTED = 200  # bytes of what was printed that are read
MOST_TOLD = 100  # denied calls that an ending lists


@dataclass(frozen=True)
class Ending:
    """How a job in a child process ended, and what it left; all texts may hold any characters.

    Attributes
    ----------
    lines
        JSON objects that the job wrote.
    how
        Empty if the job came to its end, else the end of a sentence, such as ``dies of SIGSEGV``.
    function
        Last announcement of a job whose process ended too early; empty if the job had announced nothing.
    printed
        The beginning of the process's standard output.
    out_of_time
        Whether the job was ended because its time in all was over.
    measures
        Measures that confined the process; see `orchestration.sandbox.confinement`.
    denied
        Names of system calls that were denied, each with the announcement under which it was tried first.
    foreign
        Number of lines in the channel that the job did not write.
    files
        Paths of files that the process left in its working directory, relative to it.
    """

    lines: Sequence[Mapping[str, Any]]
    how: str
    function: str
    printed: str
    out_of_time: bool = False
    measures: Sequence[str] = ()
    denied: Mapping[str, str] = field(default_factory=dict)
    foreign: int = 0
    files: Sequence[str] = ()


class _Watched:
    """A child process under way, and what is known of it."""

    def __init__(self, process: subprocess.Popen[bytes], receiver: Receiver, trace: Path, denials: "Denials | None"):
        self.process, self._receiver, self._trace, self._denials = process, receiver, trace, denials
        self._home = trace.with_name(HOME)
        self.denied: dict[str, str] = {}

    def wait(self, timeout: float, total: float | None) -> str:
        """Wait for the end of the process; returns why the process must be ended, empty if it has ended itself."""
        start = heard = looked = time.monotonic()
        sign = self._sign()
        while not self._has_ended():
            self.listen()
            now = time.monotonic()
            if (found := self._sign()) != sign:
                sign, heard = found, now
            elif now - heard > (timeout if sign != _NO_SIGN else max(timeout, LONGEST_START)):
                return f"does not return within {timeout:g} s"
            if total is not None and now - start > total:
                return f"does not come to its end within {total:g} s"
            if now - looked > LOOKS:
                looked = now
                if sum(size for _, size in files_in(self._home)) > MOST_KEPT:
                    return f"writes more than {MOST_KEPT / 1024**3:g} GiB to its files"
            time.sleep(POLL)
        return ""

    def listen(self) -> None:
        """Answer denied calls, which wait for that."""
        if self._denials is not None:
            self._denials.poll(self._notice)

    def _notice(self, call: str) -> None:
        """Keep what was announced when a call was denied."""
        if call not in self.denied and len(self.denied) < MOST_TOLD:
            self.denied[call] = self.announced()

    def announced(self) -> str:
        """The announcement that stands."""
        return self._trace.read_bytes()[COUNT_BYTES:].rstrip(b"\0").decode(errors="replace")

    def _sign(self) -> tuple[int, bytes]:
        """What changes while the job goes on: the number of its records, and of its announcements."""
        with self._trace.open("rb") as file:
            return len(self._receiver.records), file.read(COUNT_BYTES)

    def _has_ended(self) -> bool:
        """Whether the process has ended; until it is waited for, no other process gets its id."""
        if os.name != "posix":
            return self.process.poll() is not None
        return os.waitid(os.P_PID, self.process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None


_NO_SIGN = (0, bytes(COUNT_BYTES))


def work(
    job: str,
    plan: Mapping[str, Any],
    folder: Path,
    *,
    timeout: float,
    memory: int | None = None,
    total: float | None = None,
    writable: Sequence[Path] = (),
    cache: Path | None = None,
) -> Ending:
    """Run a job in a confined child process, wait for its end, and end all that it has started.

    Parameters
    ----------
    job
        The job's function as ``module:function``; `orchestration.sandbox.worker` describes its arguments.
    plan
        Data for the job that JSON can hold.
    folder
        Existing folder for this process's files. The child works in the folder ``work`` below it, which is its home
        and takes its temporary files.
    timeout
        Longest time that the job may neither announce nor write anything, s; the start of the process does not count.
    memory
        Bytes of addresses that the process may take; None sets no limit.
    total
        Longest time of the job in all, s; None sets no limit.
    writable
        Further folders below which the child may change files.
    cache
        The child's folder of caches; by default that of this process, which the child can read.
    """
    key, home, trace, printed = secrets.token_bytes(KEY_BYTES), folder / HOME, folder / "trace", folder / "printed"
    home.mkdir(exist_ok=True)
    trace.write_bytes(bytes(COUNT_BYTES + TRACE_BYTES))
    printed.write_bytes(b"")
    given: dict[str, Any] = {"job": job, "memory": memory, "trace": str(trace), "printed": str(printed)}
    given |= {"key": key.hex(), "parent": os.getpid(), "folders": [str(home), *map(str, writable)]}
    given["time"] = None if total is None else total * (os.cpu_count() or 1) + LONGEST_START
    with _denials() as denials:
        given["denials"] = None if denials is None else denials.teller
        process = _started(home, cache or cache_folder(), () if denials is None else (denials.teller,))
        orders, reports = (cast("IO[bytes]", pipe) for pipe in (process.stdin, process.stdout))
        try:
            receiver = Receiver(reports, key)
            with suppress(BrokenPipeError), orders:  # a child that died at once is told below
                orders.write(json.dumps({**plan, **given}).encode())
            watched = _Watched(process, receiver, trace, denials)
            late = watched.wait(timeout, total)
            watched.listen()
        finally:
            _end(process)
        receiver.finish(LONGEST_READING)
        reports.close()
    return _ending(watched, receiver, late, folder)


@contextmanager
def _denials() -> "Iterator[Denials | None]":
    """The report of denied calls, on systems that may have one."""
    if not sys.platform.startswith("linux"):
        yield None
        return
    from orchestration.sandbox.denials import Denials

    with Denials() as found:
        yield found


def _started(home: Path, cache: Path, passed: Sequence[int]) -> subprocess.Popen[bytes]:
    """Start the child, which waits for its plan."""
    return subprocess.Popen[bytes](
        command("orchestration.sandbox.worker"),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        cwd=home,
        env=environment(home, {"PYTHONPATH": search_path(), VARIABLE: str(cache)}),
        pass_fds=passed,
        **starting(),
    )


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a child and its session."""
    end(process.pid)
    if process.poll() is None:
        process.kill()
    process.wait()


def _ending(watched: _Watched, receiver: Receiver, late: str, folder: Path) -> Ending:
    """Collect what a child that has ended left."""
    records = receiver.records
    done = any(DONE in record for record in records)
    home = folder / HOME
    left = sorted(str(path.relative_to(home)) for path, _ in files_in(home))
    empty(home)
    return Ending(
        lines=[record for record in records if not {STARTED, DONE} & set(record)],
        how=late or ("" if done else death(watched.process.returncode, "ends the process", "dies")),
        function="" if done else watched.announced(),
        printed=_beginning(folder / "printed", PRINTED),
        out_of_time=late.startswith("does not come"),
        measures=tuple(next((record[STARTED] for record in records if STARTED in record), ())),
        denied=watched.denied,
        foreign=receiver.foreign,
        files=left,
    )


def _beginning(path: Path, most: int) -> str:
    """Return the first bytes of a file as text; empty if the file is not there."""
    try:
        with path.open("rb") as file:
            return file.read(most).decode(errors="replace")
    except OSError:
        return ""
