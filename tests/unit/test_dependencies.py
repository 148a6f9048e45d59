"""What the packages import is what pyproject.toml declares, neither less nor more."""

import ast
import itertools
import re
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

from adaptimp_fmu.files.parts import GIVES, PARTS

ROOT = Path(__file__).parents[2]
PACKAGES = ("adaptimp_fmu", "fmus", "orchestration")
FOR_TESTS = {"pytest"}  # the part "test"; orchestration.fmi.testing is for people who have it


def imported() -> set[str]:
    """Names of the distributions that the packages import, anywhere in their code."""
    found: set[str] = set()
    for path in (path for package in PACKAGES for path in (ROOT / package).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                found |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                found.add((node.module or "").partition(".")[0])
    outside = found - set(sys.stdlib_module_names) - set(PACKAGES)
    distributions = packages_distributions()
    return {distributions[name][0].lower() for name in outside if name in distributions}


def test_imports_are_declared_and_declarations_are_imported() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lines = itertools.chain(project["dependencies"], *project["optional-dependencies"].values())
    declared = {re.split(r"[<>=!~;\[ ]", line)[0].lower() for line in lines}
    assert imported() | FOR_TESTS == declared


def test_the_part_of_a_package_brings_it() -> None:
    parts = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    assert {package: part for package, part in PARTS.items() if package not in " ".join(parts[part])} == {}
    assert set(PARTS.values()) | {"paper"} == set(GIVES) == set(parts) - {"test"}
