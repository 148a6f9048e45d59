"""The functions that declare the models of the catalog: each has an example in its docstring that runs."""

from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

from fmus.catalog import MODELS, UNITS_OF_ARM, VARIANTS, model
from tests.unit.examples import failures, has_example

_FIRST = {declare.args[0] for declare in (MODELS | VARIANTS).values() if isinstance(declare, partial)}
MODULES = sorted({UNITS_OF_ARM[name] if name in UNITS_OF_ARM else name for name in _FIRST})
"""Modules that the catalog imports when a model is declared; each has a function of its name."""
FUNCTIONS: dict[str, Any] = {name: getattr(import_module(f"fmus.{name}"), name) for name in MODULES} | {"model": model}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_examples_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert has_example(FUNCTIONS[name])
    assert failures(name, FUNCTIONS[name], tmp_path, monkeypatch) == ""
