"""The public names of orchestration: they are listed, and the examples in their docstrings run."""

import doctest
from types import FunctionType

import pytest

import orchestration

PUBLIC = {name: getattr(orchestration, name) for name in orchestration.__all__}
WITH_EXAMPLES = sorted(name for name, found in PUBLIC.items() if ">>>" in (found.__doc__ or ""))


def test_dir_lists_the_public_names() -> None:
    assert dir(orchestration) == sorted(orchestration.__all__)
    assert orchestration.__all__ == sorted(orchestration.__all__, key=lambda name: (name[0].islower(), name))


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_name_says_what_it_is(name: str) -> None:
    found = PUBLIC[name]
    assert isinstance(found, type | FunctionType)
    assert found.__doc__
    assert found.__doc__.strip().splitlines()[0].endswith(".")


@pytest.mark.parametrize("name", WITH_EXAMPLES)
def test_examples_run(name: str) -> None:
    found = PUBLIC[name]
    tests = doctest.DocTestFinder(recurse=False).find(found, name, globs={})
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    for test in tests:
        runner.run(test)
    assert runner.summarize(verbose=False).attempted > 0
    assert runner.summarize(verbose=False).failed == 0
