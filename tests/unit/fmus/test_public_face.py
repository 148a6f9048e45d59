"""The functions that declare the models of the catalog: each has an example in its docstring that runs."""

from functools import partial
from pathlib import Path
from typing import Any

import pytest

from fmus.catalog import MODELS, VARIANTS, model
from tests.unit.examples import failures, has_example

DECLARED = [declare.func if isinstance(declare, partial) else declare for declare in (MODELS | VARIANTS).values()]
FUNCTIONS: dict[str, Any] = {function.__name__: function for function in (*DECLARED, model)}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_examples_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert has_example(FUNCTIONS[name])
    assert failures(name, FUNCTIONS[name], tmp_path, monkeypatch) == ""
