"""Evaluates the distance of the TIRT from the virtual trajectory without the controller's prediction error.

With d = x_t - x_v, eq. (11) is M d'' + B d' + K d = -F_hat: without a force d is zero. A controller that is told x_v,
dx_v and ddx_v at its ticks alone predicts x_v at the next tick by these three terms of a Taylor series. The prediction
of dx_v misses h^2/2 times the third derivative. Over a sample of length h this is an acceleration of
h/2 |d3x_v/dt3|, which the target impedance holds at a distance of

    M h |d3x_v/dt3| / (2 K).

For the ellipse of section V this is at most 1.16e-3 mm at h = 1e-4 s, and it is proportional to h. Here the
trajectory's own law takes the place of the prediction, so that d is that of eq. (11) with the measured force held over
each sample.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import expm

from orchestration.paper.measure import at_ticks
from orchestration.paper.numbers import PERIOD, SEMI_AXIS, TARGET_INERTIA, TARGET_STIFFNESS
from orchestration.results.result import Result


@dataclass(frozen=True)
class Corner:
    """An instant at which the virtual trajectory enters or leaves its straight segment.

    Attributes
    ----------
    time
        When, s.
    jump
        Step of dx_v there along x1, m/s: the segment has no velocity along the wall's normal.
    """

    time: float
    jump: float


def difference(result: Result, damping: float, wall_offset: float, depth: float) -> np.ndarray:
    """The distance x_t - x_v at the ticks of a run, by eq. (11) and the measured force, m, shape (n_ticks, 2).

    Parameters
    ----------
    damping
        Target damping B, N.s/m.
    wall_offset, depth
        Where the wall is, and how deep the straight segment lies in it, m; the wall's normal is (-1, 0).
    """
    times, force = result.tick_times("sensor.F_hat[1]"), at_ticks(result, "sensor.F_hat")
    return driven(times, force, damping, corners(wall_offset, depth))


def driven(times: np.ndarray, force: np.ndarray, damping: float, turns: Sequence[Corner]) -> np.ndarray:
    """The solution d of eq. (11) from rest, m, shape (n_ticks, 2).

    Parameters
    ----------
    times
        Equidistant instants, s, shape (n_ticks,).
    force
        Measured force, N, shape (n_ticks, 2), each held up to the next instant.
    damping
        Target damping B, N.s/m.
    turns
        Corners of the virtual trajectory. Its acceleration has no impulse there, so d' jumps by minus the step of dx_v.
    """
    h = float(times[1] - times[0])
    state, held = _advance(damping, h)
    d = np.zeros((len(times), 2, 2))  # tick, (d, d'), axis
    kicks = {}
    for corner in turns:
        tick = math.floor((corner.time - times[0]) / h)
        rest = _advance(damping, times[0] + (tick + 1) * h - corner.time)[0]
        kicks[tick] = np.outer(rest @ [0.0, -corner.jump], [1.0, 0.0])
    for k in range(len(times) - 1):
        d[k + 1] = state @ d[k] + np.outer(held, force[k])
        if k in kicks:
            d[k + 1] += kicks[k]
    return d[:, 0, :]


def corners(wall_offset: float, depth: float) -> tuple[Corner, Corner]:
    """Where the ellipse of section V enters its straight segment, and where it leaves it."""
    rate = 2 * math.pi / PERIOD
    angle = math.acos(-(wall_offset + depth) / SEMI_AXIS[0])
    speed = rate * SEMI_AXIS[0] * math.sin(angle)  # of the ellipse into the wall at the first corner
    return Corner(angle / rate, speed), Corner((2 * math.pi - angle) / rate, speed)


def sampling_offset(ticks: np.ndarray) -> np.ndarray:
    """The distance M h |d3x_v/dt3| / (2 K) at which the controller's x_t follows the ellipse, m, shape (n_ticks,).

    Parameters
    ----------
    ticks
        Times of the ticks, s, with equal distances h.
    """
    rate = 2 * math.pi / PERIOD
    jerk = rate**3 * np.hypot(SEMI_AXIS[0] * np.sin(rate * ticks), SEMI_AXIS[1] * np.cos(rate * ticks))
    return (ticks[1] - ticks[0]) / 2 * TARGET_INERTIA / TARGET_STIFFNESS * jerk


def _advance(damping: float, h: float) -> tuple[np.ndarray, np.ndarray]:
    """What (d, d') and a held force, N, make of (d, d') a time h later, shapes (2, 2) and (2,)."""
    M, K = TARGET_INERTIA, TARGET_STIFFNESS
    companion = np.array([[0.0, 1.0, 0.0], [-K / M, -damping / M, -1.0 / M], [0.0, 0.0, 0.0]])
    exponential = expm(companion * h)
    return exponential[:2, :2], exponential[:2, 2]
