"""The examples of docs/components.md run, in their order; the functions of its table exist."""

import importlib
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from orchestration import Fmu

PAGE = Path(__file__).parents[3] / "docs" / "components.md"
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
DOTTED = re.compile(r"`(fmus\.[\w.]+)`")


@pytest.fixture(scope="module")
def namespace() -> dict[str, Any]:
    """What is defined once all blocks have run; errors name lines of the page."""
    text = PAGE.read_text(encoding="utf-8")
    names: dict[str, Any] = {}
    for block in BLOCK.finditer(text):
        above = "\n" * text.count("\n", 0, block.start(1))
        exec(compile(above + block[1], str(PAGE), "exec"), names)
    return names


def test_examples_run(namespace: dict[str, Any]) -> None:
    assert {"H", "Y", "F_ext", "torques", "x_t", "law", "rows"} <= set(namespace)


def test_the_documented_test_passes(namespace: dict[str, Any], fmu_folder: Path) -> None:
    opened: list[Fmu] = []

    def fmu(path: str, **start: Any) -> Fmu:
        opened.append(Fmu(fmu_folder / Path(path).name, **start))
        return opened[-1]

    test: Callable[[Any], None] = namespace["test_torque_of_an_arm_at_rest_is_none"]
    try:
        test(fmu)
    finally:
        for driver in opened:
            driver.close()
    assert opened


@pytest.mark.parametrize("name", sorted(set(DOTTED.findall(PAGE.read_text(encoding="utf-8")))))
def test_functions_of_the_table_exist(name: str) -> None:
    parts = name.split(".")
    found: Any = importlib.import_module(".".join(parts[:2]))
    for part in parts[2:]:
        found = getattr(found, part)


def test_every_equation_of_the_paper_is_in_the_table() -> None:
    """(1) to (36), the last that has a number."""
    rows = [line.split("|")[1] for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| (")]
    found: set[int] = set()
    for row in rows:
        for first, last in re.findall(r"\((\d+)\)(?: to \((\d+)\))?", row):
            found |= set(range(int(first), int(last or first) + 1))
    assert found == set(range(1, 37))
