"""The public names of orchestration: they are listed, and each has an example in its docstring that runs."""

from pathlib import Path
from types import FunctionType, ModuleType

import pytest

import orchestration
import orchestration.check
import orchestration.ssp
from tests.unit.examples import failures, has_example, unexplained

PUBLIC = {name: getattr(orchestration, name) for name in orchestration.__all__}
CLASSES = {name: found for name, found in PUBLIC.items() if isinstance(found, type)}
FURTHER = [(package, name) for package in (orchestration.check, orchestration.ssp) for name in package.__all__]
"""Public names of rooms that are not in the table of the package itself."""


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


@pytest.mark.parametrize(("package", "name"), FURTHER)
def test_examples_of_further_names_run(
    package: ModuleType, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = getattr(package, name)
    if name == "Trial":  # a type of functions, which has no docstring of its own
        assert not isinstance(found, type)
        return
    assert has_example(found)
    assert not isinstance(found, type) or unexplained(found) == []
    assert failures(name, found, tmp_path, monkeypatch) == ""


@pytest.mark.parametrize("name", CLASSES)
def test_every_method_is_in_an_example(name: str) -> None:
    assert unexplained(CLASSES[name]) == []


def test_a_method_without_an_example_is_noticed() -> None:
    class Owner:
        """Has methods.

        >>> Owner().shown
        """

        def shown(self) -> None: ...
        def missing(self) -> None: ...
        @property
        def lacking(self) -> None: ...
        @classmethod
        def forgotten(cls) -> None: ...
        def _private(self) -> None: ...

    Owner.__module__ = "orchestration.mine"
    assert unexplained(Owner) == ["missing", "lacking", "forgotten"]


def test_an_example_that_shows_something_else_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong() -> None:
        """A wrong sum.

        >>> 1 + 1
        3
        """

    assert "Got:\n    2" in failures("wrong", wrong, tmp_path, monkeypatch)
