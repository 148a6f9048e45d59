"""Options of ``adaptimp run`` for what acts on a run from outside: ``--input``, ``--at`` and ``--pace``."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from orchestration.cli.isolation import IsolatingCommand
from orchestration.errors import SystemDescriptionError

AT = "--at"
HELD, LINEAR = "held", "linear"


class RunCommand(IsolatingCommand):
    """A command whose option ``--at`` takes two words, a time and what changes then."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the words of the command line, after each option got the one word that it takes."""
        return super().parse_args(ctx, joined(args))


def joined(words: Sequence[str]) -> list[str]:
    """Make one word of the two after each ``--at``, unless the first has both parts."""
    found: list[str] = []
    rest = list(words)
    while rest:
        word = rest.pop(0)
        if found[-1:] == [AT] and "=" not in word and rest and not rest[0].startswith("-"):
            word = f"{word} {rest.pop(0)}"
        found.append(word)
    return found


@dataclass(frozen=True)
class OutsideRequest:
    """What acts on a run from outside.

    Attributes
    ----------
    inputs
        Files with time series, ``FILE``, ``FILE:held`` or ``FILE:linear``.
    changes
        Texts ``TIME COMPONENT.VARIABLE=VALUE``, with the time in s.
    pace
        Simulated seconds per second; None for as fast as possible.
    """

    inputs: Sequence[str] = ()
    changes: Sequence[str] = ()
    pace: float | None = None

    def options(self, setting: Callable[[str], tuple[str, Any]]) -> dict[str, Any]:
        """Return what is asked for as fields of `orchestration.Options`.

        Parameters
        ----------
        setting
            Splits a text ``COMPONENT.VARIABLE=VALUE``.

        Raises
        ------
        SystemDescriptionError
            If a file, a time or a setting is wrong.
        """
        inputs, changes = self._inputs(), self._changes(setting)
        return {"inputs": inputs or None, "changes": changes or None, "pace": self.pace}

    def _inputs(self) -> dict[str, Any]:
        from orchestration.master.time_series import TimeSeries

        found: dict[str, Any] = {}
        for text in self.inputs:
            file, _, interpolation = text.rpartition(":")
            chosen = interpolation if file and interpolation in (HELD, LINEAR) else None
            for name, series in TimeSeries.read(file if chosen else text, interpolation=chosen).items():
                if name in found:
                    msg = f"--input {text}: {name} is given by another file too, {found[name].source}; give it once."
                    raise SystemDescriptionError(msg)
                found[name] = series
        return found

    def _changes(self, setting: Callable[[str], tuple[str, Any]]) -> dict[float, dict[str, Any]]:
        found: dict[float, dict[str, Any]] = {}
        for text in self.changes:
            time, _, change = text.strip().partition(" ")
            name, value = setting(change) if "=" in change else ("", None)
            if not (name and _is_time(time)):
                example = f"{AT} 0.5 controller.K=4000"
                msg = f"{AT} {text}: a time in s and COMPONENT.VARIABLE=VALUE are needed, as in {example}."
                raise SystemDescriptionError(msg)
            found.setdefault(float(time), {})[name] = value
        return found


def _is_time(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False
