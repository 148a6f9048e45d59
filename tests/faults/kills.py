"""Kills commands at random moments, and looks at what they leave.

    python -m tests.faults.kills --moments 50 [--seed N]

A moment is one SIGKILL to a command and to all that it has started. Afterwards

* every file under its final name is the old one or the complete new one, byte for byte;
* everything else is a draft, ``*.part``; of the draft of a Parquet file, whole groups of rows can be read;
* after the next start of the same program the folder for temporary files is empty, and the caches still serve.

The moments are spread over the time that the command takes on this machine. The claims of the paper are measured first
if the cache does not hold them, which takes minutes.
"""

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console

from orchestration import OrchestrationError, Result

PROGRAM = [sys.executable, "-c", "from orchestration.cli import main; main()"]
NEXT_START = ("run", "fig2", "--stop", "0.001", "--no-verdict", "--record", "plant.x")
OLD = b"the old file\n"
MODEL = """from adaptimp_fmu import SampledModel
model = SampledModel("Gain", "Multiplies")
model.output("y", {number} * model.input("u", 1.0, description="In"), description="Out")
"""


@dataclass(frozen=True)
class Workload:
    """A command that writes files.

    Attributes
    ----------
    arguments
        Those of ``adaptimp``; outputs go to the folder ``out`` or below.
    compiles
        Whether each moment needs a cache of its own, because otherwise nothing would be compiled.
    """

    name: str
    arguments: tuple[str, ...]
    compiles: bool = False


WORKLOADS = (
    Workload("run to CSV", ("run", "fig4", "--no-verdict", "-o", "out/x.csv")),
    Workload("run to Parquet", ("run", "fig4", "--stop", "10", "--no-verdict", "-o", "out/x.parquet")),
    Workload("export", ("export", "fig5", "-o", "out/x.ssp")),
    Workload("build", ("build", "model.py", "--out", "out"), compiles=True),
    Workload("paper", ("paper", "-o", "out")),
)


@dataclass
class Trial:
    """A workload, the files that it writes, and how long it takes.

    Attributes
    ----------
    folder
        Place for the moments.
    expected
        Content of each complete file.
    seconds
        Time of a whole command, s.
    """

    workload: Workload
    folder: Path
    expected: Mapping[str, bytes] = field(default_factory=dict)
    seconds: float = 0.0

    def prepare(self) -> None:
        """Run the command once, undisturbed; the second run is timed, for the first one fills caches."""
        for _ in range(2):
            self._lay_out()
            started = time.monotonic()
            self._run(self.workload.arguments)
            self.seconds = time.monotonic() - started
        self.expected = contents(self.folder / "out")

    def kill_after(self, seconds: float) -> list[str]:
        """Kill the command after a time, s; returns a sentence for each fault that is found."""
        self._lay_out()
        for name in self.expected:
            (self.folder / "out" / name).write_bytes(OLD)
        process = subprocess.Popen(
            [*PROGRAM, *self.workload.arguments],
            cwd=self.folder,
            env=self._environment(),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        with suppress(subprocess.TimeoutExpired):
            process.wait(seconds)
        with suppress(ProcessLookupError):  # all have ended
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        faults = self._wrong_files()
        self._run(self.workload.arguments if self.workload.compiles else NEXT_START)
        faults += [f"{path.name} is left in the temporary folder" for path in (self.folder / "temporary").iterdir()]
        return [f"{self.workload.name}, killed after {seconds:.3f} s: {fault}" for fault in faults]

    def finish(self) -> list[str]:
        """Run the command to its end, with all that was left; returns a sentence for each fault."""
        self._run(self.workload.arguments)
        present = contents(self.folder / "out")
        left = sorted(set(present) - set(self.expected) - {"x.partial.parquet"})
        wrong = sorted(name for name in self.expected if present.get(name) != self.expected[name])
        return [f"{self.workload.name}, at the end: {name} is left or wrong" for name in (*left, *wrong)]

    def _lay_out(self) -> None:
        """An empty folder for the output, one for temporary files, and a model."""
        for name in ("out", "temporary", *(("cache",) if self.workload.compiles else ())):
            shutil.rmtree(self.folder / name, ignore_errors=True)
            (self.folder / name).mkdir(parents=True)
        (self.folder / "model.py").write_text(MODEL.format(number=2.5), encoding="utf-8")

    def _environment(self) -> dict[str, str]:
        own = {"ADAPTIMP_CACHE": str(self.folder / "cache")} if self.workload.compiles else {}
        return {**os.environ, "TMPDIR": str(self.folder / "temporary"), **own}

    def _run(self, arguments: tuple[str, ...]) -> None:
        subprocess.run(
            [*PROGRAM, *arguments], cwd=self.folder, env=self._environment(), check=True, capture_output=True
        )

    def _wrong_files(self) -> list[str]:
        """Files that are neither the old ones, nor complete, nor drafts."""
        faults = []
        for name, content in contents(self.folder / "out").items():
            if name.endswith(".part"):
                faults += self._wrong_draft(self.folder / "out" / name)
            elif content not in (OLD, self.expected.get(name)):
                faults.append(f"{name} is neither the old file nor the new one")
        return faults

    def _wrong_draft(self, path: Path) -> list[str]:
        """What is wrong with the rows of an unfinished Parquet file; other drafts are not read."""
        if ".parquet." not in path.name:
            return []
        try:
            found = Result.read(path)
        except OrchestrationError as error:
            return [] if "it ends before its first" in str(error) else [str(error)]
        whole = Result.read(self._complete())
        n = len(found.time)
        same = found.names == whole.names and found.rows.tobytes() == whole.rows[:n].tobytes()
        return [] if same else [f"the rows of {path.name} differ from those of the whole run"]

    def _complete(self) -> Path:
        path = self.folder / "complete.parquet"
        if not path.exists():
            path.write_bytes(self.expected["x.parquet"])
        return path


def contents(folder: Path) -> dict[str, bytes]:
    """Content of each file in a folder, by its name."""
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir()) if path.is_file()}


def kill(workload: Workload, moments: int, seed: int, folder: Path) -> tuple[Trial, list[str]]:
    """Kill a command at some moments; returns the trial, and a sentence for each fault."""
    trial = Trial(workload, folder)
    folder.mkdir(parents=True, exist_ok=True)
    trial.prepare()
    chance = random.Random(f"{workload.name} {seed}")
    faults = []
    for _ in range(moments):
        faults += trial.kill_after(chance.uniform(0.0, trial.seconds))
    return trial, faults + trial.finish()


def main() -> None:
    """Kill all workloads, and say what was found."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--moments", type=int, default=50, help="number of kills in all")
    parser.add_argument("--seed", type=int, default=1, help="of the moments")
    chosen = parser.parse_args()
    console, faults = Console(highlight=False), []
    for i, workload in enumerate(WORKLOADS):
        moments = chosen.moments // len(WORKLOADS) + (i < chosen.moments % len(WORKLOADS))
        with tempfile.TemporaryDirectory() as folder:
            trial, found = kill(workload, moments, chosen.seed, Path(folder))
        console.print(f"{workload.name}: {moments} kills within {trial.seconds:.2f} s, {len(found)} faults")
        faults += found
    for fault in faults:
        console.print(fault)
    raise SystemExit(bool(faults))


if __name__ == "__main__":
    main()
