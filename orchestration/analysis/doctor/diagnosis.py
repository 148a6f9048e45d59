"""What an examination of a co-simulation found, as text, as JSON and for notebooks."""

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from orchestration.analysis.doctor.finding import Finding, Severity, counted
from orchestration.analysis.doctor.study import SignalError
from orchestration.fmi.display import escaped


@dataclass(frozen=True, repr=False)
class Diagnosis:
    """What an examination of a co-simulation found; see `diagnose`.

    Attributes
    ----------
    system, algorithm
        Names of the system and of the algorithm.
    step, stop_time
        Communication step and stop time that were examined, s.
    findings
        Findings, the worst first.
    signals
        Estimated error of each Real output that comes from the step, the largest share of its range first. Empty if
        the runs with halved steps failed.

    Examples
    --------
    >>> from orchestration import diagnose, scenario
    >>> diagnosis = diagnose(scenario("fig2"), stop_time=0.2)
    >>> diagnosis
    <Diagnosis of fig2, gauss-seidel with a step of 0.0001 s: 0 errors, 0 warnings, ... notes>
    >>> diagnosis.healthy, diagnosis.of("stability").severity
    (True, <Severity.NOTE: 'note'>)
    >>> diagnosis.worst, diagnosis.count(diagnosis.worst) == len(diagnosis.findings), diagnosis.counts[:20]
    (<Severity.NOTE: 'note'>, True, '0 errors, 0 warnings')
    >>> import json
    >>> json.loads(diagnosis.json()) == diagnosis.as_dict()
    True
    """

    system: str
    algorithm: str
    step: float
    stop_time: float
    findings: tuple[Finding, ...]
    signals: tuple[SignalError, ...] = ()

    @property
    def healthy(self) -> bool:
        """Whether there is nothing worse than notes."""
        return all(finding.severity is Severity.NOTE for finding in self.findings)

    @property
    def worst(self) -> Severity:
        """Severity of the worst finding; a note if there is none."""
        return self.findings[0].severity if self.findings else Severity.NOTE

    @property
    def counts(self) -> str:
        """Numbers of findings as text, such as ``0 errors, 1 warning, 5 notes``."""
        return ", ".join(counted(self.count(severity), severity) for severity in Severity)

    def count(self, severity: Severity) -> int:
        """Number of findings of a severity."""
        return sum(finding.severity is severity for finding in self.findings)

    def of(self, id_: str) -> Finding | None:
        """The worst finding of a kind, such as ``stability``; None if there is none."""
        return next((finding for finding in self.findings if finding.id == id_), None)

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain values that JSON knows; docs/doctor.md lists the keys."""
        return {
            "system": self.system,
            "algorithm": self.algorithm,
            "step": self.step,
            "stop_time": self.stop_time,
            "worst": str(self.worst),
            **{f"{severity}s": self.count(severity) for severity in Severity},
            "findings": [_plain(asdict(finding)) for finding in self.findings],
            "signals": [_plain(asdict(signal)) for signal in self.signals],
        }

    def json(self) -> str:
        """Everything as one JSON object."""
        return json.dumps(self.as_dict(), indent=2, allow_nan=False)

    def __repr__(self) -> str:
        """System, algorithm, step and number of findings in one line."""
        return f"<Diagnosis of {self._what()}: {self.counts}>"

    def __str__(self) -> str:
        """Findings as several lines of text."""
        lines = [f"{self._what()}, {self.stop_time:g} s"]
        for f in self.findings:
            lines.append(f"{f.severity}: {f.id}, {f.subject}: {f.sentence}")
            lines += [f"    {text}" for text in (f.advice, f.command) if text]
        return "\n".join(lines)

    def _what(self) -> str:
        return f"{self.system}, {self.algorithm} with a step of {self.step:g} s"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{f.severity}</td><td>{escaped(f.id)}</td><td>{escaped(f.subject)}</td>"
            f"<td style='text-align:left'>{escaped(f.sentence)} {escaped(f.advice)}"
            f"{f'<br><code>{escaped(f.command)}</code>' if f.command else ''}</td></tr>"
            for f in self.findings
        )
        head = "<tr><th></th><th>kind</th><th>subject</th><th>finding</th></tr>"
        return f"<p>{escaped(repr(self)[1:-1])}</p><table>{head}{rows}</table>"


def sorted_by_severity(findings: list[Finding]) -> tuple[Finding, ...]:
    """Findings with the worst first; those of the same severity stay in their order."""
    ranks = {severity: i for i, severity in enumerate(Severity)}
    return tuple(sorted(findings, key=lambda finding: ranks[finding.severity]))


def _plain(value: Any) -> Any:
    """The value with texts for items of enumerations, and None for numbers that JSON does not know."""
    if isinstance(value, Mapping):
        return {str(key): _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return str(value) if isinstance(value, str) else value
