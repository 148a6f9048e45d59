"""Runs the examples in docstrings: those of a class and of its methods, or of a function."""

import doctest
from pathlib import Path
from typing import Any

import pytest

OPTIONS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS


def examples(name: str, found: Any) -> list[doctest.DocTest]:
    """Docstrings with examples of a public name, its methods included."""
    return [test for test in doctest.DocTestFinder().find(found, name, globs={}) if test.examples]


def has_example(found: Any) -> bool:
    """Whether the docstring itself of a class, a function or a method holds an example."""
    return ">>>" in (found.__doc__ or "")


def failures(name: str, found: Any, folder: Path, patch: pytest.MonkeyPatch) -> str:
    """What differs from the examples when they are run in an empty folder; empty if nothing does."""
    patch.chdir(folder)
    patch.setenv("MPLBACKEND", "Agg")
    said: list[str] = []
    for test in examples(name, found):
        doctest.DocTestRunner(optionflags=OPTIONS).run(test, out=said.append)
    return "".join(said)
