"""The posture in which an arm begins, for a user who gives none.

Postures that fill the ranges of the joints evenly are tried in a fixed order, so that the same arm always begins in the
same way. In each of them the tip is turned until its tool points down, if the arm can: the axis of the tool is that of
the last joint. An arm that turns about the vertical at its base is turned until the tip is above axis 1 of the base, if
it can. Postures with the table above the base come first. A posture is taken if no joint from the third one on is below
the table, and if an ellipse fits (`fmus.robots.table_path`). Of the first ones that are found, those with the largest
ellipse are kept, and of these the ones that are farthest from singular configurations. The one with the smallest joint
coordinates is chosen.
"""

import math
from collections.abc import Iterator

import numpy as np

from fmus.mechanics.spatial_arm import SPACE
from fmus.robots.table_path import UPRIGHT, Fitting, NoPathError, TableArm, margins

TRIED, COMPARED = 1000, 20
"""Number of postures, and how many of those with an ellipse are compared."""
NEARLY = 0.75  # of the largest singular value, with which a posture is as good
UNBOUNDED = math.pi  # rad; a joint without limits, or with a longer range, is tried to this angle on both sides
INNER = 0.8  # of its range in which each joint is tried
DOWN = np.array([0.0, 0.0, -1.0])
BELOW = 0.1  # promise of a posture with the table below the base, against one above
VERTICAL = 1e-3  # rad or m, by which the first axis may miss the vertical through the base's origin
DIGITS = 4  # decimals of the chosen joint coordinates


def chosen_posture(table_arm: TableArm) -> Fitting:
    """The posture for an arm, and its ellipse.

    Raises
    ------
    NoPathError
        If no posture was found; the message has what is in the way of the most promising one.
    """
    found: list[Fitting] = []
    reason = ""
    for q in _candidates(table_arm):
        try:
            fitting = table_arm.fitting(q)
        except NoPathError as error:
            reason = reason or str(error)
            continue
        if _is_above_table(table_arm, fitting):
            found.append(fitting)
        if len(found) == COMPARED:
            break
    if not found:
        why = f"the most promising one: {reason}" if reason else "they have joints below the table"
        msg = f"in none of {TRIED} postures an ellipse on a table fits; {why}"
        raise NoPathError(msg)
    largest = max(fitting.size for fitting in found)
    farthest = max(fitting.singular_value for fitting in found if fitting.size == largest)
    kept = [one for one in found if one.size == largest and one.singular_value >= NEARLY * farthest]
    return min(kept, key=lambda fitting: float(fitting.q @ fitting.q))


def _candidates(table_arm: TableArm) -> Iterator[np.ndarray]:
    """Postures by their promise, the tool turned down where the arm can."""
    lower, upper = _tried_ranges(table_arm)
    samples = lower + (upper - lower) * evenly_spread(TRIED, table_arm.chain.n)
    promise = []
    for q in samples:
        R, position, J = (np.array(value) for value in table_arm.at(q))
        least = np.linalg.svd(table_arm.scaled(J), compute_uv=False)[-1]
        above = position[2, 0] > 2 * UPRIGHT * table_arm.chain.reach
        promise.append(least * (1 + DOWN @ R @ tool_axis(table_arm)) * (1.0 if above else BELOW))
    for k in np.argsort(-np.array(promise), kind="stable"):
        q = samples[k]
        R, position, _ = (np.array(value) for value in table_arm.at(q))
        turned = table_arm.moved(q, turn(R @ tool_axis(table_arm), DOWN) @ R, position.ravel())
        q = _ahead(q if turned is None else turned, table_arm, math.atan2(position[1, 0], position[0, 0]))
        yield np.round(_wrapped(q, table_arm), DIGITS)


def tool_axis(table_arm: TableArm) -> np.ndarray:
    """The axis of the tool in the frame of the tip, shape (3,): that of the last turning joint, towards the tip."""
    joint, tip = table_arm.chain.joints[-1], table_arm.chain.tip
    if not joint.turns:
        return np.array([0.0, 0.0, 1.0])
    axis = np.array(joint.axis)
    return tip.R.T @ (-axis if axis @ tip.p < 0 else axis)


def turn(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The smallest rotation, shape (3, 3), that takes a unit vector a to b; for opposite ones some half turn."""
    cosine, axis = float(a @ b), np.cross(a, b)
    if cosine < -1 + 1e-9:
        side = np.cross(a, np.eye(SPACE)[np.argmin(np.abs(a))])
        side /= np.linalg.norm(side)
        return 2 * np.outer(side, side) - np.eye(SPACE)
    K = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(SPACE) + K + K @ K / (1 + cosine)


def evenly_spread(count: int, dimension: int) -> np.ndarray:
    """Points that fill the unit cube evenly, shape (count, dimension), the same ones at each call.

    An additive recurrence: M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018.
    """
    root = 2.0
    for _ in range(60):  # the one positive root of x^(d+1) = x + 1
        root = (1 + root) ** (1 / (dimension + 1))
    return (0.5 + np.outer(np.arange(1, count + 1), root ** -np.arange(1.0, dimension + 1))) % 1.0


def _tried_ranges(table_arm: TableArm) -> tuple[np.ndarray, np.ndarray]:
    """Ends of the ranges in which joints are tried, rad or m, shape (n,) each."""
    ends = []
    for joint in table_arm.chain.joints:
        limits = joint.limits
        low, high = (
            (max(limits.lower, -UNBOUNDED), min(limits.upper, UNBOUNDED))
            if joint.turns
            else margins(limits.lower, limits.upper)
        )
        middle, half = (low + high) / 2, INNER * (high - low) / 2
        ends.append((middle - half, middle + half))
    return np.array(ends)[:, 0], np.array(ends)[:, 1]


def _ahead(q: np.ndarray, table_arm: TableArm, azimuth: float) -> np.ndarray:
    """The posture with the tip ahead of the base, on axis 1, if the first joint can turn it there."""
    joint = table_arm.chain.joints[0]
    upright = float((joint.placement.R @ np.array(joint.axis))[2])
    if not joint.turns or abs(abs(upright) - 1) > VERTICAL or np.hypot(*joint.placement.p[:2]) > VERTICAL:
        return q
    first = (q[0] - math.copysign(azimuth, azimuth * upright) + math.pi) % (2 * math.pi) - math.pi
    lower, upper = margins(joint.limits.lower, joint.limits.upper)
    return np.array([first, *q[1:]]) if lower <= first <= upper else q


def _wrapped(q: np.ndarray, table_arm: TableArm) -> np.ndarray:
    """The same posture with angles that are nearest to 0, where the ranges allow."""
    wrapped = []
    for value, joint in zip(q, table_arm.chain.joints, strict=True):
        near = (value + math.pi) % (2 * math.pi) - math.pi
        wrapped.append(near if joint.turns and joint.limits.lower <= near <= joint.limits.upper else value)
    return np.array(wrapped)


def _is_above_table(table_arm: TableArm, fitting: Fitting) -> bool:
    """Whether no joint from the third one on is below the table at the start."""
    heights = np.array(table_arm.arm.origins(fitting.q))[2, 2:]
    return bool(np.all(heights > -fitting.path.wall_offset))
