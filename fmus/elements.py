"""Texts that name the elements of an array in the FMUs' variables: the axis of the plane, or the joint.

The tip moves in the plane of x1, which points to the right, and x2, which points up. Joints count from the base.
"""

from fmus.mechanics.task import Task

AXES = ("x1 (right)", "x2 (up)")
PLANE_NORMAL = "x3 (out of the plane)"
TURNS = ("roll", "pitch", "yaw")
SPACE = 3  # coordinates of a point in space
ANGLE, RATE, ACCELERATION = "deg", "deg/s", "deg/s2"
"""Units in which tools show what the joints do; the values themselves are in rad."""
LENGTH = "mm"
"""Unit in which tools show lengths that are small beside the arm; the values themselves are in m."""


def along(text: str, size: int = 2) -> list[str]:
    """Descriptions of a vector of the plane, one for each axis: ``Position of the tip along x1 (right)``."""
    return [f"{text} along {_axis(i)}" for i in range(size)]


def of_task(text: str, task: Task, turning: str = "") -> list[str]:
    """Descriptions of a vector of a task, such as ``Angle of the tip in roll``: along x1, about x3 or in roll.

    Parameters
    ----------
    turning
        What an angle's element is, such as ``Moment of the tip``; `text` by default.
    """
    turns = (f"about {PLANE_NORMAL}",) if task.positions < SPACE else tuple(f"in {turn}" for turn in TURNS)
    return [*along(text, task.positions), *(f"{turning or text} {turns[i]}" for i in range(task.angles))]


def of_wrench(text: str, task: Task, turning: str) -> list[str]:
    """Descriptions of forces and of moments, which in space are about the axes of the base and not those of the angles.

    Parameters
    ----------
    turning
        What a moment is, such as ``Moment of the tip``.
    """
    if task.positions < SPACE:
        return of_task(text, task, turning)
    return [*along(text, SPACE), *(f"{turning} about {_axis(i)}" for i in range(task.angles))]


def of_axes(text: str, task: Task, *, full: bool = False) -> list[str]:
    """Descriptions of a gain along the axes: of its diagonal, or if `full` of all elements of a matrix, row by row."""
    diagonal = of_task(text, task)
    if not full:
        return diagonal
    places = [(i, j) for i in range(task.size) for j in range(task.size)]
    return [diagonal[i] if i == j else f"{text} between x{i + 1} and x{j + 1}" for i, j in places]


def of_tip(text: str) -> list[str]:
    """Descriptions of a vector in the frame of the tip in space: ``Centre of mass along axis 1 of the tip``."""
    return [f"{text} along axis {i + 1} of the tip" for i in range(SPACE)]


def of_joints(text: str, n: int) -> list[str]:
    """Descriptions of a vector with one element for each joint: ``Angle of joint 1``."""
    return [f"{text} of joint {i + 1}" for i in range(n)]


def of_links(text: str, n: int) -> list[str]:
    """Descriptions of a vector with one element for each link: ``Length of link 1``."""
    return [f"{text} of link {i + 1}" for i in range(n)]


def _axis(i: int) -> str:
    """Name of the axis of an element, with its direction if it is one of the plane's."""
    return AXES[i] if i < len(AXES) else f"x{i + 1}"
