"""A confined child process that tries what a stranger's library may try, and prints what became of each attempt.

``python -m tests.unit.orchestration.sandbox.confined FOLDER PARENT`` prints a JSON object: the measures that are in
force, and of each attempt whether it succeeded. With the word ``wait`` behind, it prints its id and waits.
"""

import ctypes
import fcntl
import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from orchestration.sandbox.confinement import Limits, limit, seal

LIMITS = Limits(memory=4 * 1024**3, file_size=1024**2, files=64, time=600)


def attempts(folder: Path, outside: Path) -> dict[str, Callable[[], object]]:
    """What is tried, by name; `outside` is a folder with the file ``there`` that the child must not touch."""
    libc = ctypes.CDLL(None, use_errno=True)

    def many_threads() -> None:
        waiting = threading.Event()
        try:
            for _ in range(5000):
                threading.Thread(target=waiting.wait, daemon=True).start()
        finally:
            waiting.set()

    def clone_without_thread() -> None:
        if libc.syscall({"x86_64": 56, "aarch64": 220}[os.uname().machine], signal.SIGCHLD, 0, 0, 0, 0) < 0:
            raise OSError(ctypes.get_errno(), "clone")
        os._exit(0)

    return {
        "a thread": lambda: (lambda t: (t.start(), t.join()))(threading.Thread(target=int)),
        "write below its folder": lambda: (folder / "mine").write_text("x"),
        "rename below its folder": lambda: (folder / "mine").rename(folder / "renamed"),
        "read elsewhere": lambda: (outside / "there").read_text(),
        "write elsewhere": lambda: (outside / "new").write_text("x"),
        "overwrite elsewhere": lambda: (outside / "there").write_text("x"),
        "truncate elsewhere": lambda: os.truncate(outside / "there", 0),
        "remove elsewhere": lambda: (outside / "there").unlink(),
        "link elsewhere": lambda: (folder / "link").hardlink_to(outside / "there"),
        "change a mode elsewhere": lambda: (outside / "there").chmod(0o777),
        "change a time elsewhere": lambda: os.utime(outside / "there", (0, 0)),
        "a file too large": lambda: (folder / "large").write_bytes(bytes(2 * 1024**2)),
        "too many files": lambda: [Path(os.devnull).open() for _ in range(5000)],
        "too much memory": lambda: bytes(5 * 1024**3),
        "too many threads": many_threads,
        "a socket": lambda: socket.socket(socket.AF_INET),
        "a local socket": lambda: socket.socket(socket.AF_UNIX),
        "another process": os.fork,
        "another process by clone": clone_without_thread,
        "a program": lambda: subprocess.run(["true"], check=True),
        "to ask whether the parent is there": lambda: os.kill(os.getppid(), 0),
        "to signal its group": lambda: os.killpg(os.getpgrp(), 0),
        "to signal itself": lambda: os.kill(os.getpid(), 0),
        "to own a signal": lambda: fcntl.fcntl(0, fcntl.F_SETOWN, os.getppid()),
        "a session of its own": os.setsid,
    }


def main() -> None:
    """Confine this process, and try everything or wait."""
    folder, parent, *wait = sys.argv[1:]
    inside, outside = Path(folder) / "inside", Path(folder) / "outside"
    if sys.platform != "win32":
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # the write fails instead
    measures = [*limit(LIMITS, int(parent)), *seal([inside])]
    if wait:
        sys.stdout.write(f"{os.getpid()}\n")
        sys.stdout.flush()
        time.sleep(3600)
    found = {}
    for name, attempt in attempts(inside, outside).items():
        try:
            attempt()
        except (OSError, MemoryError, RuntimeError) as failed:
            found[name] = type(failed).__name__
        else:
            found[name] = ""
    sys.stdout.write(json.dumps({"measures": measures, "attempts": found}))


if __name__ == "__main__":
    main()
