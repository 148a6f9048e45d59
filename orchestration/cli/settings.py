"""Reads texts such as NAME=VALUE, which options of the command line take."""

import re
from collections.abc import Callable, Sequence
from typing import TypeVar

from orchestration.errors import SystemDescriptionError

Number = TypeVar("Number", int, float)
_SETTING = re.compile(r"([^=\s]+)=(.*)", re.DOTALL)
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


def start_value(text: str) -> tuple[str, str | list[str]]:
    """Name and value of ``--set``; a value in brackets is a list."""
    name, value = setting_of("--set", "COMPONENT.VARIABLE=VALUE is needed, such as controller.K[1]=4000")(text)
    inner = value.strip()
    if inner.startswith("[") and inner.endswith("]"):
        return name, [element.strip() for element in inner[1:-1].split(",")]
    return name, value


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


def listed(texts: Sequence[str] | None) -> list[str] | None:
    """Names and patterns of an option that may be given several times with several names each; None if it is not."""
    if not texts:
        return None
    return [name.strip() for text in texts for name in _COMMA.split(text) if name.strip()]
