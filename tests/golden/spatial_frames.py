"""Draws docs/images/spatial-frames.svg: the PUMA 560 with its frames, from the numbers of the chain.

python -m tests.golden.spatial_frames            says whether the picture is up to date
python -m tests.golden.spatial_frames --write    draws it
"""

import io
import itertools
import sys
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from fmus.mechanics.chain import Chain
from fmus.mechanics.rigid_body import Placement
from fmus.mechanics.spatial_arm import SpatialArm
from fmus.robots.puma560 import puma560

PICTURE = Path(__file__).parents[2] / "docs" / "images" / "spatial-frames.svg"
POSE = np.array([-0.35, -0.75, 2.1, 0.0, 0.8, 0.0])
"""Joint angles of the drawing, rad."""
TOOL = Placement(translation=(0.0, 0.0, 0.2))
AXES = (("1", "#c1272d"), ("2", "#00745f"), ("3", "#0067a5"))
LENGTH = 0.15
"""Length of a drawn axis, m."""
TURN, TILT = np.radians([-25.0, 20.0])
"""From where the arm is seen: turned about the vertical, and from above."""
Frame = tuple[np.ndarray, np.ndarray]


def svg() -> str:
    """The picture as text, the same for the same numbers."""
    frames = frames_at(POSE)
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "spatial frames", "font.size": 10}):
        figure = Figure(figsize=(6.4, 4.8), facecolor="white")
        ax: Any = figure.add_axes((0.02, 0.02, 0.96, 0.96))
        ax.plot(*seen(_links(frames)), color="0.8", linewidth=9, solid_capstyle="round", solid_joinstyle="round")
        for label, frame, offset in _labelled(frames):
            _draw_frame(ax, frame)
            ax.annotate(label, seen(frame[1]), offset, textcoords="offset points", fontweight="bold", ha="center")
        tip = frames[-1][1]
        arrow = {"arrowstyle": "-|>", "color": "0.1", "linewidth": 2.0, "shrinkA": 0, "shrinkB": 0}
        end = tip + np.array([0.0, 0.0, -0.36])
        ax.annotate("", seen(end), seen(tip), arrowprops=arrow)
        ax.annotate("force of the tip\non the environment", seen(end), (-10, 4), textcoords="offset points", ha="right")
        ax.set_aspect("equal")
        ax.margins(0.1)
        ax.set_axis_off()
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None, "Creator": None})
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines()) + "\n"


def frames_at(q: np.ndarray) -> list[Frame]:
    """Rotation and origin, m, in the base of the frames of all joints and of the tip."""
    joints = puma560().joints
    parts = [(joints[: k + 1], Placement()) for k in range(len(joints))] + [(joints, TOOL)]
    frames = []
    for some, end in parts:
        R, position = SpatialArm(Chain("part", some, end)).tip_frame(q[: len(some)])
        frames.append((np.array(R), np.array(position).ravel()))
    return frames


def seen(points: np.ndarray) -> np.ndarray:
    """Where points of space, m, shape (..., 3), are on the paper: a parallel projection, shape (2, ...)."""
    x, y, z = np.moveaxis(np.asarray(points), -1, 0)
    right, depth = x * np.cos(TURN) - y * np.sin(TURN), x * np.sin(TURN) + y * np.cos(TURN)
    return np.array([right, z * np.cos(TILT) + depth * np.sin(TILT)])


def main(arguments: list[str]) -> None:
    """Write the picture, or say whether it is up to date."""
    if "--write" in arguments:
        PICTURE.write_text(svg(), encoding="utf-8")
    elif PICTURE.read_text(encoding="utf-8") != svg():
        raise SystemExit(f"{PICTURE.name} is out of date: python -m tests.golden.spatial_frames --write")


def _draw_frame(ax: Any, frame: Frame) -> None:
    """The three axes of a frame, numbered at their ends."""
    R, p = frame
    for k, (number, color) in enumerate(AXES):
        ax.plot(*seen(np.array([p, p + LENGTH * R[:, k]])), color=color, linewidth=2.0, solid_capstyle="round")
        ax.annotate(number, seen(p + 1.18 * LENGTH * R[:, k]), color=color, ha="center", va="center")


def _labelled(frames: list[Frame]) -> list[tuple[str, Frame, tuple[int, int]]]:
    """The frames that are drawn, with their names and how far from the origin these stand, in points."""
    return [
        ("base", (np.eye(3), np.zeros(3)), (-34, -4)),
        ("joint 2", frames[1], (-4, -62)),
        ("joint 3", frames[2], (-36, 18)),
        ("wrist", frames[3], (30, 22)),
        ("tip", frames[-1], (-24, -10)),
    ]


def _links(frames: list[Frame]) -> np.ndarray:
    """Points of a line along the links, which go along axis 1 of a frame first, then sideways to the next one."""
    points = [np.array([0.0, 0.0, -0.4]), np.zeros(3)]
    for (R, before), (_, after) in itertools.pairwise(frames):
        points += [before + R[:, 0] * ((after - before) @ R[:, 0]), after]
    return np.array(points)


if __name__ == "__main__":
    main(sys.argv[1:])
