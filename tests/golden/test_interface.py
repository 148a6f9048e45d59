"""The interface of two FMUs, one of each kind: XML and C tables, without the equations."""

import re
from collections.abc import Callable

import pytest

from adaptimp_fmu.package import definition
from fmus.catalog import MODELS

GUID = re.compile(r"\{[0-9a-f]{8}(?:-[0-9a-f]{4}){3}-[0-9a-f]{12}\}")


def masked(text: str) -> str:
    """The text without its GUID, which changes with every equation."""
    text, n = GUID.subn("{guid}", text)
    assert n == 1, "one GUID in each file"
    return text


@pytest.mark.parametrize("unit", ["Plant", "HoganImpedance"])
def test_model_description(unit: str, assert_golden: Callable[[str, str], None]) -> None:
    _, description = definition(MODELS[unit]())
    assert_golden(f"{unit}.xml", masked(description.decode()))


@pytest.mark.parametrize("unit", ["Plant", "HoganImpedance"])
def test_tables(unit: str, assert_golden: Callable[[str, str], None]) -> None:
    sources, _ = definition(MODELS[unit]())
    assert_golden(f"{unit}.c", masked(sources["model.c"]))
