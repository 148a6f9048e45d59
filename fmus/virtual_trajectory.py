"""VirtualTrajectory: the paper's ellipse with a straight segment along the wall (V, Fig. 1).

    x_v = (a cos(2 pi t / T), b sin(2 pi t / T))

Where the ellipse lies deeper in the wall than `depth`, the component along the wall's normal is
held at wall_offset + depth with zero rate and acceleration; the tangential one is unchanged.
"""

import math

import casadi as ca

from adaptimp_fmu import POSITIVE, SampledModel
from fmus import icons, start
from fmus.environment.half_space import HalfSpace, declare_half_space
from fmus.project import group_signals, publish


def virtual_trajectory() -> SampledModel:
    """Declare the model that gives the virtual trajectory x_v and its first two derivatives."""
    model = SampledModel("VirtualTrajectory", "Ellipse with a straight segment inside the wall")
    publish(model, icons.cut_ellipse(), __name__, "fmus")
    semi_axis = model.parameter(
        "semi_axis",
        start.SEMI_AXIS,
        unit="m",
        limits=POSITIVE,
        description=["Semi-axis of the ellipse along x1", "Semi-axis of the ellipse along x2"],
    )
    period = model.parameter("period", start.PERIOD, unit="s", limits=POSITIVE, description="Time of one turn")
    wall = declare_half_space(model)
    depth = model.parameter("depth", 0.01, unit="m", description="Depth of the straight segment inside the wall")

    rate = 2 * math.pi / period
    angle = rate * model.time
    radius = ca.vertcat(ca.cos(angle), ca.sin(angle))
    x = semi_axis * radius
    dx = rate * semi_axis * ca.vertcat(-radius[1], radius[0])
    ddx = -(rate**2) * x
    excess = HalfSpace(wall.normal, wall.offset + depth).gap(x)
    straight = excess > 0

    def clipped(vector: ca.SX, along_normal: ca.SX) -> ca.SX:
        return vector - ca.if_else(straight, along_normal, 0) * wall.normal

    model.output("x_v", clipped(x, excess), unit="m", description="Virtual position of the tip")
    model.output("dx_v", clipped(dx, wall.along_normal(dx)), unit="m/s", description="Virtual velocity of the tip")
    model.output(
        "ddx_v",
        clipped(ddx, wall.along_normal(ddx)),
        unit="m/s2",
        description="Virtual acceleration of the tip",
    )
    group_signals(model)
    return model
