"""Start values that the FMUs share: the paper's arm at the start of its ellipse.

Inputs start where Plant and VirtualTrajectory are at t0, so that each FMU initialized alone shows
finite outputs (at q = 0 the arm is singular).
"""

import math
from dataclasses import dataclass

SEMI_AXIS = (1.5, 1.0)  # m, V
PERIOD = 2.0  # s, V: one turn in 0 <= t <= 2 s
WALL_NORMAL = (-1.0, 0.0)  # assumed: a vertical wall on the left
WALL_OFFSET = 1.45  # m, assumed
WALL_NORMALS = {1: WALL_NORMAL, 2: (0.0, -1.0)}  # by number; assumed: the second wall closes a right-angled corner
WALL_OFFSETS = {1: WALL_OFFSET, 2: 0.1}  # m, by number; assumed: the corner lies where the tip slides along the wall
COULOMB_VELOCITY = 1e-2  # rad/s, assumed: smooths Coulomb friction at rest

X_V = (SEMI_AXIS[0], 0.0)  # m
DX_V = (0.0, SEMI_AXIS[1] * 2 * math.pi / PERIOD)  # m/s
DDX_V = (-SEMI_AXIS[0] * (2 * math.pi / PERIOD) ** 2, 0.0)  # m/s2


@dataclass(frozen=True, kw_only=True)
class MotionStart:
    """Motion at the start: of the joints, and of the virtual trajectory that the tip is on.

    Attributes
    ----------
    q, dq, ddq
        rad, rad/s and rad/s2, shape (n,); m, m/s and m/s2 of joints that slide. ddq is the acceleration without torque
        and contact, -H^-1 (C dq + g + f).
    x_v, dx_v, ddx_v
        m, m/s and m/s2, of angles rad, rad/s and rad/s2, shape (m,).
    """

    q: tuple[float, ...]
    dq: tuple[float, ...]
    ddq: tuple[float, ...]
    x_v: tuple[float, ...] = X_V
    dx_v: tuple[float, ...] = DX_V
    ddx_v: tuple[float, ...] = DDX_V


@dataclass(frozen=True, kw_only=True)
class ArmStart(MotionStart):
    """A planar arm and its motion at the start: tip at (1.5, 0) m, moving at (0, pi) m/s.

    Attributes
    ----------
    masses, link_lengths
        kg and m, shape (n,).
    """

    masses: tuple[float, ...]
    link_lengths: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class SpatialPath:
    """The virtual trajectory of a tip in space: an ellipse in a plane, cut at a wall; see `fmus.virtual_trajectory`.

    Attributes
    ----------
    center
        m, shape (3,), in the axes of the base.
    plane
        Roll, pitch and yaw, rad, shape (3,), that turn the axes of the base to those of the ellipse.
    semi_axis
        m, shape (2,).
    reference
        Roll, pitch and yaw, rad, shape (3,), of the orientation R_0 of the tip at which its angles phi are 0.
    wall_normal, wall_offset
        Unit vector into the wall, shape (3,), and distance of its surface from the origin along the normal, m.
    depth
        Depth inside the wall, m, at which the ellipse is cut off.
    """

    center: tuple[float, ...]
    plane: tuple[float, ...]
    semi_axis: tuple[float, ...]
    reference: tuple[float, ...]
    wall_normal: tuple[float, ...]
    wall_offset: float
    depth: float = 0.01


ARMS = {
    # V. Elbow bent by q2 > 0 (assumed): q2 = arccos(1.5^2/2 - 1), q1 = -q2/2.
    2: ArmStart(
        masses=(2.0, 1.0),
        link_lengths=(1.0, 1.0),
        q=(-0.7227342478, 1.4454684956),
        dq=(2.0943951024, 0.0),
        ddq=(1.6405770964, -6.1977356975),
    ),
    # Assumed, for the redundant case: the same reach; q3 = 0.6, the rates of least norm.
    3: ArmStart(
        masses=(2.0, 1.0, 0.5),
        link_lengths=(0.8, 0.7, 0.5),
        q=(-0.8564675332, 1.1625008008, 0.6),
        dq=(2.0267657571, 0.2020060324, -0.3102618316),
        ddq=(2.5403557188, -6.5241913644, -1.0173216980),
    ),
}

ORIENTATION = math.pi  # rad, assumed: the last link points into the wall
# Assumed, for a task of position and angle: the paper's arm with a hand of 0.3 m, which carries the payload. With the
# hand towards the wall the wrist stays between 0.96 m and 1.8 m from the base all along the ellipse.
POSE_ARM = ArmStart(
    masses=(2.0, 0.5, 0.5),
    link_lengths=(1.0, 1.0, 0.3),
    q=(-0.4510268118, 0.9020536236, 2.6905658418),
    dq=(1.7453292520, 0.0, -1.7453292520),
    ddq=(1.2925139330, -5.7764202933, -5.0902709213),
    x_v=(*X_V, ORIENTATION),
    dx_v=(*DX_V, 0.0),
    ddx_v=(*DDX_V, 0.0),
)
