"""One wrong input: how it is provoked, and what its message must say."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from orchestration import OrchestrationError, Result, System

LONGEST = 300
"""Characters that a message may have."""
MOST_SENTENCES = 2
MOST_POINTS = 3
BUILD = "build mine.py --out ."
_END = re.compile(r"[.?!](?=\s+[A-Z]|$)")


@dataclass(frozen=True)
class Bench:
    """What a wrong input may be given to.

    Attributes
    ----------
    folder
        Empty folder, which is the working folder.
    fmus
        Folder with the FMU of every model.
    loop
        The control loop of Fig. 2, with a step of 1e-4 s and a stop time of 2 s.
    package
        The same loop as an SSP package.
    result
        The first ten steps of the loop, with every second row.
    """

    folder: Path
    fmus: Path
    loop: System
    package: Path
    result: Result

    def fmu(self, name: str) -> Path:
        """The FMU of a model."""
        return self.fmus / f"{name}.fmu"


Action = Callable[[Any], object]
"""Makes a mistake with a `Bench`. The argument has no type, so that type checkers let wrong types pass."""


def untyped(value: Any) -> Any:
    """The same value, of which type checkers know nothing, so that they let it be used wrongly."""
    return value


def made(kind: Any, *arguments: object, **options: object) -> Action:
    """An action that calls a class or a function with arguments whose types are not checked."""
    return lambda _: kind(*arguments, **options)


@dataclass(frozen=True)
class Wrong:
    """A wrong input and its message.

    Attributes
    ----------
    name
        What is wrong.
    provoke
        Function that makes the mistake, or a command line of ``adaptimp`` in which ``{package}`` and ``{fmus}``
        stand for those of the `Bench`. A function of `FILES` writes a file for `BUILD`.
    where, values, repair
        Words of the message that say what is wrong and where, the value given and the value possible, and what to
        do. Several words are separated by ``|``. Where a group is empty, the message says nothing of the kind.
    error
        Class of the error.
    code
        Exit code of a command.
    """

    name: str
    provoke: Action | str
    where: str
    values: str
    repair: str
    error: type[Exception] = OrchestrationError
    code: int = 2

    def act(self, bench: Bench) -> None:
        """Make the mistake, or write the file with the mistake."""
        assert callable(self.provoke)
        self.provoke(bench)

    @property
    def command(self) -> str:
        """The wrong command line."""
        return self.provoke if isinstance(self.provoke, str) else BUILD

    @property
    def asked(self) -> int:
        """Points of a message that has all words: one for each group of words."""
        return sum(map(bool, (self.where, self.values, self.repair)))

    def missing(self, message: str) -> list[str]:
        """Words that the message lacks."""
        words = [word for group in (self.where, self.values, self.repair) for word in group.split("|")]
        return [word for word in words if word not in message]


def flaws(message: str) -> list[str]:
    """What is wrong with the form of a message, whatever it says."""
    found = []
    if not message:
        found.append("it is empty")
    if len(message) > LONGEST:
        found.append(f"it has {len(message)} characters")
    if len(_END.findall(message)) > MOST_SENTENCES:
        found.append("it has more than two sentences")
    if "\n" in message.strip():
        found.append("it has several lines")
    if "Traceback" in message:
        found.append("it has a traceback")
    return found
