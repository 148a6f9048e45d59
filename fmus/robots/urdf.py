"""Arms from URDF files, the robot descriptions of ROS.

The chain is selected by its base and its tip link. What hangs rigidly on a link of the chain, by fixed or by locked
joints, becomes part of its body. A joint that branches off the chain and is not locked is refused, since its inertia
would otherwise be lost without a word. Links that no moving joint carries do not count.

A document type, entities and inclusion are refused. Meshes, materials, collisions and transmissions are not read.
"""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path

from lxml import etree

from fmus.mechanics.chain import Chain, Joint, JointKind, JointLimits
from fmus.mechanics.rigid_body import Body, Placement, RobotError, merged
from fmus.robots.urdf_elements import UrdfJoint, UrdfRobot, robot_of_xml

OTHER_KINDS = ("floating", "planar")
"""Joints of several degrees of freedom, which URDF has and a serial arm cannot have."""


def read_urdf(
    path: Path | str, tip: str, *, base: str | None = None, locked: Mapping[str, float] | None = None
) -> Chain:
    """Read an arm from a URDF file.

    Parameters
    ----------
    path
        File.
    tip
        Link at the end of the chain; its frame is the tip.
    base
        Link that does not move; by default the one that is no child of a joint.
    locked
        Joints that are held, and where, rad or m: the fingers of a gripper, for example.

    Raises
    ------
    RobotError
        If the file describes no such arm; the message says where.
    OSError
        If the file cannot be read.
    """
    return chain_of_urdf(Path(path).read_bytes(), Path(path).name, tip, base=base, locked=locked)


def last_links(path: Path | str) -> list[str]:
    """Links of a URDF file that carry no other link: those at which an arm may end.

    Raises
    ------
    RobotError
        If the file is no URDF.
    OSError
        If the file cannot be read.
    """
    robot = robot_of_xml(_parsed(Path(path).read_bytes(), Path(path).name), Path(path).name)
    return [link for link in robot.links if link not in robot.children]


def chain_of_urdf(
    text: bytes, name: str, tip: str, *, base: str | None = None, locked: Mapping[str, float] | None = None
) -> Chain:
    """The arm that a URDF text describes; `name` is what errors call the file. For the rest see `read_urdf`."""
    robot = robot_of_xml(_parsed(text, name), name)
    held = dict(locked or {})
    _check_held(robot, held)
    base = robot.root if base is None else base
    robot.known("base link", [base], robot.links)
    robot.known("tip link", [tip], robot.links)
    path = _path(robot, base, tip)
    joints: list[Joint] = []
    placement = Placement()
    moving = [joint for joint in path if joint.kind != "fixed" and joint.name not in held]
    for joint in path:
        placement = placement @ joint.origin
        if joint not in moving:
            placement = placement @ joint.shifted(held.get(joint.name, 0.0))
            continue
        joints.append(_moving_joint(robot, joint, placement, {*moving}, held))
        placement = Placement()
    return Chain(robot.name, tuple(joints), placement, base_name=base, tip_name=tip)


def _parsed(text: bytes, name: str) -> etree._Element:
    """The root element of a text; nothing outside of the text is read."""
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, remove_comments=True)
    try:
        root = etree.fromstring(text, parser)
    except etree.XMLSyntaxError as error:
        msg = f"{name}: this is not well-formed XML: {error}; export the URDF again."
        raise RobotError(msg) from error
    if root.getroottree().docinfo.doctype:
        msg = f"{name}: the file has a document type (<!DOCTYPE ...>), which a URDF does not need; remove it."
        raise RobotError(msg)
    for element in root.iter():
        if isinstance(element.tag, str) and "xacro" in element.tag:
            msg = (
                f"{name}, line {element.sourceline}: {etree.QName(element).localname} is an element of xacro; make a "
                "URDF first: xacro FILE.xacro > FILE.urdf."
            )
            raise RobotError(msg)
    return root


def _check_held(robot: UrdfRobot, held: Mapping[str, float]) -> None:
    """Refuse joints that are not there, and positions that a joint cannot have."""
    robot.known("joint", held, robot.joints)
    for name, value in held.items():
        joint = robot.joints[name]
        if not math.isfinite(value) or (value != 0 and joint.kind not in set(JointKind)):
            msg = (
                f"{robot.file}, line {joint.line}: joint {name} is {joint.kind} and cannot be held at {value:g}; only "
                f"{', '.join(JointKind)} joints are held at finite numbers, and others at 0."
            )
            raise RobotError(msg)


def _path(robot: UrdfRobot, base: str, tip: str) -> list[UrdfJoint]:
    """Joints from the base to the tip."""
    path: list[UrdfJoint] = []
    link, visited = tip, [tip]
    while link != base:
        joint = robot.parents.get(link)
        if joint is None:
            msg = (
                f"{robot.file}: link {tip} does not hang on link {base}: the way up ends at link {link}. Choose a base "
                f"among {', '.join(reversed(visited))}."
            )
            raise RobotError(msg)
        path.append(joint)
        link = joint.parent
        if link in visited:
            msg = (
                f"{robot.file}, line {joint.line}: the joints from {link} on lead back to {link} "
                f"({' <- '.join([*visited, link])}): a closed loop is not a serial arm; remove the joint "
                "that closes it."
            )
            raise RobotError(msg)
        visited.append(link)
    return path[::-1]


def _moving_joint(
    robot: UrdfRobot, joint: UrdfJoint, placement: Placement, moving: set[UrdfJoint], held: Mapping[str, float]
) -> Joint:
    """A joint of the chain with all that it carries up to the next one."""
    _check_drive(robot, joint)
    links: list[str] = []
    bodies = _carried(robot, joint.child, (moving, held), Placement(), links)
    body = merged(joint.child, bodies)
    if body.mass == 0:
        msg = (
            f"{robot.file}, line {joint.line}: joint {joint.name} moves {', '.join(links)}, and none of them has a "
            "mass; give one of the links its <inertial>."
        )
        raise RobotError(msg)
    kind = JointKind(joint.kind)
    lower, upper, velocity, effort = joint.limits(bounded=kind is not JointKind.CONTINUOUS)
    limits = JointLimits(lower, upper, velocity, effort)
    axis, damping, friction = joint.axis, joint.damping, joint.friction
    try:
        return Joint(joint.name, body, placement, axis, kind, limits, damping, friction)
    except RobotError as error:
        msg = f"{robot.file}, line {joint.line}: {error}"
        raise RobotError(msg) from error


def _check_drive(robot: UrdfRobot, joint: UrdfJoint) -> None:
    """Refuse a joint of the chain that has no drive of its own, or that moves in another way than along one axis."""
    if joint.mimics:
        msg = (
            f"{robot.file}, line {joint.line}: joint {joint.name} mimics joint {joint.mimics}, but each joint of the "
            f"chain needs a drive of its own; remove <mimic>, or hold the joint: locked={{'{joint.name}': 0.0}}."
        )
        raise RobotError(msg)
    if joint.kind not in {*JointKind, *OTHER_KINDS}:
        given = f'the type "{joint.kind}", which URDF does not know' if joint.kind else "no type"
        msg = (
            f"{robot.file}, line {joint.line}: joint {joint.name} has {given}; a joint of the chain is fixed, "
            f"{', '.join(JointKind)}, in small letters."
        )
        raise RobotError(msg)
    if joint.kind not in set(JointKind):
        msg = (
            f"{robot.file}, line {joint.line}: joint {joint.name} is {joint.kind}, but joints of the chain are fixed, "
            f"{', '.join(JointKind)}; write it as several of these, one behind the other."
        )
        raise RobotError(msg)


def _carried(
    robot: UrdfRobot,
    link: str,
    state: tuple[set[UrdfJoint], Mapping[str, float]],
    placement: Placement,
    links: list[str],
) -> list[Body]:
    """Bodies of a link and of all that hangs rigidly on it, in the frame of the moving joint; names go to `links`."""
    moving, held = state
    links.append(link)
    own = robot.body(link)
    bodies = [] if own is None else [own.placed(placement)]
    for joint in robot.children.get(link, ()):
        if joint in moving:
            continue
        if joint.kind != "fixed" and joint.name not in held:
            what = f"mimics joint {joint.mimics} and " if joint.mimics else ""
            msg = (
                f"{robot.file}, line {joint.line}: joint {joint.name} ({joint.kind}) {what}branches off the chain at "
                f"link {link}; hold it, locked={{'{joint.name}': 0.0}}, so that what it carries becomes part of the "
                "link."
            )
            ends = [one.child for one in sorted(moving, key=lambda one: one.line)]
            others = [name for end in ends for name in _branches(robot, end, state) if name != joint.name]
            if others:
                msg += f" Hold these, too, each where it is to be: {', '.join(others)}."
            raise RobotError(msg)
        there = placement @ joint.origin @ joint.shifted(held.get(joint.name, 0.0))
        bodies += _carried(robot, joint.child, state, there, links)
    return bodies


def _branches(robot: UrdfRobot, link: str, state: tuple[set[UrdfJoint], Mapping[str, float]]) -> Iterator[str]:
    """Names of the joints on a link, and on all that hangs on it up to the chain's next joint, that nobody holds."""
    moving, held = state
    for joint in robot.children.get(link, ()):
        if joint in moving:
            continue
        if joint.kind != "fixed" and joint.name not in held:
            yield joint.name
        yield from _branches(robot, joint.child, state)
