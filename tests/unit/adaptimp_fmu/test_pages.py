"""Tests of formulas as MathML, of drawings as SVG, and of what descriptions have in common."""

import html
import re
from collections.abc import Callable

import pytest
from lxml import etree

from adaptimp_fmu import Grid, Guide, Model, SampledModel
from adaptimp_fmu.documentation import documentation
from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.grids import laid_out, legends
from adaptimp_fmu.mathml import mathml
from adaptimp_fmu.names import as_one, common_beginning
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


def test_what_differs_is_listed_between_what_is_common() -> None:
    turns = ["Angle of the tip in roll", "Angle of the tip in pitch", "Angle of the tip in yaw"]
    assert as_one(turns) == "Angle of the tip in roll, pitch, yaw"
    assert as_one(["m of a", "m of b c", "m of b"]) == "m of a, b c, b"
    assert as_one(["same text", "same text"]) == "same text"
    assert as_one(["one", "two"]) == "one, two"


def test_grid_makes_a_table_of_rows_with_the_same_columns() -> None:
    """Rows that come again later, as viscous and Coulomb friction of a joint, are one row."""
    model = SampledModel("Arm", "Two joints and a payload")
    texts = ["Assumed mass of a", "Assumed friction of j", "Assumed stiction of j", "Assumed mass of the payload"]
    model.parameter("p", [1.0, 2.0, 3.0, 4.0], unit=["kg", "N.m", "N", "kg"], description=texts)
    places = [("a", "m"), ("j", "viscous"), ("j", "Coulomb"), ("payload", "m")]
    model.guide = Guide(grids=[Grid(["p", "none"], places, "parameters of the arm", "A body in each row.")])
    (laid,) = laid_out(model, model.variables)
    assert laid.text == "Assumed parameters of the arm"
    assert legends(model) == ["A body in each row."]
    masses, friction = laid.tables
    assert masses.heads == [("m", "kg")]
    assert [(row, [(cell.name, cell.start) for cell in cells]) for row, cells in masses.rows] == [
        ("a", [("p[1]", "1")]),
        ("payload", [("p[4]", "4")]),
    ]
    assert friction.heads == [("viscous", "N.m"), ("Coulomb", "N")]


def test_unit_stands_in_the_cell_where_those_of_a_column_differ() -> None:
    model = SampledModel("Arm", "Two joints")
    model.parameter("p", [1.0, 2.0], unit=["N.m", "N"], description=["of a", "of b"])
    model.guide = Guide(grids=[Grid(["p"], [("a", "f"), ("b", "f")], "friction")])
    (table,) = laid_out(model, model.variables)[0].tables
    assert table.heads == [("f", "")]
    assert [cells[0].unit for _, cells in table.rows] == ["N.m", "N"]


def test_grid_with_fewer_places_than_elements_is_an_error() -> None:
    model = SampledModel("Arm", "Two joints")
    model.parameter("p", [1.0, 2.0], description=["of a", "of b"])
    model.guide = Guide(grids=[Grid(["p"], [("a", "f")], "friction")])
    with pytest.raises(DefinitionError, match=r"p has 2 elements, but its grid has places for 1"):
        laid_out(model, model.variables)


def test_demands_that_many_elements_share_stand_once() -> None:
    """Up to nine sentences that differ in an index alone, and up to three that are the same, stand as they are."""
    model = SampledModel("Arm", "Many joints")
    p = model.parameter("p", [1.0] * 10, description=[f"Of joint {i + 1}" for i in range(10)])
    for i in range(10):
        model.require(p[i] + 2, f"p[{i + 1}] must exceed -2")
    for i in range(9):
        model.require(p[i] + 3, f"p[{i + 1}] must exceed -3")
    for times, sentence in ((4, "often"), (3, "thrice")):
        for i in range(times):
            model.require(p[i] + 4, sentence)
    found = re.findall(r"<li>Demand: (.*?)\.</li>", documentation(model)["index.html"].decode())
    expected = ["p[i] must exceed -2, for each i", *(f"p[{i}] must exceed -3" for i in range(1, 10)), "often"]
    assert [html.unescape(sentence) for sentence in found] == [*expected, *["thrice"] * 3]
