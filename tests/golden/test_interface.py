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


@pytest.mark.parametrize("identifier", ["Plant", "HoganImpedance"])
def test_model_description(identifier: str, assert_golden: Callable[[str, str], None]) -> None:
    _, description = definition(MODELS[identifier]())
    assert_golden(f"{identifier}.xml", masked(description.decode()))


@pytest.mark.parametrize("identifier", ["Plant", "HoganImpedance"])
def test_tables(identifier: str, assert_golden: Callable[[str, str], None]) -> None:
    sources, _ = definition(MODELS[identifier]())
    assert_golden(f"{identifier}.c", masked(sources["model.c"]))
    assert_golden(f"{identifier}.h", sources["sizes.h"])
