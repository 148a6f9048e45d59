"""Texts that name the elements of an array in the FMUs' variables: the axis of the plane, or the joint.

The tip moves in the plane of x1, which points to the right, and x2, which points up. Joints count from the base.
"""

AXES = ("x1 (right)", "x2 (up)")
ANGLE, RATE, ACCELERATION = "deg", "deg/s", "deg/s2"
"""Units in which tools show what the joints do; the values themselves are in rad."""
LENGTH = "mm"
"""Unit in which tools show lengths that are small beside the arm; the values themselves are in m."""


def along(text: str, size: int = 2) -> list[str]:
    """Descriptions of a vector of the plane, one for each axis: ``Position of the tip along x1 (right)``."""
    return [f"{text} along {_axis(i)}" for i in range(size)]


def of_axes(text: str, size: int = 2, *, full: bool = False) -> list[str]:
    """Descriptions of a gain along the axes: of its diagonal, or if `full` of all elements of a matrix, row by row."""
    if not full:
        return along(text, size)
    places = [(i, j) for i in range(size) for j in range(size)]
    return [along(text, size)[i] if i == j else f"{text} between x{i + 1} and x{j + 1}" for i, j in places]


def of_joints(text: str, n: int) -> list[str]:
    """Descriptions of a vector with one element for each joint: ``Angle of joint 1``."""
    return [f"{text} of joint {i + 1}" for i in range(n)]


def of_links(text: str, n: int) -> list[str]:
    """Descriptions of a vector with one element for each link: ``Length of link 1``."""
    return [f"{text} of link {i + 1}" for i in range(n)]


def _axis(i: int) -> str:
    """Name of the axis of an element, with its direction if it is one of the plane's."""
    return AXES[i] if i < len(AXES) else f"x{i + 1}"
