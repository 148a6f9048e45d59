"""Draws the pictures of docs/conventions.md: frames and wrench, point of contact, angles, and their singularity.

python -m tests.golden.convention_pictures            says whether the pictures are up to date
python -m tests.golden.convention_pictures --write    draws them
"""

import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from adaptimp_fmu.svg import BLUE, FAINT, GREEN, INK, RUST, SOFT, Picture
from fmus.drawings.spatial_arm import Wall, spatial_arm
from fmus.drawings.spatial_sensor import wrist_sensor
from fmus.drawings.view import Labels, View, sampled
from fmus.mechanics.rigid_body import Placement
from fmus.mechanics.spatial_arm import SpatialArm
from fmus.robots.puma560 import TOOL, puma560

FOLDER = Path(__file__).parents[2] / "docs" / "images"
TURN = math.radians(118.0)
"""From where the pictures of this module are seen."""
PANEL, HEIGHT = 240.0, 290.0  # pixels
RPY = np.radians([40.0, 35.0, 50.0])
"""Roll, pitch and yaw that are drawn."""
PITCHES = (0, 60, 90)  # deg
TOOL_DOWN, TABLE = (0.0, -1.4, 3.1, 0.0, 1.44, 0.0), Wall((0.0, 0.0, -1.0), 0.04)
"""Joint angles of the drawn arm, rad, with its tool down, and the wall of the scenario."""
NAMES = ("roll", "pitch", "yaw")
Pictures = dict[str, Callable[[], str]]


def on_paper(svg: str) -> str:
    """A drawing on white paper, as a file: pages of the site show it in light and in dark."""
    head, rest = svg.split("\n", 1)
    return f'{head}\n<rect width="100%" height="100%" fill="#fff"/>\n{rest}\n'


def angles() -> str:
    """Three turns from the reference orientation: roll, pitch and yaw, each about an axis of the base."""
    picture = Picture(3 * PANEL, HEIGHT, "Roll, pitch and yaw turn the tip one after the other about axes of the base")
    R = np.eye(3)
    for k, (name, angle) in enumerate(zip(NAMES, RPY, strict=True)):
        before, axis = R, np.eye(3)[k]
        R = Placement.from_rpy((0, 0, 0), [float(angle) if i == k else 0.0 for i in range(3)]).R @ R
        view, labels = _panel(picture, k)
        _frame(picture, view, labels, np.eye(3), (GREEN, 0.8), ("x_1", "x_2", "x_3"))
        if k:
            _frame(picture, view, None, before, (FAINT, 1.0), ("", "", ""))
        _frame(picture, view, labels, R, (RUST, 1.0), ("1", "2", "3"))
        _turn(picture, view, axis)
        picture.text((PANEL * (k + 0.5), HEIGHT - 12), f"{k + 1}. {name} about axis {k + 1}", anchor="middle", size=13)
    return on_paper(picture.svg())


def singularity() -> str:
    """Axes about which roll, pitch and yaw turn the tip, at three pitches: at 90 deg two of them are one."""
    picture = Picture(3 * PANEL, HEIGHT, "Axes of roll, pitch and yaw at three pitches; at 90 degrees two are one line")
    for k, pitch in enumerate(PITCHES):
        about = _axes_of_rates(math.radians(pitch), math.radians(-25.0))
        view, labels = _panel(picture, k)
        for axis, colour in zip(about.T, (RUST, SOFT, BLUE), strict=True):
            ends = [view.at(-0.55 * axis), view.at(axis)]
            picture.arrow(ends, colour, 2.6)
            labels.lines = [*labels.lines, sampled(ends)]
        for axis, colour, name in zip(about.T, (RUST, SOFT, BLUE), NAMES, strict=True):
            labels.write(name, view.at(axis), colour)
        picture.circle(view.at(np.zeros(3)), 4, INK, INK)
        said = f"pitch {pitch} deg: det E = {abs(math.cos(math.radians(pitch))):.1f}"
        picture.text((PANEL * (k + 0.5), HEIGHT - 12), said, anchor="middle", size=13)
    return on_paper(picture.svg())


def contact() -> str:
    """A point of contact beside the tip: its force makes a moment about the tip."""
    picture = Picture(520, 320, "A contact point beside the tip, its force, and the wrench of this force at the tip")
    tip, lever, surface = np.array([0.0, 0.0, 0.7]), np.array([0.15, 0.65, -0.55]), 0.15
    point = tip + lever
    patch = [np.array([x, y, surface]) for x, y in ((-0.7, -0.6), (0.9, -0.6), (0.9, 1.3), (-0.7, 1.3))]
    force = np.array([0.0, 0.28, -0.5])
    moment = np.cross(lever, force)
    moment *= 0.6 / np.linalg.norm(moment)
    view = View.fitting(TURN, [*patch, tip + np.array([0, 0, 0.6]), point + force], (520, 320), 30)
    for i in range(1, 12):
        ends = [patch[0] + (patch[1] - patch[0]) * i / 12, patch[3] + (patch[2] - patch[3]) * i / 12]
        picture.line([view.at(end) for end in ends], FAINT, 1)
    edge = [view.at(corner) for corner in patch]
    picture.line([*edge, edge[0]], SOFT, 1.4)
    picture.line([view.at(tip + np.array([0, 0, 0.6])), view.at(tip)], INK, 9)
    picture.line([view.at(tip), view.at(point)], INK, 4)
    normal = [np.array([0.5, -0.4, surface]), np.array([0.5, -0.4, surface - 0.35])]
    arrows = [(tip, point, BLUE, "c"), (point, point + force, RUST, "f"), (tip, tip + force, RUST, "f "),
              (tip, tip + moment, GREEN, "r x f"), (*normal, INK, "n")]  # fmt: skip
    drawn = [(tip, tip + np.array([0, 0, 0.6])), *((begin, end) for begin, end, _, _ in arrows)]
    labels = Labels(picture, [sampled([view.at(begin), view.at(end)]) for begin, end in drawn])
    for begin, end, colour, name in arrows:
        picture.arrow([view.at(begin), view.at(end)], colour, 2.4)
        labels.write(name, view.at(end if name != "c" else (begin + end) / 2), colour)
    picture.circle(view.at(point), 4.5, INK, INK)
    picture.circle(view.at(tip), 5, INK, INK)
    labels.write("tip", view.at(tip), bold=True)
    labels.write("contact point", view.at(point), bold=True)
    labels.write("wall", view.at(patch[0]), SOFT)
    return on_paper(picture.svg())


PICTURES: Pictures = {
    "conventions-arm.svg": lambda: on_paper(spatial_arm(SpatialArm(puma560(TOOL)), TOOL_DOWN, TABLE).svg),
    "conventions-sensor.svg": lambda: on_paper(wrist_sensor().svg),
    "conventions-contact.svg": contact,
    "conventions-angles.svg": angles,
    "conventions-singularity.svg": singularity,
}


def main(arguments: Sequence[str]) -> None:
    """Write the pictures, or say whether they are up to date."""
    for name, draw in PICTURES.items():
        if "--write" in arguments:
            (FOLDER / name).write_text(draw(), encoding="utf-8")
        elif (FOLDER / name).read_text(encoding="utf-8") != draw():
            raise SystemExit(f"{name} is out of date: python -m tests.golden.convention_pictures --write")


def _panel(picture: Picture, number: int) -> tuple[View, Labels]:
    """View and labels of one of the panels side by side."""
    view = View(TURN, 92.0, (PANEL * (number + 0.5), 140.0))
    return view, Labels(picture, [])


def _frame(
    picture: Picture,
    view: View,
    labels: Labels | None,
    axes: np.ndarray,
    style: tuple[str, float],
    names: Sequence[str],
) -> None:
    """Draw the axes of a frame in a colour and a length."""
    colour, length = style
    for name, axis in zip(names, axes.T, strict=True):
        ends = [view.at(np.zeros(3)), view.at(length * axis)]
        picture.arrow(ends, colour, 2.0)
        if labels is not None:
            labels.lines = [*labels.lines, sampled(ends)]
            labels.write(name, ends[1], colour)


def _turn(picture: Picture, view: View, axis: np.ndarray) -> None:
    """Draw an arrow that turns about an axis by the right hand."""
    first = np.eye(3)[(int(np.argmax(axis)) + 1) % 3]
    second = np.cross(axis, first)
    steps = np.linspace(-2.2, 2.2, 40)
    points = [view.at(0.62 * axis + 0.25 * (math.cos(a) * first + math.sin(a) * second)) for a in steps]
    picture.arrow([*points[:-2], points[-1]], BLUE, 1.8)


def _axes_of_rates(pitch: float, yaw: float) -> np.ndarray:
    """Columns of E: the axes about which roll, pitch and yaw turn the tip, in the base, shape (3, 3)."""
    turned = Placement.from_rpy((0, 0, 0), (0.0, pitch, yaw)).R
    return np.column_stack([turned[:, 0], [-math.sin(yaw), math.cos(yaw), 0.0], [0.0, 0.0, 1.0]])


if __name__ == "__main__":
    main(sys.argv[1:])
