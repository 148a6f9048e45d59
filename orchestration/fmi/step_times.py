"""Checks the steps and the communication points that a user gives for one FMU."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from orchestration.errors import SignalError
from orchestration.fmi.given import positive, shown

GRID_TOLERANCE = 1e-9  # by which, in steps, a first time may miss the FMU's; that of the ticks of our own FMUs


def require_step(name: str, now: float, h: float) -> None:
    """Refuse a step of h s that is not positive, or too short to advance the time `now`, s.

    Raises
    ------
    SignalError
    """
    positive(f"{name}: the step at t = {now:.12g} s", h, SignalError)
    if now + h == now:
        msg = f"{name}: the step of {h!r} s does not advance the time t = {now:.12g} s; use a larger step."
        raise SignalError(msg)


def as_times(name: str, times: Any) -> np.ndarray:
    """Return a step, shape (), or communication points, shape (n + 1,), as an array, s.

    Raises
    ------
    SignalError
        If they are not numbers.
    """
    try:
        return np.asarray(times, dtype=float)
    except (TypeError, ValueError) as error:
        msg = f"{name}: times are {shown(times)}; give a step, or communication points, as numbers in s."
        raise SignalError(msg) from error


def number_of_steps(name: str, points: np.ndarray, now: float, lengths: Sequence[int]) -> int:
    """Return the number of steps, from the communication points, which are checked, or else from the inputs.

    Parameters
    ----------
    points
        A step, or communication points, from `as_times`.
    now
        Time of the FMU, s.
    lengths
        Number of rows of each input.

    Raises
    ------
    SignalError
        If the points do not begin now or do not increase, or neither points nor inputs are given.
    """
    if points.ndim == 0:
        require_step(name, now, float(points))
        if not lengths:
            msg = f"{name}: without inputs, drive needs all communication points, not the step alone."
            raise SignalError(msg)
        return lengths[0]
    if points.ndim != 1 or len(points) < 2 or not np.isfinite(points).all() or not np.all(np.diff(points) > 0):
        said = np.array2string(points, threshold=6)
        msg = f"{name}: times must be n + 1 finite, increasing communication points, in s; got {said}."
        raise SignalError(msg)
    if abs(points[0] - now) > GRID_TOLERANCE * (points[1] - points[0]):
        msg = f"{name}: times begin at {points[0]:.12g} s, but the FMU is at t = {now:.12g} s."
        raise SignalError(msg)
    return len(points) - 1
