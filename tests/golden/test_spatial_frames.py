"""docs/images/spatial-frames.svg is what its numbers give."""

import re

import numpy as np

from tests.golden.spatial_frames import PICTURE, svg

NUMBER = re.compile(r"-?\d+\.\d+")


def test_picture_of_the_frames_shows_the_chain_as_it_is() -> None:
    """Coordinates agree within half a point, whatever digits this version of Matplotlib writes."""
    kept, drawn = PICTURE.read_text(encoding="utf-8"), svg()
    assert re.findall(r"<!-- (.*?) -->", kept) == re.findall(r"<!-- (.*?) -->", drawn)
    numbers = [
        np.array(NUMBER.findall("".join(re.findall(r' d="(.*?)"', text, re.DOTALL))), float) for text in (kept, drawn)
    ]
    assert len(numbers[0]) > 40
    np.testing.assert_allclose(*numbers, rtol=0, atol=0.5)
