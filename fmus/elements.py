"""Texts that name the elements of an array in the FMUs' variables: the axis of the plane, or the link.

In the plane the tip moves along x1, which points to the right, and x2, which points up. In space it moves along the
axes of the base. Links count from the base. Texts that name a joint are those of `fmus.mechanics.joints.Joints`.
"""

from fmus.mechanics.task import Task

AXES = ("x1 (right)", "x2 (up)")
BASE_AXES = tuple(f"axis {i} of the base" for i in (1, 2, 3))
PLANE_NORMAL = "x3 (out of the plane)"
TURNS = ("roll", "pitch", "yaw")
SPACE = 3  # coordinates of a point in space
ANGLE, RATE, ACCELERATION = "deg", "deg/s", "deg/s2"
"""Units in which tools show what the joints do; the values themselves are in rad."""
LENGTH = "mm"
"""Unit in which tools show lengths that are small beside the arm; the values themselves are in m."""


def along(text: str, size: int = 2) -> list[str]:
    """Descriptions of a vector of the plane or of space, by axis: ``Position of the tip along x1 (right)``."""
    axes = AXES[:size] if size < SPACE else [f"axis {i + 1} of the base" for i in range(size)]
    return [f"{text} along {axis}" for axis in axes]


def of_task(text: str, task: Task, turning: str = "") -> list[str]:
    """Descriptions of a vector of a task: ``Error along x1 (right)``, and for angles ``about x3`` or ``in roll``.

    Parameters
    ----------
    turning
        What an angle's element is, such as ``Angle of the tip``; `text` by default.
    """
    places = [f"about {PLANE_NORMAL}"] if task.positions < SPACE else [f"in {turn}" for turn in TURNS]
    return [*along(text, task.positions), *(f"{turning or text} {places[i]}" for i in range(task.angles))]


def of_wrench(force: str, moment: str, task: Task) -> list[str]:
    """Descriptions of a wrench: ``Force of the tip along axis 1 of the base``, ``Moment of the tip about axis 1 ...``.

    In the plane, the one moment is about the plane's normal.
    """
    if task.positions < SPACE:
        return of_task(force, task, moment)
    return [*along(force, task.positions), *(f"{moment} about {BASE_AXES[i]}" for i in range(task.angles))]


def of_axes(text: str, task: Task, *, full: bool = False) -> list[str]:
    """Descriptions of a gain along the axes: of its diagonal, or if `full` of all elements of a matrix, row by row.

    In space the axes are those of the task, which may be turned from those of the base.
    """
    if task.in_space:
        return [f"{text} {way} axis {i + 1} of the task" for way in ("along", "about") for i in range(SPACE)]
    diagonal = of_task(text, task)
    if not full:
        return diagonal
    places = [(i, j) for i in range(task.size) for j in range(task.size)]
    return [diagonal[i] if i == j else f"{text} between x{i + 1} and x{j + 1}" for i, j in places]


def of_tip(text: str) -> list[str]:
    """Descriptions of a vector in the frame of the tip in space: ``Centre of mass along axis 1 of the tip``."""
    return [f"{text} along axis {i} of the tip" for i in (1, 2, 3)]


def of_links(text: str, n: int) -> list[str]:
    """Descriptions of a vector with one element for each link: ``Length of link 1``."""
    return [f"{text} of link {i + 1}" for i in range(n)]
