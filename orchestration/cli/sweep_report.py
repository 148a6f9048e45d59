"""What ``adaptimp sweep`` says at its end: counts, failures, and the extremes of each measure with their places."""

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orchestration.analysis.doctor.finding import counted
from orchestration.cli.codes import ExitCode, exit_code_of
from orchestration.cli.report import STATUS
from orchestration.cli.tables import table
from orchestration.errors import printable
from orchestration.results.columns import COMPLETE, FAILED

if TYPE_CHECKING:
    import pandas as pd

HEAD = ("measure", "unit", "", "value", "at")
MOST_SENTENCES = 5  # kinds of failures that the JSON object has
_NUMBER = re.compile(r"(?<![\w\[.])[-+]?\d[\d.]*(?:e[-+]?\d+)?")


@dataclass
class SweepReport:
    """What is known of a campaign; durations in s.

    Attributes
    ----------
    system, algorithm
        Names of the systems and of the algorithm.
    factors
        Names of the factors.
    runs, complete, failed
        Number of runs of the study, and of those that are complete and that failed.
    from_store
        Number of runs that the store had already.
    seconds, rate
        Duration of the runs, and runs made per second.
    failures
        Sentences of failed runs, the commonest first, each with its number of runs; sentences that differ in numbers
        count as one.
    measures
        For each measure its unit, extremes, and the factors of the runs that have them.
    store, file, pictures
        Folder of the store, file with the table, files of the pictures.
    status, message, exit_code
        ``complete``, ``failed`` if every run failed, ``interrupted`` or ``refused``; why; exit code of the program.
    """

    system: str
    algorithm: str
    factors: Sequence[str] = ()
    runs: int = 0
    complete: int = 0
    failed: int = 0
    from_store: int = 0
    seconds: float = 0.0
    rate: float = 0.0
    failures: list[dict[str, Any]] = field(default_factory=list)
    measures: dict[str, dict[str, Any]] = field(default_factory=dict)
    store: Path | None = None
    file: Path | None = None
    pictures: list[Path] = field(default_factory=list)
    status: str = COMPLETE
    message: str = ""
    exit_code: int = ExitCode.SUCCESS

    def take(self, frame: "pd.DataFrame", factors: Sequence[str], units: Mapping[str, str]) -> None:
        """Take counts, failures and extremes from a table with one row for each run.

        Parameters
        ----------
        factors
            Columns that are factors.
        units
            Units by the names of the measures.
        """
        self.factors, self.runs = tuple(factors), len(frame)
        self.complete = list(frame["status"]).count(COMPLETE)
        self.failed = self.runs - self.complete
        self.failures = commonest([str(message) for message in frame["message"][frame["status"] != COMPLETE]])
        self.measures = {name: _extremes(frame, name, unit, factors) for name, unit in units.items()}
        if self.runs and not self.complete:
            self.status, self.exit_code = FAILED, ExitCode.FAILED
            self.message = f"{counted(self.runs, 'run')} failed, and none is complete: {self.failures[0]['message']}"

    def ended_by(self, error: BaseException) -> None:
        """Take the status from an exception."""
        self.exit_code = exit_code_of(error)
        self.status = STATUS.get(ExitCode(self.exit_code), FAILED)
        self.message = str(error) or "The campaign was interrupted."

    def json(self) -> str:
        """The report as a JSON object."""
        own = {f.name: getattr(self, f.name) for f in fields(self)}
        own |= {name: None if own[name] is None else str(own[name]) for name in ("store", "file")}
        own |= {"factors": list(self.factors), "pictures": [str(path) for path in self.pictures]}
        return json.dumps({"version": version("adaptimp"), **own}, indent=2, allow_nan=False)

    def sentences(self) -> list[str]:
        """Counts, the rate and failures in words."""
        said = f"{counted(self.runs, 'run')}: {self.complete} complete, {self.failed} failed"
        said += f"; {self.from_store} were in the store" if self.from_store else ""
        said += f"; {self.rate:.3g} runs/s, {self.seconds:.3g} s" if self.rate else ""
        failed = [f"{counted(one['runs'], 'run')} failed: {one['message']}" for one in self.failures]
        return [said, *failed]

    def table(self, width: int) -> str:
        """The extremes of each measure, for a terminal."""
        rows = [
            (name, found["unit"], end, *_cells(found[end], found[f"{end}_at"]))
            for name, found in self.measures.items()
            for end in ("min", "max")
        ]
        return table(HEAD, rows, width, numbers=("value",), together=4)


def commonest(messages: Sequence[str]) -> list[dict[str, Any]]:
    """Sentences with their number of runs, the commonest first; those that differ in numbers only count as one."""
    first: dict[str, str] = {}
    count: dict[str, int] = {}
    for message in messages:
        kind = _NUMBER.sub("#", message)
        first.setdefault(kind, message)
        count[kind] = count.get(kind, 0) + 1
    order = sorted(count, key=lambda kind: -count[kind])
    return [{"message": printable(first[kind]), "runs": count[kind]} for kind in order[:MOST_SENTENCES]]


def _extremes(frame: "pd.DataFrame", name: str, unit: str, factors: Sequence[str]) -> dict[str, Any]:
    """Unit, extremes and their places of a measure; None where no run has a number."""
    column = frame[name].dropna()
    found: dict[str, Any] = {"unit": unit}
    for key, place in (("min", column.argmin), ("max", column.argmax)):
        label = column.index[place()] if len(column) else None
        found[key] = None if label is None else _plain(column[label])
        found[f"{key}_at"] = {} if label is None else {f: _plain(frame[f][label]) for f in factors}
    return found


def _plain(value: Any) -> Any:
    """A value that JSON knows; a number that is not finite is None."""
    plain = value.item() if hasattr(value, "item") else value
    return None if isinstance(plain, float) and not math.isfinite(plain) else plain


def _cells(value: float | None, place: Mapping[str, Any]) -> tuple[str, str]:
    """An extreme and its place as texts."""
    if value is None:
        return "", ""
    return f"{value + 0.0:.6g}", ", ".join(f"{name}={shown(one)}" for name, one in place.items())


def shown(value: Any) -> str:
    """A value of a factor as a text."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)
