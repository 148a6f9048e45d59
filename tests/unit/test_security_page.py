"""docs/security.md names every dependency with its range, and the limits that the code has."""

import itertools
import re
import tomllib
from importlib import import_module
from pathlib import Path

REPOSITORY = Path(__file__).parents[2]
PAGE = (REPOSITORY / "docs" / "security.md").read_text(encoding="utf-8")


def test_every_dependency_has_its_reason() -> None:
    project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    rows = re.findall(r"^\| `([^`]+)` \| [^|]+ \| [^|]+ \|$", PAGE, re.MULTILINE)
    parts = itertools.chain(*project["optional-dependencies"].values())  # a package may be in several
    assert rows == list(dict.fromkeys([*project["dependencies"], *parts]))


def test_limits_are_those_of_the_code() -> None:
    rows = re.findall(r"^\| [^|]+ \| ([\d.]+) \| `orchestration\.([\w.]+)` \|$", PAGE, re.MULTILINE)
    assert len(rows) > 15
    for number, name in rows:
        module, _, attribute = name.rpartition(".")
        owner = import_module(f"orchestration.{module}") if module.islower() else _public(module)
        assert float(number) == getattr(owner, attribute), name


def _public(name: str) -> object:
    return getattr(import_module("orchestration"), name)
