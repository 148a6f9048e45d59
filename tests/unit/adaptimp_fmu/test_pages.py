"""Tests of formulas as MathML, of drawings as SVG, and of what descriptions have in common."""

from collections.abc import Callable

import pytest
from lxml import etree

from adaptimp_fmu import Model
from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.mathml import mathml
from adaptimp_fmu.names import common_beginning
from adaptimp_fmu.svg import Picture
from fmus.catalog import MODELS, VARIANTS

MATHML = "{http://www.w3.org/1998/Math/MathML}"


def test_formula_becomes_elements() -> None:
    root = etree.fromstring(mathml(r"\frac{a}{b} < \hat{F}"))
    assert root.tag == f"{MATHML}math"
    fraction = root.find(f".//{MATHML}mfrac")
    assert fraction is not None
    assert [part.xpath("string()") for part in fraction] == ["a", "b"]
    assert "<" in root.xpath("string()")


@pytest.mark.parametrize("wrong", [r"\frac{a}", r"\nosuchcommand x", r"{a", r"a_"])
def test_what_is_not_a_formula_is_refused(wrong: str) -> None:
    with pytest.raises(DefinitionError, match="Formula"):
        mathml(wrong)


@pytest.mark.parametrize("declare", [*MODELS.values(), *VARIANTS.values()], ids=[*MODELS, *VARIANTS])
def test_drawings_are_svg_with_a_title(declare: Callable[[], Model]) -> None:
    guide = declare().guide
    for drawing in (*guide.place, *guide.drawings):
        root = etree.fromstring(drawing.svg)
        width, height = float(root.attrib["width"]), float(root.attrib["height"])
        title = root.find("{http://www.w3.org/2000/svg}title")
        assert title is not None
        assert title.text == root.get("aria-label")
        for element in root.iter("{http://www.w3.org/2000/svg}polyline", "{http://www.w3.org/2000/svg}polygon"):
            for point in element.attrib["points"].split():
                x, y = map(float, point.split(","))
                assert 0 <= x <= width, drawing.caption
                assert 0 <= y <= height, drawing.caption


def test_subscripts_are_lowered_and_raised_again() -> None:
    picture = Picture(10, 10, "a < b")
    picture.text((0, 5), "x_v, <dx_v> now")
    root = etree.fromstring(picture.svg())
    text = root.find("{http://www.w3.org/2000/svg}text")
    assert text is not None
    assert text.xpath("string()") == "xv, <dxv> now"
    shifts = [float(part.get("dy", 0)) for part in text]
    assert max(shifts) > 0
    assert sum(shifts) == 0


def test_common_beginning_has_whole_words() -> None:
    assert common_beginning(["Position along x1 (right)", "Position along x2 (up)"]) == "Position"
    assert common_beginning(["Mass of link 1", "Friction of link 1"]) == ""
    assert common_beginning(["Depth"]) == "Depth"
