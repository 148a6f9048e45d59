"""Drawings of arms in space: every label can be read, for arms of six to eight joints."""

import math
import re
from collections.abc import Sequence

import numpy as np
import pytest
from lxml import etree

from adaptimp_fmu import Drawing
from fmus.drawings.spatial_arm import Wall, spatial_arm
from fmus.drawings.spatial_path import spatial_path
from fmus.drawings.view import View
from fmus.mechanics.spatial_arm import SpatialArm
from fmus.robots.puma560 import PUMA
from tests.property.robots import chain

POSES: dict[str, Sequence[float]] = {
    "UR5": (0.3, -1.2, 1.6, -1.9, -1.57, 0.2),
    "Panda": (0.2, -0.4, 0.1, -2.2, 0.1, 1.9, 0.8),
    "Kinova": (0.3, 3.6, 1.6, 0.5, 1.0, 0.3),
    "xArm7": (0.1, -0.6, 0.2, 0.9, 0.1, 1.2, 0.0),
    "TIAGo": (0.2, 0.4, -0.3, 0.2, 1.2, 0.3, 0.5, 0.2),
}
SVG = "{http://www.w3.org/2000/svg}"


def drawn(name: str) -> Drawing:
    """An arm in a pose, with a wall below its tip; the PUMA as on its page."""
    if name == "PUMA":
        return PUMA.drawing()
    arm = SpatialArm(chain(name))
    tip = np.array(arm.tip_frame(POSES[name])[1]).ravel()
    return spatial_arm(arm, POSES[name], Wall((0.0, 0.0, -1.0), 0.15 - float(tip[2])))


def boxes(drawing: Drawing) -> dict[str, tuple[float, float, float, float]]:
    """Left, top, right and bottom of each label, with 7 pixels for a character of 13 pixels in height."""
    found = {}
    for text in etree.fromstring(drawing.svg).iter(f"{SVG}text"):
        said, x, y = text.xpath("string()"), float(text.attrib["x"]), float(text.attrib["y"])
        assert said not in found, "a label stands once"
        found[said] = (x - 3.5 * len(said), y - 10, x + 3.5 * len(said), y + 3)
    return found


@pytest.mark.parametrize("name", ["PUMA", *POSES])
def test_labels_of_an_arm_can_be_read(name: str) -> None:
    drawing = drawn(name)
    placed = boxes(drawing)
    n = PUMA.n if name == "PUMA" else len(POSES[name])
    assert {f"q{i}" for i in range(1, n + 1)} | {"x1", "x2", "x3", "tip", "n", "wall"} <= placed.keys()
    root = etree.fromstring(drawing.svg)
    for said, (left, top, right, bottom) in placed.items():
        assert 0 <= left < right <= float(root.attrib["width"]), said
        assert 0 <= top < bottom <= float(root.attrib["height"]), said
        for other, (l, t, r, b) in placed.items():
            assert other == said or not (left < r and l < right and top < b and t < bottom), (said, other)


@pytest.mark.parametrize("turn", [-70, -35, 0, 40, 70])
def test_turns_about_the_vertical_are_seen_counter_clockwise(turn: int) -> None:
    """From above, a turn by the right hand about axis 3 is one to the left; a mirrored picture would show the other."""
    corners = [np.array(corner, float) for corner in ((1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0))]
    view = View.fitting(math.radians(turn), corners, (400.0, 400.0), 40.0)
    points = [view.at(corner) for corner in corners]
    area = sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in zip(points, [*points[1:], points[0]], strict=True))
    assert area < 0, "pixels count downwards"


def test_labels_of_a_path_can_be_read() -> None:
    drawing = spatial_path(PUMA.path)
    assert {"t = 0", "a", "b", "center", "wall", "x1", "x2", "x3"} <= boxes(drawing).keys()
    assert not re.search(r"nan|inf", drawing.svg)
