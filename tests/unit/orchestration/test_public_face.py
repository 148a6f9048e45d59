"""The public names of orchestration: they are listed, and each has an example in its docstring that runs."""

from pathlib import Path
from types import FunctionType

import pytest

import orchestration
from orchestration import Component, Fmu, Result, Study, System
from tests.unit.examples import failures, has_example

PUBLIC = {name: getattr(orchestration, name) for name in orchestration.__all__}
METHODS = {
    System: ["of", "connect", "set", "replace", "to_c", "to_wasm"],
    Component: ["read"],
    Result: ["at_ticks", "measure", "to_pandas", "to_xarray", "plot", "write", "read"],
    Fmu: ["outputs", "set", "step", "drive", "save"],
    Study: ["grid", "seeds", "samples", "run", "result", "traces", "evaluate", "resume"],
}


def test_dir_lists_the_public_names() -> None:
    assert dir(orchestration) == sorted(orchestration.__all__)
    assert orchestration.__all__ == sorted(orchestration.__all__, key=lambda name: (name[0].islower(), name))


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_name_says_what_it_is(name: str) -> None:
    found = PUBLIC[name]
    assert isinstance(found, type | FunctionType)
    assert found.__doc__
    assert found.__doc__.strip().splitlines()[0].endswith(".")


@pytest.mark.parametrize("name", PUBLIC)
def test_examples_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert has_example(PUBLIC[name])
    assert failures(name, PUBLIC[name], tmp_path, monkeypatch) == ""


@pytest.mark.parametrize(("owner", "method"), [(owner, name) for owner, names in METHODS.items() for name in names])
def test_methods_that_are_used_most_have_an_example(owner: type, method: str) -> None:
    assert has_example(getattr(owner, method))


def test_an_example_that_shows_something_else_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong() -> None:
        """A wrong sum.

        >>> 1 + 1
        3
        """

    assert "Got:\n    2" in failures("wrong", wrong, tmp_path, monkeypatch)
