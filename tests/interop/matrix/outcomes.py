"""Outcomes of the jobs in other tools, kept in ``outcomes.json`` beside this file; one tool can be measured anew."""

import json
from collections.abc import Callable, Iterable
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np

from tests.interop.matrix.compare import Verdict, judge
from tests.interop.matrix.jobs import SYSTEMS, UNITS, chosen, figure_job, fmu_job, our_rows
from tests.interop.matrix.protocol import FMU, SYSTEM, Job, Tool
from tests.interop.matrix.runner import ask
from tests.interop.matrix.tools import KEYS, module

FILE = Path(__file__).parent / "outcomes.json"


@dataclass(frozen=True)
class Outcomes:
    """Verdicts by tool and job, and versions by distribution."""

    verdicts: dict[str, dict[str, Verdict]] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)

    @classmethod
    def read(cls, file: Path = FILE) -> "Outcomes":
        """What was written; nothing if there is no file."""
        if not file.exists():
            return cls()
        about = json.loads(file.read_text(encoding="utf-8"))
        verdicts = {
            tool: {job: Verdict(**verdict) for job, verdict in row.items()} for tool, row in about["verdicts"].items()
        }
        return cls(verdicts, about["versions"])

    def write(self, file: Path = FILE) -> None:
        """Write it, in the order of the tools and jobs."""
        jobs = (*UNITS, *SYSTEMS)
        verdicts = {
            key: {job: asdict(row[job]) for job in jobs if job in row}
            for key, row in ((key, self.verdicts.get(key, {})) for key in KEYS)
        }
        text = json.dumps({"verdicts": verdicts, "versions": dict(sorted(self.versions.items()))}, indent=1)
        file.write_text(text + "\n", encoding="utf-8", newline="\n")

    def updated(self, other: "Outcomes") -> "Outcomes":
        """The same with the verdicts and versions of another one in place of its own."""
        verdicts = {key: {**self.verdicts.get(key, {}), **row} for key, row in other.verdicts.items()}
        return Outcomes({**self.verdicts, **verdicts}, {**self.versions, **other.versions})


def measure(
    tools: Iterable[str],
    jobs: Iterable[str],
    files: dict[str, Path],
    folder: Path,
    *,
    n_steps: int | None = None,
    tell: Callable[[str, str, Verdict], None] = lambda *_: None,
) -> Outcomes:
    """Run jobs in tools and compare.

    Parameters
    ----------
    files
        Those of `tests.interop.matrix.jobs.built`.
    folder
        For packages.
    n_steps
        Steps of a figure, if not all.
    tell
        Hears every verdict as it comes.
    """
    asked = [module(key).TOOL for key in tools]
    verdicts: dict[str, dict[str, Verdict]] = {tool.key: {} for tool in asked}
    versions: dict[str, str] = {}
    for name in jobs:
        rows: dict[tuple[str, str, int], np.ndarray] = {}
        _, used = chosen(name, files)
        for tool in (t for t in asked if (FMU if name in UNITS else SYSTEM) in t.kinds):
            job = _job(name, tool, files, folder, n_steps)
            ours = (tool.algorithm, tool.clock, job.n_steps)
            if ours not in rows:
                rows[ours] = our_rows(job, tool, used)
            answer = ask(tool, job)
            verdicts[tool.key][name] = judge(job, answer, rows[ours])
            if answer.version:
                versions[tool.distribution] = answer.version
            tell(tool.key, name, verdicts[tool.key][name])
    return Outcomes(verdicts, versions)


def _job(name: str, tool: Tool, files: dict[str, Path], folder: Path, n_steps: int | None) -> Job:
    about, used = chosen(name, files)
    if name in UNITS:
        return fmu_job(about, used, folder)
    job = figure_job(about, used, folder)
    return replace(job, n_steps=min(n_steps or job.n_steps, tool.longest))
