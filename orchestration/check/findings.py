"""Findings of a check of an FMU, each with the number of a rule, and the report that collects them.

A finding has one of three severities. An error makes an importer or a master fail or go wrong. A warning breaks the
standard or the checklist, but most importers get along. A note tells the user something worth knowing.
"""

import json
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from orchestration.errors import printable

MOST_ALIKE = 8  # findings that one rule may add; the rest are counted
LONGEST_NAME = 80  # characters of a stranger's name or value that are shown
ROLE = "role"  # in the place of a rule's number: the interface of a role


class Severity(StrEnum):
    """Severity of a finding, the worst first.

    Examples
    --------
    >>> from orchestration.check import Severity
    >>> [str(severity) for severity in Severity]
    ['error', 'warning', 'note']
    """

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True)
class Finding:
    """A rule that an FMU breaks, and how.

    Attributes
    ----------
    rule
        Id of the rule: a number, or a word such as ``role``; docs/check-rules.md lists all.
    message
        A sentence that names what is wrong and where.

    Examples
    --------
    >>> from orchestration.check import Finding, Severity
    >>> finding = Finding("12", Severity.WARNING, "Plant: the same run twice gives other outputs.")
    >>> f"{finding.severity}: {finding.message}"
    'warning: Plant: the same run twice gives other outputs.'
    """

    rule: str
    severity: Severity
    message: str

    def __post_init__(self) -> None:
        """Make the message safe to show; it may hold texts of the FMU."""
        object.__setattr__(self, "message", printable(self.message))


@dataclass(frozen=True)
class Report:
    """All findings of a check about one FMU file.

    Attributes
    ----------
    role
        Name of the role whose interface was compared; None if no interface was compared.
    facts
        Sentences about what was measured or not examined.
    confinement
        Measures that confined the binary; see `orchestration.sandbox.confinement`.

    Examples
    --------
    >>> from pathlib import Path
    >>> from orchestration.check import Finding, Report, Severity
    >>> report = Report(Path("Mine.fmu"), "controller", (Finding("role", Severity.ERROR, "There is no tau_cmd."),))
    >>> report.summary(), report.failed, report.count(Severity.NOTE)
    ('Mine.fmu, controller: 1 error', True, 0)
    >>> import json
    >>> json.loads(report.json())["findings"][0]["rule"]
    'role'
    """

    path: Path
    role: str | None = None
    findings: tuple[Finding, ...] = ()
    facts: tuple[str, ...] = ()
    confinement: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Make the facts safe to show; they may hold texts of the FMU."""
        object.__setattr__(self, "facts", tuple(map(printable, self.facts)))

    @property
    def failed(self) -> bool:
        """Whether any finding is an error."""
        return self.count(Severity.ERROR) > 0

    def count(self, severity: Severity) -> int:
        """Return the number of findings of a severity."""
        return sum(finding.severity == severity for finding in self.findings)

    def summary(self) -> str:
        """Return one line with the file, its role, and the number of findings of each severity."""
        counts = ", ".join(f"{n} {s}{'' if n == 1 else 's'}" for s in Severity if (n := self.count(s)))
        role = f", {self.role}" if self.role else ""
        return f"{printable(self.path.name)}{role}: {counts or 'no findings'}"

    def json(self) -> str:
        """Return the whole report as a JSON object."""
        content = {
            "file": str(self.path),
            "role": self.role,
            "findings": [{"rule": f.rule, "severity": f.severity, "message": f.message} for f in self.findings],
            "facts": list(self.facts),
            "confinement": list(self.confinement),
            **{f"{severity}s": self.count(severity) for severity in Severity},
        }
        return json.dumps(content, indent=2)


def error(rule: str, message: str) -> Finding:
    """Make a finding of severity error: it makes an importer or a master fail."""
    return Finding(rule, Severity.ERROR, message)


def warning(rule: str, message: str) -> Finding:
    """Make a finding of severity warning: most importers get along with it."""
    return Finding(rule, Severity.WARNING, message)


def note(rule: str, message: str) -> Finding:
    """Make a finding of severity note: a user should know of it."""
    return Finding(rule, Severity.NOTE, message)


def capped(findings: Iterable[Finding]) -> list[Finding]:
    """Keep at most `MOST_ALIKE` findings of one rule and severity, and add the number of the others."""
    kept: dict[Severity, list[Finding]] = {severity: [] for severity in Severity}
    counts = Counter[Severity]()
    for finding in findings:
        counts[finding.severity] += 1
        if counts[finding.severity] <= MOST_ALIKE:
            kept[finding.severity].append(finding)
    for severity, alike in kept.items():
        if counts[severity] > MOST_ALIKE:
            rest = f"There are {counts[severity] - MOST_ALIKE} more findings like these."
            alike.append(Finding(alike[0].rule, severity, rest))
    return [finding for alike in kept.values() for finding in alike]


def shown(text: object, most: int = LONGEST_NAME) -> str:
    """Return a text from an unknown FMU for use in a message: printable, and short."""
    return printable(text, most)


def listed(names: Sequence[str]) -> str:
    """Return the first names of a list as text, with the number of the other names."""
    more = f" and {len(names) - MOST_ALIKE} more" if len(names) > MOST_ALIKE else ""
    return ", ".join(map(shown, names[:MOST_ALIKE])) + more
