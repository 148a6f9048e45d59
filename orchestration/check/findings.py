"""What a check found: findings with the number of the rule, facts that were measured, and the report of both.

A finding is an error if it makes an importer or a master fail or go wrong, a warning if the standard or
the checklist says otherwise but importers get along, a note if a user should merely know.
"""

import json
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

MOST_ALIKE = 8  # findings that one rule may add; the rest are counted
LONGEST_NAME = 80  # characters of a stranger's name or value that are shown
ROLE = "role"  # in the place of a rule's number: the interface of a role


class Severity(StrEnum):
    """How bad a finding is."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True)
class Finding:
    """One broken rule.

    Attributes
    ----------
    rule
        Number in the checklist, 1 to 16, or a word for what has no number, such as `ROLE`.
    message
        A sentence that names what and where.
    """

    rule: str
    severity: Severity
    message: str


@dataclass(frozen=True)
class Report:
    """All findings about a file.

    Attributes
    ----------
    role
        The role whose interface was compared, None if none was.
    facts
        Sentences about what was measured or not examined.
    """

    path: Path
    role: str | None = None
    findings: tuple[Finding, ...] = ()
    facts: tuple[str, ...] = ()

    @property
    def failed(self) -> bool:
        """Whether there is an error."""
        return self.count(Severity.ERROR) > 0

    def count(self, severity: Severity) -> int:
        """Number of findings of a severity."""
        return sum(finding.severity == severity for finding in self.findings)

    def summary(self) -> str:
        """One line: the file, its role, and how many findings of each severity."""
        counts = ", ".join(f"{n} {s}{'' if n == 1 else 's'}" for s in Severity if (n := self.count(s)))
        role = f", {self.role}" if self.role else ""
        return f"{self.path.name}{role}: {counts or 'no findings'}"

    def json(self) -> str:
        """Everything, as a JSON object."""
        content = {
            "file": str(self.path),
            "role": self.role,
            "findings": [{"rule": f.rule, "severity": f.severity, "message": f.message} for f in self.findings],
            "facts": list(self.facts),
            **{f"{severity}s": self.count(severity) for severity in Severity},
        }
        return json.dumps(content, indent=2)


def error(rule: str, message: str) -> Finding:
    """A finding that makes an importer or a master fail."""
    return Finding(rule, Severity.ERROR, message)


def warning(rule: str, message: str) -> Finding:
    """A finding that most importers get along with."""
    return Finding(rule, Severity.WARNING, message)


def note(rule: str, message: str) -> Finding:
    """A finding that a user should know of."""
    return Finding(rule, Severity.NOTE, message)


def capped(findings: Iterable[Finding]) -> list[Finding]:
    """At most `MOST_ALIKE` findings of one rule and severity, and the number of the others."""
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
    """A stranger's text in a message: printable, and short."""
    printable = str(text)[: most + 1].encode(errors="backslashreplace").decode()
    printable = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in printable)
    return printable if len(printable) <= most else f"{printable[: most - 3]}..."


def listed(names: Sequence[str]) -> str:
    """The first names of a list, and how many there are more."""
    more = f" and {len(names) - MOST_ALIKE} more" if len(names) > MOST_ALIKE else ""
    return ", ".join(map(shown, names[:MOST_ALIKE])) + more
