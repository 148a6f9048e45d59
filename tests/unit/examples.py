"""Runs the examples in docstrings: those of a class and of its methods, or of a function."""

import ast
import doctest
import inspect
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

PACKAGES = ("adaptimp_fmu", "fmus", "orchestration")
OPTIONS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS


def examples(name: str, found: Any) -> list[doctest.DocTest]:
    """Docstrings with examples of a public name, its methods included, also those that a class inherits."""
    bases = [base for base in getattr(found, "__mro__", ()) if base.__module__.partition(".")[0] in PACKAGES]
    places = bases or [found]
    finder = doctest.DocTestFinder()
    return [test for place in places for test in finder.find(place, name, globs={}) if test.examples]


def has_example(found: Any) -> bool:
    """Whether the docstring itself of a class, a function or a method holds an example."""
    return ">>>" in (found.__doc__ or "")


def public_members(owner: type) -> Iterator[tuple[type, str, Any]]:
    """Public methods and properties of a class that this project wrote: the class that has each, its name, itself."""
    seen: set[str] = set()
    for base in owner.__mro__:
        if base.__module__.partition(".")[0] not in PACKAGES:
            continue
        for name, found in vars(base).items():
            asked = getattr(found, "fget", None) or getattr(found, "func", None) or getattr(found, "__func__", found)
            if not name.startswith("_") and name not in seen and inspect.isfunction(asked):
                seen.add(name)
                yield base, name, asked


def used(docstring: str) -> set[str]:
    """Names of the attributes that the examples of a docstring use."""
    parsed = doctest.DocTestParser().get_examples(docstring)
    trees = [ast.walk(ast.parse(example.source)) for example in parsed]
    return {node.attr for tree in trees for node in tree if isinstance(node, ast.Attribute)}


def unexplained(owner: type) -> list[str]:
    """Public members that no example uses which ``help`` of the class shows."""
    return [
        name
        for base, name, found in public_members(owner)
        if not has_example(found) and name not in used(f"{owner.__doc__}\n{base.__doc__}")
    ]


def failures(name: str, found: Any, folder: Path, patch: pytest.MonkeyPatch) -> str:
    """What differs from the examples when they are run in an empty folder; empty if nothing does."""
    patch.chdir(folder)
    patch.setenv("MPLBACKEND", "Agg")
    said: list[str] = []
    for test in examples(name, found):
        doctest.DocTestRunner(optionflags=OPTIONS).run(test, out=said.append)
    return "".join(said)
