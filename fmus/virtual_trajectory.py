"""VirtualTrajectory: the paper's ellipse with a straight segment along the wall, or along two walls (V, Fig. 1).

    x_v = (a cos(2 pi t / T), b sin(2 pi t / T))

Where the ellipse lies deeper in the wall than `depth`, the component along the wall's normal is
held at wall_offset + depth with zero rate and acceleration; the tangential one is unchanged.

With two walls x_v is the nearest point that lies no deeper than `depth` in either: on the ellipse, on one of the two
straight lines, or at rest where the lines meet.

Angles of the tip, if the task has any, are held at `orientation`.
"""

import math
from collections.abc import Callable

import casadi as ca

from adaptimp_fmu import POSITIVE, Formula, Formulas, SampledModel
from fmus import icons, start
from fmus.drawings.characteristics import cut_ellipse
from fmus.drawings.loop import TRAJECTORY
from fmus.elements import ANGLE, LENGTH, along, of_task
from fmus.environment.half_space import HalfSpace, declare_half_space
from fmus.mechanics.task import Task
from fmus.project import group_signals, publish

PARALLEL = 1e-6  # n1.n2 of two walls stays away from 1 and -1 by this much


FORMULAS = Formulas(
    "Virtual trajectory",
    [
        Formula(
            r"x_v = \left( a \cos\frac{2\pi t}{T}, \; b \sin\frac{2\pi t}{T} \right)^{T}",
            "An ellipse with the semi-axes a and b, run through in the time T, the period.",
        ),
        Formula(
            r"n^{T} x_v \le d_0 + d",
            "The component along the wall's normal is held where it would lie deeper than d, the depth, inside the"
            " wall; d0 is wall_offset.",
        ),
    ],
)


def virtual_trajectory(name: str = "VirtualTrajectory", walls: int = 1, task: Task | None = None) -> SampledModel:
    """Declare the model that gives the virtual trajectory x_v and its first two derivatives.

    Parameters
    ----------
    walls
        One or two.
    task
        What x_v consists of; by default a position in the plane.

    Examples
    --------
    >>> from adaptimp_fmu import Role
    >>> from fmus.virtual_trajectory import virtual_trajectory
    >>> [variable.name for variable in virtual_trajectory().with_role(Role.OUTPUT)][:2]
    ['x_v[1]', 'x_v[2]']
    """
    task = task or Task()
    place = {1: "the wall", 2: "each of two walls"}[walls]
    held = " and a constant angle" if task.angles else ""
    model = SampledModel(name, f"Ellipse with a straight segment inside {place}{held}")
    publish(model, icons.cut_ellipse(corner=walls > 1), TRAJECTORY, [cut_ellipse(walls)], __name__, "fmus")
    semi_axis = model.parameter(
        "semi_axis",
        start.SEMI_AXIS,
        unit="m",
        limits=POSITIVE,
        description=along("Semi-axis of the ellipse"),
    )
    period = model.parameter("period", start.PERIOD, unit="s", limits=POSITIVE, description="Time of one turn")
    borders = [declare_half_space(model, number, task.positions) for number in range(1, walls + 1)]
    depth = model.parameter(
        "depth", 0.01, unit="m", display_unit=LENGTH, description="Depth of the straight segment inside the wall"
    )

    orientation = _declare_orientation(model, task)
    rate = 2 * math.pi / period
    angle = rate * model.time
    radius = ca.vertcat(ca.cos(angle), ca.sin(angle))
    x = semi_axis * radius
    dx = rate * semi_axis * ca.vertcat(-radius[1], radius[0])
    ddx = -(rate**2) * x
    lines = [HalfSpace(wall.normal, wall.offset + depth) for wall in borders]
    excess = [line.gap(x) for line in lines]
    clipped = clip_at_one(lines[0], excess[0]) if walls == 1 else _clip_at_both(model, lines, excess)
    rates, accelerations = ([line.along_normal(vector) for line in lines] for vector in (dx, ddx))

    still = 0 * orientation
    for name, value, constant, per, text, turning in (
        ("x_v", clipped(x, excess), orientation, "", "position", "angle"),
        ("dx_v", clipped(dx, rates), still, "/s", "velocity", "angular velocity"),
        ("ddx_v", clipped(ddx, accelerations), still, "/s2", "acceleration", "angular acceleration"),
    ):
        model.output(
            name,
            ca.vertcat(value, constant),
            unit=task.each(f"m{per}", f"rad{per}"),
            description=of_task(f"Virtual {text} of the tip", task, f"Virtual {turning} of the tip"),
        )
    group_signals(model)
    return model


def _declare_orientation(model: SampledModel, task: Task) -> ca.SX:
    """Declare the constant angles, rad; empty if there are none."""
    if not task.angles:
        return ca.SX(0, 1)
    return model.parameter(
        "orientation",
        start.ORIENTATION,
        unit="rad",
        display_unit=ANGLE,
        description=of_task("", task, "Virtual angle of the tip")[task.positions :],
    )


Clip = Callable[[ca.SX, list[ca.SX]], ca.SX]
"""A function of a vector and of its components along the normals, which takes those away that lead too deep."""


def clip_at_one(line: HalfSpace, excess: ca.SX) -> Clip:
    """Clip at the line inside one wall, which the ellipse exceeds by `excess`, m."""
    straight = excess > 0
    return lambda vector, along: vector - ca.if_else(straight, along[0], 0) * line.normal


def _clip_at_both(model: SampledModel, lines: list[HalfSpace], excess: list[ca.SX]) -> Clip:
    """Clip at the lines inside two walls, and demand that the walls are not parallel."""
    normals = [line.normal for line in lines]
    together = ca.dot(*normals)
    sine = 1 - together**2
    model.require(sine - PARALLEL, "wall_normal and wall_normal2 must not be parallel")

    def both(along: list[ca.SX]) -> list[ca.SX]:
        """Shares of the normals in a vector, from its components along the normals."""
        return [(along[0] - together * along[1]) / sine, (along[1] - together * along[0]) / sine]

    shares = both(excess)
    cornered = ca.logic_and(shares[0] > 0, shares[1] > 0)
    first = ca.logic_and(excess[0] > 0, shares[1] <= 0)
    second = ca.logic_and(excess[1] > 0, shares[0] <= 0)

    def clipped(vector: ca.SX, along: list[ca.SX]) -> ca.SX:
        taken = [
            ca.if_else(cornered, share, ca.if_else(alone, component, 0))
            for share, alone, component in zip(both(along), (first, second), along, strict=True)
        ]
        return vector - taken[0] * normals[0] - taken[1] * normals[1]

    return clipped
