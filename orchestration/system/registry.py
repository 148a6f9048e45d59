"""Where a system finds what is built on top of it: file formats by suffix, analyses by name.

An entry is the text ``module:function``. Its module is imported on first use, so that the description of a system
depends on none of them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Format:
    """A file format of systems.

    Attributes
    ----------
    read
        Takes a path and returns a `System`.
    write
        Takes a `System` and a path, and returns the path.
    """

    read: str
    write: str


SSP = Format("orchestration.ssp.read:read_ssp", "orchestration.ssp.write:write_ssp")
FORMATS: dict[str, Format] = {".ssp": SSP}
"""File formats by suffix; a path with another suffix is taken for an SSP package."""

ANALYSES: dict[str, str] = {"stability": "orchestration.analysis.stability.verdict:stability"}
"""Analyses by the name of the method that calls them; each takes a `System` first."""


def reader(path: Path) -> Callable[..., Any]:
    """The function that reads a system from a file of this suffix."""
    return _load(FORMATS.get(path.suffix.lower(), SSP).read)


def writer(path: Path) -> Callable[..., Any]:
    """The function that writes a system to a file of this suffix."""
    return _load(FORMATS.get(path.suffix.lower(), SSP).write)


def analysis(name: str) -> Callable[..., Any]:
    """The function of an analysis."""
    return _load(ANALYSES[name])


def _load(entry: str) -> Callable[..., Any]:
    module, _, function = entry.partition(":")
    return getattr(import_module(module), function)
