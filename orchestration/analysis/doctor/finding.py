"""A finding of an examination: what was seen, how bad it is, and what to do about it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any


class Severity(StrEnum):
    """How bad a finding is, the worst first.

    An error says that the results are wrong or that there are none. A warning says that they may be wrong. A note is
    worth knowing.
    """

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True)
class Finding:
    """Something that an examination has found.

    Attributes
    ----------
    id
        Word that names the kind of finding, such as ``stability``; docs/doctor.md lists them.
    severity
        How bad it is.
    subject
        Component, variable or connection that it is about; the name of the system if it is about the whole.
    sentence
        What was found, with the numbers that matter.
    figures
        These numbers by name, in SI units.
    advice
        What to do, as a sentence; empty if there is nothing to do.
    command
        Command or Python expression that does it; empty if there is none.

    Examples
    --------
    >>> from orchestration import diagnose, scenario
    >>> steel = scenario("fig2").set({"plant.K_f": 1e8})  # N/m
    >>> finding = diagnose(steel, stop_time=0.1).findings[0]
    >>> finding.id, finding.severity.value, finding.subject, finding.advice
    ('stiffness', 'warning', 'plant.dt_max', 'Set plant.dt_max to 5e-06 s or less.')
    >>> print(finding.command)
    simulate(system.set({'plant.dt_max': 5e-06}), stop_time=0.1, step=0.0001)
    """

    id: str
    severity: Severity
    subject: str
    sentence: str
    figures: Mapping[str, Any] = field(default_factory=dict)
    advice: str = ""
    command: str = ""


def listed(names: "list[str] | tuple[str, ...]", most: int = 4) -> str:
    """The first names of a list as text, and how many others there are."""
    shown = ", ".join(names[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"


def percent(share: float) -> str:
    """A share as text: 0.3 %, 12 %, 2.1e-05 %."""
    return f"{100 * share:.2g} %" if share < 1 else f"{100 * share:.3g} %"


def counted(n: int, thing: str, verb: str = "", verbs: str = "") -> str:
    """A number of things, and what they do: 1 signal arrives, 3 signals arrive."""
    return " ".join(filter(None, (str(n), thing, verb) if n == 1 else (str(n), f"{thing}s", verbs)))
