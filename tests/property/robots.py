"""Spatial arms of the tests, each as our chain and as a model of Pinocchio that never saw ours."""

import sysconfig
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio

from fmus.mechanics.chain import Chain, Joint
from fmus.mechanics.rigid_body import Body, Placement
from fmus.robots.puma560 import LINKS, puma560
from fmus.robots.urdf import chain_of_urdf, read_urdf

pin: Any = pinocchio  # a compiled module, whose names a type checker does not see

ROBOTS = Path(sysconfig.get_path("purelib")) / "cmeel.prefix" / "share" / "example-robot-data" / "robots"
"""Robot descriptions of the package example-robot-data."""
GRAVITY = (1.1, -2.3, -9.4)
"""m/s2: an inclined base, so that no component is left out."""
LENGTHS, MASSES = (0.7, 0.5, 0.3), (2.0, 1.5, 0.7)
"""Link lengths, m, and masses at their ends, kg, of the planar arm of three joints."""


@dataclass(frozen=True)
class Described:
    """An arm that a URDF file describes: n = number of joints, held joints by their names."""

    file: str
    tip: str
    n: int
    locked: dict[str, float] = field(default_factory=dict)


# Six and seven joints; revolute, continuous and prismatic; axes along x, y, z and along none of them; held joints.
DESCRIBED = {
    "UR5": Described("ur_description/urdf/ur5_robot.urdf", "tool0", 6),
    "Panda": Described(
        "panda_description/urdf/panda.urdf", "panda_hand_tcp", 7,
        {"panda_finger_joint1": 0.03, "panda_finger_joint2": 0.03},
    ),
    "Kinova": Described("kinova_description/robots/kinova.urdf", "j2s6s200_end_effector", 6),
    "xArm7": Described("xarm_description/urdf/xarm7.urdf", "link7", 7),
    "Z1": Described("z1_description/urdf/z1.urdf", "gripperStator", 6, {"jointGripper": -0.4}),
    "TIAGo": Described("tiago_description/robots/tiago_no_hand.urdf", "arm_tool_link", 8),
}  # fmt: skip
NAMES = ("PUMA", "planar 3R", "slide", *DESCRIBED)
INERTIAL = (
    '<inertial><origin xyz="0.1 -0.2 0.3" rpy="0.3 0.2 0.1"/><mass value="{}"/>'
    '<inertia ixx="0.05" ixy="0.01" ixz="0.002" iyy="0.06" iyz="-0.003" izz="0.07"/></inertial>'
)
SLIDE = "".join(
    [
        '<robot name="slide"><link name="link0"/>',
        *(f'<link name="link{k}">{INERTIAL.format(3 - 0.5 * k)}</link>' for k in range(1, 5)),
        *(
            f'<joint name="joint{k}" type="{kind}"><parent link="link{k - 1}"/><child link="link{k}"/>'
            f'<origin xyz="0.3 {0.1 * k} 0.2" rpy="{0.2 * k} 0.4 -0.3"/><axis xyz="{axis}"/>'
            '<limit lower="-4" upper="4" velocity="1" effort="1"/></joint>'
            for k, kind, axis in (
                (1, "revolute", "0 0 1"),
                (2, "revolute", "0 0.6 0.8"),
                (3, "prismatic", "0.48 0.6 0.64"),
                (4, "revolute", "1 0 0"),
            )
        ),
        "</robot>",
    ]
)
"""An arm with a slide between turning joints, and axes in all directions: turns of a slide cause Coriolis forces."""


@cache
def chain(name: str) -> Chain:
    """Our numbers of an arm."""
    if name == "PUMA":
        return puma560(Placement.from_rpy((0.01, -0.02, 0.12), (0.3, -0.4, 0.5)))
    if name == "planar 3R":
        return _planar_chain()
    if name == "slide":
        return chain_of_urdf(SLIDE.encode(), "slide.urdf", "link4")
    robot = DESCRIBED[name]
    return read_urdf(ROBOTS / robot.file, robot.tip, locked=robot.locked | _others(name))


@cache
def model(name: str) -> tuple[Any, int]:
    """Pinocchio's model of an arm, and the index of its tip frame."""
    if name == "PUMA":
        built = _puma_model()
    elif name == "planar 3R":
        built = _planar_model()
    elif name == "slide":
        whole = pin.buildModelFromXML(SLIDE)
        built = whole, whole.getFrameId("link4", pin.FrameType.BODY)
    else:
        built = _described_model(DESCRIBED[name], chain(name))
    built[0].gravity = pin.Motion(np.array(GRAVITY), np.zeros(3))
    return built


def configuration(name: str, q: np.ndarray) -> np.ndarray:
    """Pinocchio's configuration, in which continuous joints have a sine and a cosine, for joint coordinates q."""
    return pin.integrate(model(name)[0], pin.neutral(model(name)[0]), q)


def _others(name: str) -> dict[str, float]:
    """Joints of a mobile robot that are no part of its arm, held at 0."""
    return {"head_1_joint": 0.0, "head_2_joint": 0.0} if name == "TIAGo" else {}


def _planar_chain() -> Chain:
    """Three joints about axis 3, point masses at the ends of the links."""
    joints, length = [], 0.0
    for k, (l, m) in enumerate(zip(LENGTHS, MASSES, strict=True)):
        body = Body(f"link{k}", m, (l, 0.0, 0.0))
        joints.append(Joint(f"joint{k}", body, Placement(translation=(length, 0.0, 0.0))))
        length = l
    return Chain("planar 3R", tuple(joints), Placement(translation=(length, 0.0, 0.0)))


def _planar_model() -> tuple[Any, int]:
    built, parent, placement = pin.Model(), 0, pin.SE3.Identity()
    for k, (l, m) in enumerate(zip(LENGTHS, MASSES, strict=True)):
        parent = built.addJoint(parent, pin.JointModelRZ(), placement, f"joint{k}")
        end = np.array([l, 0.0, 0.0])
        built.appendBodyToJoint(parent, pin.Inertia(m, end, np.zeros((3, 3))), pin.SE3.Identity())
        placement = pin.SE3(np.eye(3), end)
    return built, built.addFrame(pin.Frame("tip", parent, placement, pin.FrameType.OP_FRAME))


def _puma_model() -> tuple[Any, int]:
    """The rows of the tables by Craig's rule: Rot(x, alpha) Trans(x, a) Rot(z, theta) Trans(z, d)."""
    built, parent = pin.Model(), 0
    for k, link in enumerate(LINKS):
        turned = pin.SE3(pin.utils.rotate("x", link.quarter_turns * np.pi / 2), np.array([link.a, 0, 0]))
        along = pin.SE3(np.eye(3), np.array([0, 0, link.d]))
        parent = built.addJoint(parent, pin.JointModelRZ(), turned * along, f"joint{k}")
        inertia = pin.Inertia(link.mass, np.array(link.center), np.diag(link.moments))
        built.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
        built.armature[k] = link.motor * link.gear**2
    tip = pin.SE3(pin.rpy.rpyToMatrix(0.3, -0.4, 0.5), np.array([0.01, -0.02, 0.12]))
    return built, built.addFrame(pin.Frame("tip", parent, tip, pin.FrameType.OP_FRAME))


def _described_model(robot: Described, ours: Chain) -> tuple[Any, int]:
    """Pinocchio's own reading of the file, reduced to the joints of the arm."""
    whole = pin.buildModelFromUrdf(str(ROBOTS / robot.file))
    moving = {joint.name for joint in ours.joints}
    held = [k for k in range(1, whole.njoints) if whole.names[k] not in moving]
    at = pin.neutral(whole)
    for joint, value in robot.locked.items():
        at[whole.joints[whole.getJointId(joint)].idx_q] = value
    reduced = pin.buildReducedModel(whole, held, at)
    return reduced, reduced.getFrameId(robot.tip, pin.FrameType.BODY)
