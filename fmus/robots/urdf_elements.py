"""Links and joints as a URDF file writes them, with each number checked where it stands."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cached_property

import numpy as np
from lxml import etree

from fmus.mechanics.rigid_body import HERE, Body, Placement, RobotError

Element = etree._Element
SIX = ("ixx", "ixy", "iyy", "ixz", "iyz", "izz")
LISTED = 12
"""Names that an error message lists."""


@dataclass(frozen=True)
class UrdfJoint:
    """A joint element: names, kind and frame; its other numbers are read when they are asked for."""

    name: str
    kind: str
    parent: str
    child: str
    origin: Placement
    file: str
    element: Element = field(compare=False, repr=False)

    @property
    def line(self) -> int:
        """Line of the element in the file."""
        return self.element.sourceline or 0

    @property
    def mimics(self) -> str | None:
        """The joint that this one follows, if any."""
        mimic = self.element.find("mimic")
        return None if mimic is None else mimic.get("joint", "?")

    @property
    def axis(self) -> tuple[float, ...]:
        """Unit vector of the axis, shape (3,)."""
        axis = np.array(numbers(self.file, self.element, ("axis", "xyz"), (1.0, 0.0, 0.0)))
        length = np.linalg.norm(axis)
        if length == 0:
            msg = f"{self.file}, line {self.line}: the axis of joint {self.name} is 0 0 0; give it a direction."
            raise RobotError(msg)
        return tuple(map(float, axis / length))

    @property
    def damping(self) -> float:
        """Coefficient of viscous friction, N.m.s/rad or N.s/m."""
        return numbers(self.file, self.element, ("dynamics", "damping"), (0.0,))[0]

    @property
    def friction(self) -> float:
        """Coulomb friction, N.m or N."""
        return numbers(self.file, self.element, ("dynamics", "friction"), (0.0,))[0]

    def limits(self, *, bounded: bool) -> tuple[float, float, float, float]:
        """Lower and upper end of the range, largest rate, largest effort; infinite where nothing is said."""
        limit = self.element.find("limit")
        if bounded and (limit is None or not {"lower", "upper"} & {*map(str, limit.attrib)}):
            msg = (
                f"{self.file}, line {self.line}: joint {self.name} is {self.kind} and has no limits; give it "
                '<limit lower= upper= velocity= effort=/>, or type="continuous" if it turns without end.'
            )
            raise RobotError(msg)
        read = [numbers(self.file, self.element, ("limit", key), (0.0,))[0] for key in ("lower", "upper")]
        lower, upper = read if bounded else (-np.inf, np.inf)
        rates = [numbers(self.file, self.element, ("limit", key), (np.inf,))[0] for key in ("velocity", "effort")]
        return lower, upper, rates[0], rates[1]

    def shifted(self, q: float) -> Placement:
        """Where the child stands in the frame of the joint, at q rad or m."""
        if self.kind == "fixed" or q == 0:
            return HERE
        z = np.array(self.axis)
        if self.kind == "prismatic":
            return Placement.of(np.eye(3), q * z)
        K = np.array([[0, -z[2], z[1]], [z[2], 0, -z[0]], [-z[1], z[0], 0]])
        return Placement.of(np.eye(3) + np.sin(q) * K + (1 - np.cos(q)) * K @ K, np.zeros(3))


@dataclass(frozen=True)
class UrdfRobot:
    """All links and joints of a file.

    Attributes
    ----------
    name, file
        Names of the robot and of its file.
    links, joints
        By name. The bodies of links are read when they are asked for, so that a mistake in another part of the robot
        does not matter.
    """

    name: str
    file: str
    links: dict[str, Element]
    joints: dict[str, UrdfJoint]

    @cached_property
    def parents(self) -> dict[str, UrdfJoint]:
        """The joint that carries each link."""
        found: dict[str, UrdfJoint] = {}
        for joint in self.joints.values():
            other = found.setdefault(joint.child, joint)
            if other is not joint:
                msg = (
                    f"{self.file}, line {joint.line}: link {joint.child} is the child of joint {other.name} and of "
                    f"joint {joint.name}, which closes a loop; a serial arm has one joint for each link."
                )
                raise RobotError(msg)
        return found

    @cached_property
    def children(self) -> dict[str, list[UrdfJoint]]:
        """The joints on each link."""
        found: dict[str, list[UrdfJoint]] = {}
        for joint in self.joints.values():
            found.setdefault(joint.parent, []).append(joint)
        return found

    @property
    def root(self) -> str:
        """The link that is no child of a joint."""
        roots = [link for link in self.links if link not in self.parents]
        if len(roots) != 1:
            some = ", ".join(roots[:LISTED]) + (", ..." if len(roots) > LISTED else "")
            msg = (
                f"{self.file}: {len(roots)} links are no child of a joint ({some or 'none'}), so that the "
                "base is not plain; name the base link."
            )
            raise RobotError(msg)
        return roots[0]

    def body(self, link: str) -> Body | None:
        """The body of a link in the link's frame; None without a mass."""
        return _body(self.file, self.links[link], link)

    def known(self, what: str, names: Iterable[str], all_names: Collection[str]) -> None:
        """Refuse names that the file does not have, and list those it has, or the nearest ones."""
        for name in names:
            if name not in all_names:
                near = [*all_names]
                if len(near) > LISTED:
                    near = get_close_matches(name, near, n=LISTED, cutoff=0.0)
                others = f" and {len(all_names) - LISTED} others" if len(all_names) > LISTED else ""
                msg = f"{self.file}: there is no {what} {name}; the file has {', '.join(near)}{others}."
                raise RobotError(msg)


def robot_of_xml(root: Element, file: str) -> UrdfRobot:
    """Links and joints of a <robot> element.

    Raises
    ------
    RobotError
        If names are missing, doubled or unknown, or if a number cannot be read or cannot be.
    """
    if root.tag != "robot":
        msg = f"{file}: the root element is <{root.tag}>, but that of a URDF is <robot>; choose another file."
        raise RobotError(msg)
    links = _named(file, root, "link")
    joints = {name: _joint(file, element, name) for name, element in _named(file, root, "joint").items()}
    robot = UrdfRobot(root.get("name", file), file, links, joints)
    for joint in joints.values():
        robot.known(f"link (line {joint.line}, joint {joint.name})", (joint.parent, joint.child), links)
    return robot


def numbers(file: str, parent: Element, where: tuple[str, str], default: tuple[float, ...] | None) -> list[float]:
    """The numbers of an attribute of a child element: as many as the default has; without default one, which must be.

    Raises
    ------
    RobotError
        If they are missing, are no finite numbers, or are too few or too many.
    """
    tag, attribute = where
    element = parent.find(tag)
    text = None if element is None else element.get(attribute)
    line = (parent if element is None else element).sourceline
    if text is None:
        if default is not None:
            return list(default)
        msg = f"{file}, line {line}: <{parent.tag}> needs <{tag} {attribute}=...>; add it."
        raise RobotError(msg)
    wanted = 1 if default is None else len(default)
    try:
        found = [float(word) for word in text.split()]
    except ValueError:
        found = []
    if len(found) != wanted or not np.all(np.isfinite(found)):
        noun = "a finite number" if wanted == 1 else f"{wanted} finite numbers"
        msg = f'{file}, line {line}: <{tag} {attribute}="{text}"> must have {noun}; correct it.'
        raise RobotError(msg)
    return found


def _named(file: str, root: Element, tag: str) -> dict[str, Element]:
    """The children of one tag by their names."""
    found: dict[str, Element] = {}
    for element in root.findall(tag):
        name = element.get("name")
        if not name:
            msg = f"{file}, line {element.sourceline}: this {tag} has no name; give it one."
            raise RobotError(msg)
        if name in found:
            msg = (
                f"{file}, line {element.sourceline}: a second {tag} has the name {name}, as that of line "
                f"{found[name].sourceline} has; rename one of them."
            )
            raise RobotError(msg)
        found[name] = element
    return found


def _joint(file: str, element: Element, name: str) -> UrdfJoint:
    """A joint with its names and its frame."""
    ends = []
    for tag in ("parent", "child"):
        end = element.find(tag)
        link = None if end is None else end.get("link")
        if link is None:
            msg = f"{file}, line {element.sourceline}: joint {name} needs <{tag} link=...>; add it."
            raise RobotError(msg)
        ends.append(link)
    return UrdfJoint(name, element.get("type", ""), ends[0], ends[1], _origin(file, element), file, element)


def _origin(file: str, element: Element) -> Placement:
    """The placement of an <origin> element; that of the parent if there is none."""
    zero = (0.0, 0.0, 0.0)
    xyz, rpy = (numbers(file, element, ("origin", key), zero) for key in ("xyz", "rpy"))
    return Placement.from_rpy(xyz, rpy)


def _body(file: str, link: Element, name: str) -> Body | None:
    """The body of a link in the link's frame; None without a mass."""
    inertial = link.find("inertial")
    if inertial is None:
        return None
    mass = numbers(file, inertial, ("mass", "value"), None)[0]
    six = [numbers(file, inertial, ("inertia", key), None)[0] for key in SIX]
    if mass == 0 and not any(six):
        return None
    try:
        return Body(name, mass, inertia=tuple(six)).placed(_origin(file, inertial))
    except RobotError as error:
        msg = f"{file}, line {inertial.sourceline}: {error}"
        raise RobotError(msg) from error
