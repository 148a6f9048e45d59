"""Frames and signs of an arm in space, drawn: joints, axes of the base and of the tip, and the wrench of the tip."""

from collections.abc import Sequence

import numpy as np

from adaptimp_fmu import Drawing
from adaptimp_fmu.svg import BLUE, GREEN, INK, RUST, SOFT, Picture, Point
from fmus.mechanics.spatial_arm import SpatialArm

_WIDTH, _HEIGHT, _MARGIN = 440.0, 320.0, 56.0  # pixels
_TURN, _TILT = np.radians([-35.0, 20.0])
"""From where the arm is seen: turned about the vertical, and from above."""


def spatial_arm(arm: SpatialArm, q: Sequence[float]) -> Drawing:
    """Draw an arm at the joint coordinates q, rad or m, shape (n,), as seen from the side and from above."""
    joints, R, tip = _places(arm, np.array(q))
    reach = float(np.abs(joints).max()) or 1.0
    ends = [np.zeros(3), *np.eye(3) * 0.45 * reach]
    hand = [tip + 0.3 * reach * axis for axis in R.T]
    seen = _fitted([*joints, *ends, *hand])
    points, (origin, *base), tool = seen[: len(joints)], seen[len(joints) : len(joints) + 4], seen[len(joints) + 4 :]
    picture = Picture(int(_WIDTH), int(_HEIGHT), f"{arm.chain.name}: joints, axes of base and tip, wrench")
    for i, end in enumerate(base, 1):
        picture.arrow([origin, end], GREEN, 2)
        picture.text((end[0] + 6, end[1] - 4), f"x_{i}", colour=GREEN)
    picture.line(points, INK, 5)
    for i, place in enumerate(points[:-1], 1):
        picture.circle(place, 6)
        picture.text((place[0] + 9, place[1] + 15), f"q_{i}", colour=BLUE, size=13)
    for i, end in enumerate(tool, 1):
        picture.arrow([points[-1], end], RUST, 1.8)
        picture.text((end[0] + 4, end[1] - 3), f"{i}", colour=RUST, size=12)
    picture.circle(points[-1], 4.5, fill=INK)
    picture.text((points[-1][0] - 10, points[-1][1] - 10), "tip", colour=SOFT, anchor="end")
    return Drawing(
        picture.svg(),
        "Frames and signs, at the start. x[1] to x[3] are the position of the tip in the axes of the base. x[4] to x[6]"
        " are roll, pitch and yaw of the tip from reference_rpy, about the axes of the base. F_ext is the wrench of the"
        " tip on the environment: the force, and the moment about the tip, in the axes of the base.",
    )


def _places(arm: SpatialArm, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Base, joints and tip, m, shape (n + 2, 3); rotation of the tip, shape (3, 3); and its position."""
    origins = arm.origins(q)
    places = np.array(origins).T
    R, tip = (np.array(value) for value in arm.tip_frame(q))
    return np.vstack([np.zeros(3), places, tip.ravel()]), R, tip.ravel()


def _fitted(places: Sequence[np.ndarray]) -> list[Point]:
    """Points of space as pixels, seen from `_TURN` and `_TILT`, so that all of them fit into the picture."""
    x, y, z = np.array(places).T
    across = x * np.cos(_TURN) + y * np.sin(_TURN)
    ahead = -x * np.sin(_TURN) + y * np.cos(_TURN)
    up = z * np.cos(_TILT) + ahead * np.sin(_TILT)
    scale = min((_WIDTH - 2 * _MARGIN) / np.ptp(across), (_HEIGHT - 2 * _MARGIN) / np.ptp(up))
    left = (_WIDTH - scale * np.ptp(across)) / 2
    top = (_HEIGHT - scale * np.ptp(up)) / 2
    return [
        (float(left + scale * (a - across.min())), float(top + scale * (up.max() - b)))
        for a, b in zip(across, up, strict=True)
    ]
