"""What a run did, in the numbers that matter: ``adaptimp run --json`` prints them as one object.

docs/command-line.md describes the object; a number that is missing is null.
"""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from importlib.metadata import version
from pathlib import Path

from orchestration.cli.codes import ExitCode, exit_code_of
from orchestration.cli.signals import signal_record
from orchestration.paper.run_numbers import RunNumber
from orchestration.results.columns import COMPLETE, FAILED, INTERRUPTED
from orchestration.results.extremes import Extremes

REFUSED = "refused"
"""Status of a run that did not begin."""
STATUS = {
    ExitCode.REFUSED: REFUSED,
    **dict.fromkeys((ExitCode.HUNG_UP, ExitCode.INTERRUPTED, ExitCode.TERMINATED), INTERRUPTED),
}


@dataclass
class RunReport:
    """What is known of a run; times in s.

    Attributes
    ----------
    system, algorithm, order
        Names of the system, the algorithm and the components in the order of stepping.
    step, start_time, stop_time
        What was asked for.
    time, steps, rows
        Time that was reached, number of steps made, number of rows recorded.
    stepping_seconds, compile_seconds
        Duration of all steps together, and of the compilation, or loading, of the master's loop before.
    status, message, exit_code
        ``complete``, ``ended``, ``failed``, ``interrupted`` or ``refused``; why; the exit code of the program.
    notices, warnings
        Sentences that the user should know.
    messages
        What the FMUs logged, each text after the name of its component.
    file, replaced
        File with the rows, and whether there was one of that name before.
    row_hash
        SHA-256 of all rows, of a run that is complete; None if it was not asked for.
    extremes
        Values of the signals.
    numbers
        Measures of a run of the paper's loop, by name.
    """

    system: str
    algorithm: str
    order: Sequence[str] = ()
    step: float | None = None
    start_time: float | None = None
    stop_time: float | None = None
    time: float | None = None
    steps: int = 0
    rows: int = 0
    stepping_seconds: float = 0.0
    compile_seconds: float = 0.0
    status: str = COMPLETE
    message: str = ""
    exit_code: int = ExitCode.SUCCESS
    notices: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    messages: Sequence[str] = ()
    file: Path | None = None
    replaced: bool = False
    row_hash: str | None = None
    extremes: Extremes | None = None
    numbers: Mapping[str, RunNumber] = field(default_factory=dict)

    def ended_by(self, error: BaseException) -> None:
        """Take the status from an exception."""
        self.exit_code = exit_code_of(error)
        self.status = STATUS.get(ExitCode(self.exit_code), FAILED)
        self.message = str(error) or "The run was interrupted."

    def json(self) -> str:
        """The report as a JSON object."""
        signals = {} if self.extremes is None else signal_record(self.extremes)
        own = {f.name: _known(getattr(self, f.name)) for f in fields(self) if f.name not in ("extremes", "numbers")}
        own |= {"file": None if self.file is None else str(self.file), "order": list(self.order)}
        own["messages"] = list(self.messages)
        about = {"version": version("adaptimp")}
        own["numbers"] = {name: asdict(number) for name, number in self.numbers.items()}
        return json.dumps({**about, **own, "signals": signals}, indent=2, allow_nan=False)


def _known(value: object) -> object:
    """The value, or None for a number that JSON does not know."""
    return None if isinstance(value, float) and not math.isfinite(value) else value
