"""The public names of adaptimp_fmu: each class and function has an example in its docstring that runs."""

from pathlib import Path
from types import FunctionType

import pytest

import adaptimp_fmu
from tests.unit.examples import failures, has_example, unexplained

FOUND = {name: getattr(adaptimp_fmu, name) for name in adaptimp_fmu.__all__}
EXPLAINED = {name: found for name, found in FOUND.items() if isinstance(found, type | FunctionType)}
CLASSES = {name: found for name, found in FOUND.items() if isinstance(found, type)}


def test_other_names_are_constants() -> None:
    """Python shows the docstring of their class."""
    assert sorted(set(FOUND) - set(EXPLAINED)) == ["ANY", "NOT_NEGATIVE", "PLATFORMS", "POSITIVE"]


@pytest.mark.parametrize("name", EXPLAINED)
def test_examples_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert has_example(EXPLAINED[name])
    assert failures(name, EXPLAINED[name], tmp_path, monkeypatch) == ""


@pytest.mark.parametrize("name", CLASSES)
def test_every_method_is_in_an_example(name: str) -> None:
    assert unexplained(CLASSES[name]) == []
