"""A robot for FMUs from a URDF file: its numbers, a posture to begin in, and an ellipse on a table for its tip.

Frames, masses, inertias, friction and limits are those of the file (`fmus.robots.urdf`). The posture is the user's, or
one that is chosen (`fmus.robots.posture`). The ellipse follows from it (`fmus.robots.table_path`).
"""

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from fmus.mechanics.chain import Chain
from fmus.mechanics.rigid_body import Body, RobotError
from fmus.mechanics.spatial_model import TASK
from fmus.robots.posture import chosen_posture
from fmus.robots.spatial_robot import SpatialRobot
from fmus.robots.table_path import TableArm
from fmus.robots.urdf import read_urdf

LONGEST_NAME = 100
"""Characters of a robot's name in those of its FMUs; a file may have 255, with the unit's name and endings."""


def robot_of_urdf(
    path: Path | str,
    tip: str,
    *,
    base: str | None = None,
    locked: Mapping[str, float] | None = None,
    start: Sequence[float] | None = None,
    payload: float = 0.0,
    rotor: Mapping[str, float] | float = 0.0,
) -> SpatialRobot:
    """Read an arm from a URDF file and give its tip an ellipse on a table.

    Parameters
    ----------
    path, tip, base, locked
        File, links at both ends of the arm, and joints that are held; see `fmus.robots.urdf.read_urdf`.
    start
        Joint coordinates at the start, where the tip is on the top of the ellipse, rad or m, shape (n,); by default a
        posture is chosen, always the same one for the same file.
    payload
        Mass at the tip, kg, which the plant has and the controllers do not know; a point.
    rotor
        Inertia of the rotors as seen at their joints, gear ratio squared times that of the motor, kg m2 (kg): of each
        joint by its name, or one for all. URDF has none.

    Raises
    ------
    RobotError
        If the file describes no arm of six joints or more, a number cannot be, or no ellipse fits: then it is a
        `fmus.robots.table_path.NoPathError`.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> from fmus.robots.urdf_robot import robot_of_urdf
    >>> robot = robot_of_urdf("arm.urdf", "tool0", payload=0.5)  # doctest: +SKIP
    >>> robot.joints.labels, robot.start.q, robot.path.center  # doctest: +SKIP
    """
    chain = _with_rotors(read_urdf(path, tip, base=base, locked=locked), rotor)
    _check(chain, Path(path).name)
    held = Body("payload", payload)
    arm = TableArm(chain, held)
    fitting = chosen_posture(arm) if start is None else arm.fitting(_given(chain, start))
    near = tuple(float(value) for value in fitting.q)
    origin = f"The numbers are those of {Path(path).name}, from {chain.base_name} to {chain.tip_name}."
    return SpatialRobot(chain, near, fitting.path, held, (__name__, "fmus.robots.table_path"), origin)


def suffix_of(name: str) -> str:
    """What the names of a robot's models end with: the words of its name, each with a capital letter.

    A letter with a mark, such as an umlaut, loses the mark.

    Raises
    ------
    RobotError
        If the name has no letter or digit of ASCII, or is longer than files may be named.

    Examples
    --------
    >>> from fmus.robots.urdf_robot import suffix_of
    >>> suffix_of("ur5_robot"), suffix_of("PUMA 560"), suffix_of("Großer Ärmel")
    ('Ur5Robot', 'PUMA560', 'GrosserArmel')
    """
    plain = unicodedata.normalize("NFKD", name.replace("ß", "ss"))
    words = re.findall(r"[A-Za-z0-9]+", re.sub(r"[\u0300-\u036f]", "", plain))
    if not words:
        msg = f"Robot {name!r}: the name has no letter from A to Z and no digit; FMUs need one, so rename the robot."
        raise RobotError(msg)
    suffix = "".join(word[0].upper() + word[1:] for word in words)
    if len(suffix) > LONGEST_NAME:
        msg = (
            f"Robot {name[:20]}...: the name has {len(suffix)} letters and digits, and files of FMUs take "
            f"{LONGEST_NAME}; shorten it."
        )
        raise RobotError(msg)
    return suffix


def _check(chain: Chain, file: str) -> None:
    """Refuse arms that cannot have the task, and joints without drive."""
    if chain.n < TASK.size:
        names = ", ".join(joint.name for joint in chain.joints)
        msg = (
            f"{file}: {chain.n} joints move between {chain.base_name} and {chain.tip_name} ({names}), but position and "
            f"orientation of the tip need {TASK.size}; choose another tip or base, or hold fewer joints."
        )
        raise RobotError(msg)
    for joint in chain.joints:
        limits = joint.limits
        for what, value in (("effort", limits.effort), ("velocity", limits.velocity)):
            if not value > 0:
                msg = (
                    f'{file}: {joint.label} has <limit {what}="{value:g}">, so that it cannot move; give its largest '
                    f"{what}, or leave the attribute out for none."
                )
                raise RobotError(msg)


def _with_rotors(chain: Chain, rotor: Mapping[str, float] | float) -> Chain:
    """The arm with the inertia of its rotors."""
    names = [joint.name for joint in chain.joints]
    given = rotor if isinstance(rotor, Mapping) else dict.fromkeys(names, rotor)
    for name in given:
        if name not in names:
            msg = f"Robot {chain.name}: there is no joint {name} that moves; the arm has {', '.join(names)}."
            raise RobotError(msg)
    joints = (replace(joint, rotor_inertia=given.get(joint.name, 0.0)) for joint in chain.joints)
    return replace(chain, joints=tuple(joints))


def _given(chain: Chain, start: Sequence[float]) -> np.ndarray:
    """The joint coordinates of a user, if they are those of the arm."""
    q = np.array(start, float)
    if q.shape != (chain.n,) or not np.all(np.isfinite(q)):
        names = ", ".join(joint.name for joint in chain.joints)
        msg = (
            f"Robot {chain.name}: {q.size} joint coordinates are given for the start, but the arm has {chain.n} "
            f"joints; give a finite number for each, in this order: {names}."
        )
        raise RobotError(msg)
    for value, joint in zip(q, chain.joints, strict=True):
        if not joint.limits.lower <= value <= joint.limits.upper:
            msg = (
                f"Robot {chain.name}: {joint.label} would start at {value:g}, but its range is from "
                f"{joint.limits.lower:g} to {joint.limits.upper:g} {'rad' if joint.turns else 'm'}; start it within."
            )
            raise RobotError(msg)
    return q
