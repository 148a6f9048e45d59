"""Reads texts such as NAME=VALUE, which options of the command line take."""

import re
from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from orchestration.errors import SystemDescriptionError
from orchestration.system.system import System

Number = TypeVar("Number", int, float)
_SETTING = re.compile(r"([^=\s]+)=(.*)", re.DOTALL)
MOST_COMMAS = 8
"""Commas that the name of a variable may have, besides those in brackets, to be found in a list of names."""
_COMMA = re.compile(r",(?![^\[]*\])")  # a comma within brackets is part of a name


def setting_of(option: str, needed: str = "NAME=VALUE is needed") -> Callable[[str], tuple[str, str]]:
    """Return a function that splits a text NAME=VALUE of an option; `needed` ends the sentence of an error."""

    def split(text: str) -> tuple[str, str]:
        match = _SETTING.fullmatch(text)
        if match is None:
            msg = f"{option} {text}: {needed}."
            raise SystemDescriptionError(msg)
        return match[1], match[2]

    return split


def start_value(text: str, system: System | None = None) -> tuple[str, str | list[str]]:
    """Name and value of ``--set``; a value in brackets is a list.

    A name that the system knows may have any character, such as ``=`` or a blank.
    """
    name, value = _known_setting(text, system) or _START(text)
    inner = value.strip()
    if inner.startswith("[") and inner.endswith("]"):
        return name, [element.strip() for element in inner[1:-1].split(",")]
    return name, value


def _known_setting(text: str, system: System | None) -> tuple[str, str] | None:
    """Name and value of a text NAME=VALUE with a name that the system knows; None if there is no such name."""
    for match in re.finditer("=", text) if system is not None else ():
        name = text[: match.start()].strip()
        if _knows(system, name):
            return name, text[match.end() :]
    return None


def _knows(system: System | None, path: str) -> bool:
    """Whether a system has the variable, or the array, of a path."""
    component, _, variable = path.partition(".")
    return system is not None and component in system and variable in system.component(component)


def numbers(option: str, texts: Sequence[str], kind: type[Number]) -> dict[str, Number]:
    """Numbers by name from texts NAME=NUMBER of an option.

    Raises
    ------
    SystemDescriptionError
        If a text has another form, or its number is not of that kind.
    """
    return {name: number(option, value, kind) for name, value in map(setting_of(option), texts)}


def number(option: str, text: str, kind: type[Number]) -> Number:
    """A number of an option.

    Raises
    ------
    SystemDescriptionError
        If the text is not a number of that kind.
    """
    try:
        return kind(text)
    except ValueError:
        msg = f"{option}: {text!r} is not {'an integer' if kind is int else 'a number'}."
        raise SystemDescriptionError(msg) from None


def listed(texts: Sequence[str] | None, system: System | None = None) -> list[str] | None:
    """Names and patterns of an option that may be given several times with several names each; None if it is not.

    A comma separates names, unless it stands within brackets or within a name that the system knows.
    """
    if not texts:
        return None
    return [name for text in texts for name in _names(_COMMA.split(text), system)]


def _names(pieces: Sequence[str], system: System | None) -> Iterator[str]:
    """Names of which pieces of text are parts; the longest known one first."""
    done = 0
    while done < len(pieces):
        ends = range(min(len(pieces), done + MOST_COMMAS + 1), done + 1, -1)
        joined = ((end, ",".join(pieces[done:end]).strip()) for end in ends)
        done, name = next((found for found in joined if _knows(system, found[1])), (done + 1, pieces[done].strip()))
        if name:
            yield name


_START = setting_of("--set", "COMPONENT.VARIABLE=VALUE is needed, such as controller.K[1]=4000")
