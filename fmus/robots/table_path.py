"""An ellipse on a table for the tip of any arm: the rule that gives its size, and what is checked all along it.

The ellipse stands upright. Its top is where the tip is at the start, and its bottom is below the surface of a table, so
that the tip comes down, slides across the table and leaves it, as the paper's arm does at its wall. The second axis is
horizontal and points across the arm. The orientation of the tip stays that of the start. Lengths are parts of the
arm's reach: semi-axes of 6 % (upright) and 16 %, the bottom 0.8 % below the surface, and the segment that cuts it off
0.4 %. If such an ellipse does not fit, smaller ones are tried, down to a fifth of the size.

An ellipse fits if at each of its points

- the tip reaches the place, and each joint stays away from both ends of its range by a twentieth of the range;
- the arm is not near a singular configuration: the smallest singular value of its Jacobian, with positions in reaches,
  is at least 0.04;
- each joint has four fifths of its largest rate at most, and of its largest torque;
- and where the tip meets the table, the torques of the first impact are within the limits: those with which the tip
  yields to the table as the target impedance does, M ddx + B (dx - v) + K (x - v t) = -K_f x, with v the speed of the
  virtual trajectory across the surface.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property

import casadi as ca
import numpy as np

from fmus import start
from fmus.mechanics.chain import Chain
from fmus.mechanics.rigid_body import Body, Placement, RobotError, merged
from fmus.mechanics.spatial_arm import SPACE, SpatialArm
from fmus.robots.spatial_robot import GRAVITY, rotation_matrix
from fmus.start import SpatialPath

UPRIGHT, ACROSS, BOTTOM, DEPTH = 0.06, 0.16, 0.008, 0.004
"""Semi-axes, and depths of the ellipse's bottom and of its segment below the table, in reaches of the arm."""
SIZES = (1.0, 0.7, 0.45, 0.3, 0.2)
POINTS = 60  # around the ellipse: 6 deg apart
MARGIN = 0.05  # of a range, from each of its ends
SINGULAR_VALUE = 0.04
SHARE = 0.8  # of the largest rates and torques
M, B, K, K_F = 2.0, 340.0, 4000.0, 1e5
"""Gains of the controllers and stiffness of the wall at the start, kg, N.s/m, N/m and N/m."""
IMPACT_STEP, IMPACT_STEPS = 5e-5, 800  # s; 40 ms
NEWTON_STEPS = 30
CLOSE = 1e-10  # m and rad
HALF_TURN = 1e-8  # rad, by which a rotation that is taken for a half turn may miss it
DIGITS = 4  # decimals of the path's numbers


class NoPathError(RobotError):
    """No ellipse fits an arm; the message says why the smallest one does not."""


@dataclass(frozen=True)
class Fitting:
    """An ellipse that an arm can follow.

    Attributes
    ----------
    q
        Joint coordinates at its top, rad or m, shape (n,).
    path
        The ellipse and the table.
    size
        Its size, one of `SIZES`.
    singular_value
        Smallest singular value of the Jacobian along it, positions in reaches of the arm.
    """

    q: np.ndarray
    path: SpatialPath
    size: float
    singular_value: float


@dataclass(frozen=True)
class TableArm:
    """An arm with what its tip holds, whose tip is to follow an ellipse on a table.

    Attributes
    ----------
    chain
        The arm.
    payload
        What the tip holds, in the frame of the tip.
    """

    chain: Chain
    payload: Body

    @cached_property
    def arm(self) -> SpatialArm:
        """Equations of the arm."""
        return SpatialArm(self.chain)

    @cached_property
    def p(self) -> np.ndarray:
        """Parameters of the dynamics with the payload in the last body, shape (13 n,)."""
        *others, last = self.chain.joints
        body = merged(last.body.name, [last.body, self.payload.placed(self.chain.tip)])
        return replace(self.chain, joints=(*others, replace(last, body=body))).p

    @cached_property
    def at(self) -> ca.Function:
        """A function of q: R, position and Jacobian of the tip, shapes (3, 3), (3, 1) and (6, n)."""
        q = ca.SX.sym("q", self.chain.n)
        return ca.Function("at", [q], [*self.arm.tip_frame(q), self.arm.jacobian(q)])

    def scaled(self, J: np.ndarray) -> np.ndarray:
        """A geometric Jacobian, shape (6, n), with positions in reaches of the arm."""
        return J / np.repeat([max(self.chain.reach, 1e-9), 1.0], SPACE)[:, None]

    def fitting(self, q: np.ndarray) -> Fitting:
        """The largest ellipse whose top is at the joint coordinates q, shape (n,).

        Raises
        ------
        NoPathError
            If not even the smallest one fits.
        """
        reason = ""
        for size in SIZES:
            path = self.path(q, size)
            try:
                return Fitting(q, path, size, self.checked(q, path))
            except NoPathError as error:
                reason = str(error)
        msg = f"at the joint coordinates {_shown(q)} no ellipse fits: even with {SIZES[-1]:g} of its size, {reason}"
        raise NoPathError(msg)

    def path(self, q: np.ndarray, size: float) -> SpatialPath:
        """The ellipse of a size whose top is where the tip is at the joint coordinates q, shape (n,)."""
        R, top, _ = (np.array(value) for value in self.at(q))
        top, length = top.ravel(), size * self.chain.reach
        azimuth = math.atan2(top[1], top[0])
        upright, across, bottom, depth = rounded([part * length for part in (UPRIGHT, ACROSS, BOTTOM, DEPTH)])
        center = rounded([top[0], top[1], top[2] - upright])
        return SpatialPath(
            center=center,
            plane=(math.pi, -math.pi / 2, *rounded([azimuth])),
            semi_axis=(upright, across),
            reference=rounded(Placement.of(R, top).rpy),
            wall_normal=(0.0, 0.0, -1.0),
            wall_offset=rounded([upright - center[2] - bottom])[0],
            depth=depth,
        )

    def moved(self, q: np.ndarray, R: np.ndarray, position: np.ndarray) -> np.ndarray | None:
        """Joint coordinates near q that put the tip at a position with an orientation; None if there are none."""
        for _ in range(NEWTON_STEPS):
            R_now, here, J = (np.array(value) for value in self.at(q))
            error = np.concatenate([position - here.ravel(), rotation_vector(R @ R_now.T)])
            if np.abs(error).max() < CLOSE:
                return q
            step = np.linalg.lstsq(J, error, rcond=None)[0]
            q = q + step * min(1.0, 0.5 / max(np.abs(step).max(), 1e-12))
        return None

    def checked(self, q: np.ndarray, path: SpatialPath) -> float:
        """The smallest singular value of the Jacobian, positions in reaches, along a path that starts at q, (n,).

        Raises
        ------
        NoPathError
            If the path does not fit.
        """
        least = np.inf
        for k, (q_k, J, x) in enumerate(self._followed(q, path)):
            self._check_ranges(q_k)
            value = float(np.linalg.svd(self.scaled(J), compute_uv=False)[-1])
            least = min(least, value)
            if value < SINGULAR_VALUE:
                msg = (
                    f"the arm is nearly singular {_place(k)}: the smallest singular value of its Jacobian is "
                    f"{value:.2g}, below {SINGULAR_VALUE:g}"
                )
                raise NoPathError(msg)
            self._check_drives(k, (q_k, J), x, path)
        return least

    def _followed(self, q: np.ndarray, path: SpatialPath) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Joint coordinates, Jacobian, and position, velocity and acceleration of the tip, (3, 3), at each point."""
        R = np.array(self.at(q)[0])
        for k in range(POINTS):
            x = motion(path, 2 * math.pi * k / POINTS)
            found = self.moved(q, R, x[0])
            if found is None:
                msg = f"the tip does not reach {np.round(x[0], 3).tolist()} m {_place(k)}"
                raise NoPathError(msg)
            q = found
            yield q, np.array(self.at(q)[2]), x

    def _check_ranges(self, q: np.ndarray) -> None:
        """Refuse joint coordinates next to the end of a range."""
        for value, joint in zip(q, self.chain.joints, strict=True):
            lower, upper = margins(joint.limits.lower, joint.limits.upper)
            if not lower <= value <= upper:
                end = joint.limits.lower if value < lower else joint.limits.upper
                msg = (
                    f"{joint.label} comes to {value:.3g} {'rad' if joint.turns else 'm'}, but its range ends at "
                    f"{end:.3g}, from which it is to keep {MARGIN:.0%} of the range"
                )
                raise NoPathError(msg)

    def _check_drives(self, k: int, place: tuple[np.ndarray, np.ndarray], x: np.ndarray, path: SpatialPath) -> None:
        """Refuse rates and torques beyond what the joints can do, on the way and when the tip hits the table."""
        q, J = place
        still, normal = np.zeros(SPACE), np.array(path.wall_normal)
        dq = np.linalg.lstsq(J, np.concatenate([x[1], still]), rcond=None)[0]
        drift = np.array(self.arm.jacobian_rate(q, dq)) @ dq

        def torque(ddx: np.ndarray) -> np.ndarray:
            """Torques for an acceleration of the tip."""
            ddq = np.linalg.lstsq(J, np.concatenate([ddx, still]) - drift, rcond=None)[0]
            tau = self.arm.inverse_dynamics(q, dq, dq, ddq, self.p, GRAVITY, start.COULOMB_VELOCITY)
            return np.array(tau).ravel()

        tau = torque(x[2])
        self._check_shares(k, dq, tau, SHARE)
        before = motion(path, 2 * math.pi * (k - 1) / POINTS)
        if normal @ x[0] >= path.wall_offset > normal @ before[0]:
            force, yielding = impact()
            speed = float(normal @ x[1])
            for_force, for_yielding = J[:SPACE].T @ normal, torque(x[2] + normal) - tau
            hit = tau[:, None] + speed * (np.outer(for_force, force) + np.outer(for_yielding, yielding))
            self._check_shares(k, dq, np.abs(hit).max(axis=1), 1.0)

    def _check_shares(self, k: int, dq: np.ndarray, tau: np.ndarray, share: float) -> None:
        """Refuse rates and torques above a share of the limits."""
        for i, joint in enumerate(self.chain.joints):
            units = ("rad/s", "N.m") if joint.turns else ("m/s", "N")
            for value, limit, unit in (
                (dq[i], joint.limits.velocity, units[0]),
                (tau[i], joint.limits.effort, units[1]),
            ):
                if abs(value) > share * limit:
                    msg = f"{joint.label} needs {abs(value):.3g} of its {limit:.3g} {unit} {_place(k)}"
                    raise NoPathError(msg)


@cache
def impact() -> tuple[np.ndarray, np.ndarray]:
    """Force N and acceleration m/s2 along the wall's normal while the target impedance hits the wall, at 1 m/s."""
    x, dx, forces, accelerations = 0.0, 1.0, [], []
    for k in range(IMPACT_STEPS):
        force = K_F * max(x, 0.0)
        ddx = -(force + B * (dx - 1.0) + K * (x - k * IMPACT_STEP)) / M
        forces.append(force)
        accelerations.append(ddx)
        dx += IMPACT_STEP * ddx
        x += IMPACT_STEP * dx
    return np.array(forces), np.array(accelerations)


def margins(lower: float, upper: float) -> tuple[float, float]:
    """The range of a joint without its margins."""
    width = upper - lower
    return (lower + MARGIN * width, upper - MARGIN * width) if math.isfinite(width) else (lower, upper)


def motion(path: SpatialPath, angle: float) -> np.ndarray:
    """Position m, velocity m/s and acceleration m/s2 on an ellipse, shape (3, 3), at an angle of its run, rad."""
    first, second, _ = rotation_matrix(path.plane).T
    a, b, rate = path.semi_axis[0] * first, path.semi_axis[1] * second, 2 * math.pi / start.PERIOD
    cosine, sine = math.cos(angle), math.sin(angle)
    around = a * cosine + b * sine
    return np.array([path.center + around, rate * (b * cosine - a * sine), -(rate**2) * around])


def rounded(values: Sequence[float] | np.ndarray) -> tuple[float, ...]:
    """Numbers with `DIGITS` decimals."""
    return tuple(round(float(value), DIGITS) + 0.0 for value in values)


def rotation_vector(R: np.ndarray) -> np.ndarray:
    """A vector along the axis of a rotation, shape (3,), whose length is the sine of the angle, and 1 beyond 90 deg."""
    axis = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    if np.trace(R) >= 1:
        return axis
    sine = np.linalg.norm(axis)
    if sine < HALF_TURN:  # R + I is twice the product of the axis with itself, and `axis` is rounding
        axis = (R + np.eye(SPACE))[:, np.argmax(np.diag(R))]
        sine = np.linalg.norm(axis)
    return axis / sine


def _place(k: int) -> str:
    """Where a point of the ellipse is, in words."""
    return f"at {360 * k // POINTS} deg of the ellipse"


def _shown(q: np.ndarray) -> str:
    """Joint coordinates as a list."""
    return str(list(rounded(q)))
