"""VirtualTrajectory of a tip in space: an ellipse with a straight segment along the wall, and an orientation.

    x_v = center + R (a cos(2 pi t / T), b sin(2 pi t / T), 0)
    phi_v = orientation + tilt (1 - cos(2 pi t / T)) / 2

R turns the axes of the base to those of the ellipse by the roll, pitch and yaw `plane_rpy`. Where the ellipse lies
deeper in the wall than `depth`, the component along the wall's normal is held at wall_offset + depth with zero rate and
acceleration. The angles phi count from the reference orientation of the arm. With `tilt` the tip has turned by these
angles after half a turn, when it is at the wall, and is back after a whole turn.
"""

import math

import casadi as ca

from adaptimp_fmu import POSITIVE, Formula, Formulas, SampledModel
from fmus import icons, start
from fmus.drawings.loop import TRAJECTORY
from fmus.drawings.spatial_path import spatial_path
from fmus.elements import ANGLE, LENGTH, TURNS, along, of_task
from fmus.environment.half_space import HalfSpace, declare_half_space
from fmus.mechanics.orientation import rotation
from fmus.mechanics.spatial_model import TASK
from fmus.project import group_signals, publish
from fmus.robots.spatial_robot import SpatialRobot
from fmus.virtual_trajectory import clip_at_one

FORMULAS = Formulas(
    "Virtual trajectory",
    [
        Formula(
            r"p_v = c + R \left( a \cos\frac{2\pi t}{T}, \; b \sin\frac{2\pi t}{T}, \; 0 \right)^{T}",
            "An ellipse about the center c in the plane of plane_rpy, with the semi-axes a and b, run through in the"
            " time T, the period.",
        ),
        Formula(
            r"\varphi_v = \varphi_0 + \frac{\theta}{2} \left( 1 - \cos\frac{2\pi t}{T} \right)",
            "The tip turns from orientation by the angles of tilt and back.",
        ),
        Formula(
            r"n^{T} p_v \le d_0 + d",
            "The component along the wall's normal is held where it would lie deeper than d, the depth, inside the"
            " wall; d0 is wall_offset.",
        ),
    ],
)
SPACE = 3


def spatial_trajectory(robot: SpatialRobot, name: str) -> SampledModel:
    """Declare the model that gives the virtual trajectory x_v of position and orientation, and its derivatives.

    Parameters
    ----------
    robot
        Whose tip follows it from the start on.

    Examples
    --------
    >>> from fmus.robots.puma560 import PUMA
    >>> from fmus.spatial_trajectory import spatial_trajectory
    >>> spatial_trajectory(PUMA, "VirtualTrajectoryPuma560").description
    'Ellipse in space with a straight segment inside the wall, and an orientation that may tilt'
    """
    text = "Ellipse in space with a straight segment inside the wall, and an orientation that may tilt"
    model, path = SampledModel(name, text), robot.path
    modules = (__name__, "fmus.mechanics.orientation", "fmus")
    publish(model, icons.cut_ellipse(), TRAJECTORY, [spatial_path(path)], *modules)
    period = model.parameter("period", start.PERIOD, unit="s", limits=POSITIVE, description="Time of one turn")
    center, axes = _declare_plane(model, path)
    wall = declare_half_space(model, 1, SPACE, (path.wall_normal, path.wall_offset))
    depth = model.parameter(
        "depth", path.depth, unit="m", display_unit=LENGTH, description="Depth of the straight segment inside the wall"
    )
    orientation, tilt = _declare_angles(model)

    rate = 2 * math.pi / period
    angle = rate * model.time
    cosine, sine = ca.cos(angle), ca.sin(angle)
    line = HalfSpace(wall.normal, wall.offset + depth)
    ellipse = ca.mtimes(axes, ca.vertcat(cosine, sine))
    clip = clip_at_one(line, line.gap(center + ellipse))
    velocity = rate * ca.mtimes(axes, ca.vertcat(-sine, cosine))
    for name_of, value, over, turned, per, text, turning in (
        ("x_v", center + ellipse, line.gap, orientation + tilt * (1 - cosine) / 2, "", "position", "angle"),
        ("dx_v", velocity, line.along_normal, tilt * rate * sine / 2, "/s", "velocity", "rate"),
        ("ddx_v", -(rate**2) * ellipse, line.along_normal, tilt * rate**2 * cosine / 2, "/s2",
         "acceleration", "acceleration of the angle"),
    ):  # fmt: skip
        model.output(
            name_of,
            ca.vertcat(clip(value, [over(value)]), turned),
            unit=TASK.each(f"m{per}", f"rad{per}"),
            description=of_task(f"Virtual {text} of the tip", TASK, f"Virtual {turning} of the tip"),
        )
    group_signals(model)
    return model


def _declare_plane(model: SampledModel, path: start.SpatialPath) -> tuple[ca.SX, ca.SX]:
    """Declare where the ellipse is; returns its center, m, shape (3,), and its semi-axes as columns, m, (3, 2)."""
    semi_axis = model.parameter(
        "semi_axis",
        path.semi_axis,
        unit="m",
        limits=POSITIVE,
        description=[f"Semi-axis of the ellipse along its {which} axis" for which in ("first", "second")],
    )
    center = model.parameter("center", path.center, unit="m", description=along("Center of the ellipse", SPACE))
    turned = model.parameter(
        "plane_rpy",
        path.plane,
        unit="rad",
        display_unit=ANGLE,
        description=[f"{turn.capitalize()} from the axes of the base to those of the ellipse" for turn in TURNS],
    )
    return center, rotation(turned)[:, :2] * ca.repmat(semi_axis.T, SPACE, 1)


def _declare_angles(model: SampledModel) -> tuple[ca.SX, ca.SX]:
    """Declare the orientation of the tip, and by how much it tilts; rad, shape (3,) each."""
    orientation, tilt = (
        model.parameter(
            name, [0.0] * SPACE, unit="rad", display_unit=ANGLE, description=[f"{text} {turn}" for turn in TURNS]
        )
        for name, text in (
            ("orientation", "Virtual angle of the tip from its reference orientation,"),
            ("tilt", "Angle by which the tip has tilted after half a turn,"),
        )
    )
    return orientation, tilt
