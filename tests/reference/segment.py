"""Integration of the plant between two ticks: one DOP853 step per smooth segment, halved if the error is too large.

The torque is held, so the flow of y = (q1, q2, dq1, dq2) is autonomous. It is smooth except where the tip meets or
leaves the wall (gap = 0) and where the damped wall would start to pull (1 + D_f gap_rate = 0). No step crosses such a
point. Within a segment, the force law of the mode is used beyond its range. The crossing is located as a step length.
Then the step is made again with that length, and the integration restarts in the other mode. Both kinks leave the
acceleration continuous, so the slope of an event function has the same sign on both sides of its crossing.

Coefficients: Hairer, Norsett, Wanner, "Solving Ordinary Differential Equations I" (1993), as published in SciPy.
Event functions are checked at both ends of a step and at an extremum between the ends. Two extrema inside one step
would go unseen. That needs a motion faster than the step (contact has about 300 rad/s, and a step at most 1e-4 s).
"""

from typing import NamedTuple

import numpy as np
from scipy.integrate._ivp import dop853_coefficients as tableau

from .arm import acceleration, contact_force, external_force, jacobian_rate, tip_velocity, wall_gap
from .compiled import compiled

A = np.ascontiguousarray(tableau.A[:12, :12])
B = np.ascontiguousarray(tableau.B)
E3 = np.ascontiguousarray(tableau.E3)
E5 = np.ascontiguousarray(tableau.E5)

OK, STEP_TOO_SMALL, TOO_MANY_EVENTS = 0, 1, 2
MAX_EVENTS = 100  # between two ticks; a bouncing tip has one or two
MIN_FRACTION = 2.0**-40
MESSAGES = {
    STEP_TOO_SMALL: "the error estimate stays above its tolerance at 2**-40 of the sample time",
    TOO_MANY_EVENTS: f"more than {MAX_EVENTS} contact events between two ticks",
}

GAP, PULL = 0, 1  # event functions: the gap, and 1 + D_f gap_rate


class Solver(NamedTuple):
    """Accuracy: the local error of each state is below atol + rtol |y|; at least `substeps` steps between ticks."""

    rtol: float = 1e-12
    atol: float = 1e-14
    substeps: int = 1


@compiled
def advance(y, mode, tau, plant, duration, solver):
    """Integrate the plant over `duration` (s) with the torque held, and update `y` and `mode` in place.

    Parameters
    ----------
    y : ndarray, shape (4,)
        q1, q2 (rad), dq1, dq2 (rad/s).
    mode : ndarray of bool, shape (2,)
        Whether the tip is in contact (gap > 0), and whether the wall pushes (1 + D_f gap_rate > 0), which is
        meaningful in contact only.
    tau : ndarray, shape (2,)
        Held torque (N.m).
    plant : Plant
    solver : Solver

    Returns
    -------
    int
        OK, STEP_TOO_SMALL or TOO_MANY_EVENTS.
    """
    k, y_new = np.empty((13, 4)), np.empty(4)
    done, events, limit = 0.0, 0, duration / solver.substeps
    h = limit
    while done < duration:
        # The last step ends on the tick exactly: a rest below 1e-12 of the segment is rounding of `done`.
        rest = duration - done
        h = rest if h > rest * (1.0 - 1e-12) else h
        derivative(y, tau, plant, mode, k[0])
        error = trial_step(y, h, tau, plant, mode, k, y_new, solver)
        if not error <= 1.0:
            h *= 0.5
            if h < MIN_FRACTION * duration:
                return STEP_TOO_SMALL
            continue
        which, length = first_event(y, h, tau, plant, mode, k, y_new, solver)
        if which >= 0:
            events += 1
            if events > MAX_EVENTS:
                return TOO_MANY_EVENTS
            trial_step(y, length, tau, plant, mode, k, y_new, solver)
            y[:] = y_new
            toggle(which, y, plant, mode)
            done += length
        else:
            y[:] = y_new
            done = duration if h == rest else done + h
        h = limit
    return OK


@compiled
def initial_mode(y, plant):
    """Return the mode at a state; a tip at gap = 0 that moves inward is in contact."""
    mode = np.zeros(2, dtype=np.bool_)
    gap, rate = event_value(GAP, y, y, plant)
    mode[0] = gap > 0.0 or (gap == 0.0 and rate > 0.0)
    mode[1] = 1.0 + plant.wall.D_f * rate > 0.0
    return mode


@compiled
def toggle(which, y, plant, mode):
    """Change the mode at an event; the gap rate decides whether a wall that was just met pushes."""
    mode[which] = not mode[which]
    if which == GAP:
        mode[1] = event_value(PULL, y, y, plant)[0] > 0.0


@compiled
def first_event(y, h, tau, plant, mode, k, y_end, solver):
    """Return the first event within an accepted step, or -1, and the step length up to this event (s)."""
    count = 2 if mode[0] and plant.wall.D_f > 0.0 else 1
    found, length = -1, h
    dy_end, y_try = k[12].copy(), np.empty(4)
    for which in range(count):
        sign = 1.0 if mode[which] else -1.0
        _v0, s0 = event_value(which, y, k[0], plant)
        v1, s1 = event_value(which, y_end, dy_end, plant)
        v1, s0, s1 = sign * v1, sign * s0, sign * s1
        args = (y, tau, plant, mode, k, y_try, solver)
        low, high = 0.0, h
        if v1 < 0.0:
            if s0 > 0.0 and s1 > 0.0:  # just entered and still within rounding of the crossing
                continue
            if s0 > 0.0:  # entered and left within the step: the crossing lies behind the extremum
                low = bisect(which, 1, sign, 0.0, h, args)
        elif s0 < 0.0 and s1 > 0.0:
            high = bisect(which, 1, -sign, 0.0, h, args)
            if sign * probe(which, high, args)[0] >= 0.0:
                continue
        else:
            continue
        root = bisect(which, 0, sign, low, high, args)
        if found < 0 or root < length:
            found, length = which, root
    return found, length


@compiled
def bisect(which, part, sign, low, high, args):
    """Return the step length at which `sign` times the value (part 0) or the slope (part 1) turns negative."""
    while True:
        middle = 0.5 * (low + high)
        if middle <= low or middle >= high:
            return high
        if sign * probe(which, middle, args)[part] >= 0.0:
            low = middle
        else:
            high = middle


@compiled
def probe(which, h, args):
    """Return an event function and its slope after a step of length h (s)."""
    y, tau, plant, mode, k, y_try, solver = args
    trial_step(y, h, tau, plant, mode, k, y_try, solver)
    return event_value(which, y_try, k[12], plant)


@compiled
def event_value(which, y, dy, plant):
    """Return the value and the time derivative of an event function; `dy` is the derivative of the state `y`."""
    arm, wall = plant.arm, plant.wall
    v1, v2 = tip_velocity(arm, y[:2], y[2:])
    rate = wall.n1 * v1 + wall.n2 * v2
    if which == GAP:
        return wall_gap(plant, y[:2]), rate
    dJ = jacobian_rate(arm, y[:2], y[2:])
    a1, a2 = tip_velocity(arm, y[:2], dy[2:])
    a1 += dJ[0, 0] * y[2] + dJ[0, 1] * y[3]
    a2 += dJ[1, 0] * y[2] + dJ[1, 1] * y[3]
    return 1.0 + wall.D_f * rate, wall.D_f * (wall.n1 * a1 + wall.n2 * a2)


@compiled
def trial_step(y, h, tau, plant, mode, k, y_new, solver):
    """Make one DOP853 step from y with k[0] = f(y): fill y_new and k[1..12], return the scaled error estimate."""
    for s in range(1, 12):
        for i in range(4):
            total = 0.0
            for j in range(s):
                total += A[s, j] * k[j, i]
            y_new[i] = y[i] + h * total
        derivative(y_new, tau, plant, mode, k[s])
    for i in range(4):
        total = 0.0
        for j in range(12):
            total += B[j] * k[j, i]
        y_new[i] = y[i] + h * total
    derivative(y_new, tau, plant, mode, k[12])
    return error_norm(y, y_new, h, k, solver)


@compiled
def error_norm(y, y_new, h, k, solver):
    """Return Hairer's combination of the embedded error estimates of orders 5 and 3, which is 1 at the tolerance."""
    sum5, sum3 = 0.0, 0.0
    for i in range(4):
        scale = solver.atol + solver.rtol * max(abs(y[i]), abs(y_new[i]))
        e5, e3 = 0.0, 0.0
        for j in range(13):
            e5 += E5[j] * k[j, i]
            e3 += E3[j] * k[j, i]
        sum5 += (e5 / scale) ** 2
        sum3 += (e3 / scale) ** 2
    if sum5 == 0.0 and sum3 == 0.0:
        return 0.0
    return h * sum5 / np.sqrt((sum5 + 0.01 * sum3) * 4.0)


@compiled
def derivative(y, tau, plant, mode, dy):
    """Write dy/dt with the force law of the mode, whatever the sign of the gap is."""
    q, dq = y[:2], y[2:]
    F = (0.0, 0.0)
    if mode[0] and mode[1]:
        dx1, dx2 = tip_velocity(plant.arm, q, dq)
        F = contact_force(plant.wall, wall_gap(plant, q), dx1, dx2)
    a1, a2 = acceleration(plant, q, dq, tau, F)
    dy[0], dy[1], dy[2], dy[3] = dq[0], dq[1], a1, a2


@compiled
def left_acceleration(y, tau, plant):
    """Return the joint acceleration (tuple of 2 floats, rad/s2) at a state under a torque."""
    return acceleration(plant, y[:2], y[2:], tau, external_force(plant, y[:2], y[2:]))
