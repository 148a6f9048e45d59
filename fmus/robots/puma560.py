"""The PUMA 560, the arm of Lu and Meng's time: frames, masses, inertias and rotors.

Numbers: B. Armstrong, O. Khatib, J. Burdick, "The explicit dynamic model and inertial parameters of the PUMA 560 arm",
IEEE Conf. Robotics and Automation, 1986, pp. 510-518, as P. Corke's Robotics Toolbox lists them for the Denavit-
Hartenberg parameters that J. Craig modified (`mdl_puma560akb`). The frame of link i is that of joint i; joint i turns
about axis 3. Moments of inertia are about the centres of mass. Products of inertia were taken as 0.

The authors give link 1 no mass and no centre of mass: it turns about a vertical axis that does not move, so that its
moment about this axis is all that the motion depends on. They measured no friction for these numbers, so it is 0.
The largest torques are theirs, too.

Ranges of the joints: K. Fu, R. Gonzalez, C. Lee, "Robotics", McGraw-Hill, 1987, whose joint axes have the directions of
those here. Joint 2 has 135 deg to both sides of an upper arm that points up, q2 = -90 deg, and joint 3 has 135 deg to
both sides of a straight arm, q3 = 90 deg. Corke's `mdl_puma560` has these ranges with the signs of q2 and q3 reversed,
as its axes of these joints are.
"""

from dataclasses import dataclass

import numpy as np

from fmus.mechanics.chain import Chain, Joint, JointLimits
from fmus.mechanics.rigid_body import Body, Placement
from fmus.robots.spatial_robot import SpatialRobot
from fmus.start import SpatialPath


@dataclass(frozen=True)
class _Link:
    """A row of the tables.

    Denavit-Hartenberg a m, alpha in quarter turns, d m; body; inertia of the motor kg m2, gear ratio; range of the
    joint, deg; largest torque, N.m.
    """

    a: float
    quarter_turns: int
    d: float
    mass: float
    center: tuple[float, float, float]
    moments: tuple[float, float, float]
    motor: float
    gear: float
    degrees: tuple[float, float]
    torque: float


LINKS = (
    _Link(0.0, 0, 0.0, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.35), 291e-6, -62.6111, (-160, 160), 97.6),
    _Link(0.0, -1, 0.2435, 17.4, (0.068, 0.006, -0.016), (0.13, 0.524, 0.539), 409e-6, 107.815, (-225, 45), 186.4),
    _Link(0.4318, 0, -0.0934, 4.8, (0.0, -0.070, 0.014), (0.066, 0.0125, 0.066), 299e-6, -53.7063, (-45, 225), 89.4),
    _Link(-0.0203, 1, 0.4331, 0.82, (0.0, 0.0, -0.019), (1.8e-3, 1.8e-3, 1.3e-3), 35e-6, 76.0364, (-110, 170), 24.2),
    _Link(0.0, -1, 0.0, 0.34, (0.0, 0.0, 0.0), (0.3e-3, 0.3e-3, 0.4e-3), 35e-6, 71.923, (-100, 100), 20.1),
    _Link(0.0, 1, 0.0, 0.09, (0.0, 0.0, 0.032), (0.15e-3, 0.15e-3, 0.04e-3), 35e-6, 76.686, (-266, 266), 21.3),
)
"""The six links, from the base on."""


def puma560(tip: Placement | None = None) -> Chain:
    """The arm as a chain; the frame of the tip in that of link 6 is by default link 6's own, in the wrist's centre."""
    joints = tuple(_joint(i + 1, link) for i, link in enumerate(LINKS))
    return Chain("PUMA 560", joints, tip or Placement(), base_name="base", tip_name="tool")


def _joint(number: int, link: _Link) -> Joint:
    """A joint with its link."""
    ixx, iyy, izz = link.moments
    body = Body(f"link{number}", link.mass, link.center, (ixx, 0.0, iyy, 0.0, 0.0, izz), axial_only=number == 1)
    alpha = link.quarter_turns * np.pi / 2
    turned = Placement.from_rpy((link.a, 0, 0), (alpha, 0, 0))
    return Joint(
        f"joint{number}",
        body,
        turned @ Placement(translation=(0.0, 0.0, link.d)),
        limits=JointLimits(*map(float, np.deg2rad(link.degrees)), effort=link.torque),
        rotor_inertia=link.motor * link.gear**2,
    )


TOOL = Placement(translation=(0.0, 0.0, 0.15))
"""Assumed: a tool whose tip is 0.15 m in front of the wrist's centre, along axis 3 of link 6."""
# Assumed, since the paper simulates no arm in space: the paper's run on a table. The tool points down, and the ellipse
# stands upright beside the base. The table cuts off its lowest 10 mm, and the segment is 5 mm below the surface. Joints
# keep 20 deg of their ranges all along it, the arm stays far from singular configurations, and no motor reaches its
# largest torque.
PATH = SpatialPath(
    center=(0.5, 0.15, 0.025),
    plane=(np.pi, -np.pi / 2, 0.0),
    semi_axis=(0.075, 0.2),
    reference=(np.pi, 0.0, np.pi),
    wall_normal=(0.0, 0.0, -1.0),
    wall_offset=0.04,
    depth=0.005,
)
PUMA = SpatialRobot(
    chain=puma560(TOOL),
    near=(0.0, -1.335, 3.355, 0.0, 1.122, 0.0),
    path=PATH,
    payload=Body("payload", 1.0, (0.02, 0.0, -0.05), (2e-3, 0.0, 2e-3, 0.0, 0.0, 1e-3)),
    sources=(__name__,),
    origin="The numbers are those of B. Armstrong, O. Khatib and J. Burdick, The explicit dynamic model and inertial"
    " parameters of the PUMA 560 arm, IEEE Conf. Robotics and Automation, 1986. They give link 1 no mass, since it"
    " turns about an axis that does not move, and no friction. Tool, payload, ellipse and wall are assumed.",
)
"""The arm with a tool on a table, and a payload of 1 kg that controllers do not know."""
