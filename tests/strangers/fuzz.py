"""Searches for files that the readers of strangers' files answer with anything but a value or a named error.

    uv run python -m tests.strangers.fuzz --seconds 60
    uv run --with atheris python -m tests.strangers.fuzz --guided archive --seconds 60

Without ``--guided``, seeds are damaged at random, for each target in turn. With it, atheris follows the coverage of the
readers' own code for one target. A file that fails is kept in the current folder.
"""

import argparse
import hashlib
import importlib
import os
import sys
import tempfile
import time
import traceback
from collections import Counter
from pathlib import Path

from tests.strangers.hostile.mutations import TARGETS, Reader, examine, mutated

SLOW = 20.0  # s of the processor that no small file may take


def main() -> None:
    """Run the search that the arguments ask for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0, help="time of the processor, s")
    parser.add_argument("--start", type=int, default=0, help="number of the first mutation")
    parser.add_argument("--guided", choices=list(TARGETS), help="use atheris for this target")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as cache:
        os.environ["ADAPTIMP_CACHE"] = cache
        if arguments.guided:
            guided(arguments.guided, arguments.seconds)
        else:
            sys.exit(blind(arguments.seconds, arguments.start))


def blind(seconds: float, start: int) -> int:
    """Damage all seeds in turn until the time is over; returns the number of findings."""
    began, counts, found = time.process_time(), Counter[tuple[str, str]](), 0
    seed = start
    while time.process_time() - began < seconds:
        for name, (read, contents) in TARGETS.items():
            for content in contents:
                before = time.process_time()
                damaged = mutated(content, seed)
                error = _examined(name, read, damaged)
                counts[name, error or "read"] += 1
                found += error == "FINDING"
                if time.process_time() - before > SLOW:
                    found += _kept(name, damaged, "it takes too long")
        seed += 1
    for (name, error), count in sorted(counts.items()):
        sys.stdout.write(f"{name:12} {error:24} {count}\n")
    spent = time.process_time() - began
    sys.stdout.write(f"{sum(counts.values())} files in {spent:.0f} s of the processor, {found} findings\n")
    return found


def guided(name: str, seconds: float) -> None:
    """Let atheris search one target."""
    atheris = importlib.import_module("atheris")
    read, contents = TARGETS[name]
    atheris.instrument_all()

    def once(content: bytes) -> None:
        examine(read, content)

    with tempfile.TemporaryDirectory() as corpus:
        for i, content in enumerate(contents):
            Path(corpus, f"seed{i}").write_bytes(content)
        atheris.Setup([sys.argv[0], corpus, f"-max_total_time={seconds:.0f}", "-max_len=8192", "-timeout=60"], once)
        atheris.Fuzz()


def _examined(name: str, read: Reader, content: bytes) -> str:
    """The name of the error, or ``FINDING`` for one that nobody has named."""
    try:
        return examine(read, content)
    except Exception:
        _kept(name, content, traceback.format_exc())
        return "FINDING"


def _kept(name: str, content: bytes, why: str) -> int:
    """Keep a file that failed, and say why; returns 1."""
    path = Path(f"finding-{name}-{hashlib.sha256(content).hexdigest()[:12]}")
    path.write_bytes(content)
    sys.stdout.write(f"{path}: {why}\n")
    return 1


if __name__ == "__main__":
    main()
