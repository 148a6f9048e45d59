"""Icons of the FMUs: one colour for each kind of model, one pictogram for each model."""

import math
from collections.abc import Sequence

from adaptimp_fmu import Icon, Stroke

STEEL, GREEN, VIOLET = (58, 90, 128), (62, 124, 78), (112, 78, 140)
TEAL, RUST, CRIMSON = (28, 122, 130), (168, 84, 40), (160, 40, 62)
_THIN, _BOLD, _JOINT = 0.035, 0.075, 0.13

Point = tuple[float, float]

_MASS_SPRING_DAMPER = (
    Stroke([(0.14, 0.24), (0.14, 0.76)], _THIN),
    *(Stroke([(0.70 + 0.02 * i, 0.3), (0.70 + 0.02 * i, 0.7)], 0.12) for i in range(6)),
    Stroke(
        [
            *((0.14, 0.62), (0.22, 0.62), (0.28, 0.55), (0.34, 0.69), (0.40, 0.55), (0.46, 0.69), (0.52, 0.55)),
            *((0.58, 0.62), (0.66, 0.62)),
        ],
        _THIN,
    ),
    Stroke([(0.14, 0.38), (0.34, 0.38)], _THIN),
    Stroke([(0.5, 0.46), (0.34, 0.46), (0.34, 0.3), (0.5, 0.3)], _THIN),
    Stroke([(0.42, 0.42), (0.42, 0.34)], _THIN),
    Stroke([(0.42, 0.38), (0.66, 0.38)], _THIN),
)


def arm(n: int, *, corner: bool = False) -> Icon:
    """A plant: n links on a base, the tip against a wall, or below a second wall in a corner."""
    ends: Sequence[Point] = {
        2: ((0.24, 0.26), (0.36, 0.66), (0.72, 0.56)),
        3: ((0.24, 0.26), (0.27, 0.6), (0.52, 0.76), (0.72, 0.5)),
    }[min(n, 3)]
    joints = [Stroke([end], _JOINT) for end in ends[:-1]]
    wall = Stroke([(0.78, 0.18), (0.78, 0.82)], _THIN)
    hatching = [Stroke([(0.78, y), (0.86, y - 0.08)], _THIN) for y in (0.3, 0.44, 0.58, 0.72, 0.82)]
    base = Stroke([(0.13, 0.18), (0.35, 0.18)], _THIN)
    lid = [Stroke([(0.44, 0.82), (0.78, 0.82)], _THIN)] if corner else []
    return Icon(STEEL, [Stroke(ends, _BOLD), *joints, wall, *hatching, base, *lid])


def sensor() -> Icon:
    """A force on a plate, and its noisy reading."""
    heights = (0.3, 0.3, 0.36, 0.22, 0.4, 0.2, 0.33, 0.27, 0.3)
    reading = [(0.16 + 0.085 * i, height) for i, height in enumerate(heights)]
    plate = Stroke([(0.76, 0.5), (0.76, 0.84)], _BOLD)
    shaft, head = [(0.16, 0.67), (0.66, 0.67)], [(0.52, 0.79), (0.66, 0.67), (0.52, 0.55)]
    return Icon(GREEN, [plate, Stroke(shaft), Stroke(head), Stroke(reading, _THIN)])


def saturation(n: int) -> Icon:
    """Torque over command, limited; three dots for three joints."""
    axes = [Stroke([(0.14, 0.5), (0.86, 0.5)], _THIN), Stroke([(0.5, 0.14), (0.5, 0.86)], _THIN)]
    curve = Stroke([(0.16, 0.24), (0.34, 0.24), (0.66, 0.76), (0.84, 0.76)], _BOLD)
    return Icon(VIOLET, [*axes, curve, *_dots(n if n > 2 else 0)])


def cut_ellipse(*, corner: bool = False) -> Icon:
    """The virtual trajectory: an ellipse with a straight segment along the wall, or one along each of two walls."""
    cut, floor = 0.26, 0.34 if corner else 0.0
    turns = [2 * math.pi * i / 72 for i in range(73)]
    points = [(max(0.5 + 0.34 * math.cos(a), cut), max(0.5 + 0.26 * math.sin(a), floor)) for a in turns]
    walls = [Stroke([(0.18, 0.2), (0.18, 0.8)], _THIN)]
    walls += [Stroke([(0.18, 0.2), (0.78, 0.2)], _THIN)] if corner else []
    return Icon(TEAL, [Stroke(points), *walls, Stroke([(0.84, 0.5)], _JOINT)])


def impedance(n: int = 2) -> Icon:
    """A mass on a spring and a damper; three dots for three joints."""
    return Icon(RUST, [*_MASS_SPRING_DAMPER, *_dots(n if n > 2 else 0)])


def adaptive_impedance(variant: int) -> Icon:
    """A mass on a spring and a damper with an arrow across, as adjustable elements are drawn, and `variant` dots."""
    arrow = [Stroke([(0.18, 0.13), (0.56, 0.87)], 0.045), Stroke([(0.43, 0.83), (0.56, 0.87), (0.58, 0.73)], 0.045)]
    return Icon(CRIMSON, [*_MASS_SPRING_DAMPER, *arrow, *_dots(variant)])


def _dots(n: int) -> list[Stroke]:
    """A row of dots at the bottom right."""
    return [Stroke([(0.85 - 0.11 * i, 0.14)], 0.075) for i in range(n)]
