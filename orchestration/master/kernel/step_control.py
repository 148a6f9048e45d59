"""The compiled loop of all algorithms: it makes steps, of controlled size if asked, between given points of time.

    for each interval [times[k], times[k + 1]]:
        until its end is reached:
            h = the whole interval, or less if step control or an event asks for it
            save                                             if the step may have to be undone
            step (with step control: whole, back, and in two halves)
            too large an error: back, and a smaller h
            a chosen value has changed its sign: back, and bisect h until it changes within a tolerance
            record

Steps end on the points exactly: ticks of sampled components are among them.
"""

from math import isfinite

import numpy as np

from orchestration.fmi.codes import WORST_ACCEPTED, Status
from orchestration.master.kernel.codes import Failure, Reason, Row
from orchestration.master.kernel.compiled import compiled, compiled_for_callers, compiled_in_place
from orchestration.master.kernel.correction import corrected_step
from orchestration.master.kernel.coupling import Coupling
from orchestration.master.kernel.exchange import FINE, remember, restore, save, store
from orchestration.master.kernel.flat_system import Plan, record

SAFETY, SMALLEST_FACTOR, LARGEST_FACTOR = 0.9, 0.2, 5.0
INTEGRAL, PROPORTIONAL = 0.7, 0.4  # exponents of the PI controller, over the error's order
DISCARDED = 1e300  # the error of a step that a component discards


@compiled
def run(
    plan: Plan,
    c: Coupling,
    grid: tuple[np.ndarray, np.ndarray],
    span: tuple[int, int, int],
    rows: tuple[np.ndarray, np.ndarray],
) -> tuple[int, Failure]:
    """Run on until a given interval is reached, the rows are full, or enough steps are made.

    Parameters
    ----------
    grid
        Points, s, shape (n + 1,), and lengths of the intervals, s, shape (n,), or (1,) if all are equal.
    span
        Interval to stop before, number of steps after which to return, and n where every n-th step is recorded.
        A step that ends on an event is always recorded.
    rows
        Times, s, shape (n_rows,), and recorded outputs, shape (n_rows, n_columns), to be filled.

    Returns
    -------
    tuple
        Number of rows filled, and what failed; the subject is negative if nothing did.
    """
    times, lengths = grid
    row_times, values = rows
    last, budget, every = span
    state, method, locates = c.state, c.method, c.crossings.shape[0] > 0
    guarded = method.controlled == 1 or locates
    count = 0
    while state.interval < last:
        due = locates or (state.steps_made + 1) % every == 0
        if (due and count == row_times.shape[0]) or budget == 0:
            break
        k, t = state.interval, state.time
        left = times[k + 1] - t
        if t == times[k]:
            left = lengths[k] if lengths.shape[0] > 1 else lengths[0]
        h = next_step(c, left)
        failure = save(c) if guarded else FINE
        made = h
        if failure[2] <= WORST_ACCEPTED:
            budget -= 1
            made, failure = attempt(c, t, h)
        if made == 0.0 and failure[2] <= WORST_ACCEPTED:
            failure = restore(c)
            if method.restarts == 1:  # the error of the last value, over a small h, would be a large slope
                state.n_past = 1
        if failure[2] > WORST_ACCEPTED:
            return count, failure
        if made == 0.0:
            continue
        event = guarded and has_crossed(c)
        if event:
            state.n_past = 1
            state.has_jacobian = 0
        if made == left:
            state.interval = k + 1
            state.time = times[k + 1]
        else:
            state.time = t + made
        c.history[Row.LAST, c.reals.shape[0]] = state.time
        state.steps_made += 1
        if event or state.steps_made % every == 0:
            row_times[count] = state.time
            record(plan, values, np.uint64(count))
            count += 1
    return count, FINE


@compiled_for_callers
def next_step(c: Coupling, left: float) -> float:
    """Return the step to try, s, for the rest of an interval."""
    if c.method.controlled == 0:
        return left
    h = min(c.state.next_step, c.method.largest_step)
    if h >= left * (1.0 - 1e-12):
        return left
    return 0.5 * left if 2.0 * h > left else h


@compiled_in_place
def attempt(c: Coupling, t: float, h: float) -> tuple[float, Failure]:
    """Make a step of h s; if a watched sign changes in it, bisect to a shorter step that ends just after the change.

    Returns
    -------
    tuple
        The step made, s, or 0 if step control refuses it; and how that went.
    """
    below, above, trial = 0.0, h, h
    tolerance = max(c.method.crossing_tolerance, 4e-16 * (abs(t) + h))
    found = False
    while True:
        failure = advance(c, t, trial)
        if trial == h and not found and c.method.controlled == 1:
            error, worst = estimate(c, h)
            refused = (worst, 0, Reason.TOO_SMALL.value)
            if failure[2] == Status.DISCARD:
                refused, failure, error = failure, FINE, DISCARDED
            if failure[2] <= WORST_ACCEPTED and not adapt(c, h, error):
                too_small = c.state.next_step < c.method.smallest_step
                return 0.0, refused if too_small else (worst, 0, 0)
        if failure[2] > WORST_ACCEPTED or found or c.crossings.shape[0] == 0:
            return trial, failure
        crossed = has_crossed(c)
        if trial == h and not crossed:
            return h, failure
        if crossed:
            above = trial
        else:
            below = trial
        found = above - below <= tolerance
        if found and h - above < max(tolerance, 1e-6 * h):  # a rest so short would spoil the polynomials
            above = h
        if found and crossed and trial == above:
            return trial, failure
        trial = above if found else 0.5 * (below + above)
        failure = restore(c)
        if failure[2] > WORST_ACCEPTED:
            return trial, failure


@compiled_in_place
def advance(c: Coupling, t: float, h: float) -> Failure:
    """Make a step of h s from t s; under step control the step is made whole, taken back, and made in two halves."""
    failure = FINE
    for part in range(3 if c.method.controlled == 1 else 1):
        begin = t + 0.5 * h if part == 2 else t
        length = h if part == 0 else 0.5 * h
        if part == 1:
            store(c, Row.WHOLE)
            failure = restore(c)
        if failure[2] <= WORST_ACCEPTED:
            failure = corrected_step(c, (begin, length))
        if failure[2] > WORST_ACCEPTED:
            return failure
        remember(c, begin + length)
    return failure


@compiled_for_callers
def estimate(c: Coupling, h: float) -> tuple[float, int]:
    """Return the error of a step divided by the accepted error, and the watched value with the largest error."""
    share = h / c.method.duration
    divisor = 2.0**c.method.error_order - 1.0
    largest, worst = 0.0, 0
    for j in range(c.watched.shape[0]):
        watched = c.watched[j]
        value = c.reals[watched.index]
        error = abs(value - c.history[Row.WHOLE, watched.index]) / divisor
        accepted = watched.absolute + watched.relative * abs(value)
        over = error / (accepted * share if watched.accumulates == 1 else accepted)
        if not over <= largest:  # NaN is the largest
            largest, worst = over, j
    return largest, worst


@compiled_for_callers
def adapt(c: Coupling, h: float, error: float) -> bool:
    """Choose the next step from the error of the present step; returns whether the present step is accepted."""
    state = c.state
    accepted = error <= 1.0
    last = state.last_error if accepted else 0.0
    factor = controlled_factor(error, last, c.method.error_order)
    if accepted:
        state.last_error = max(error, 1e-4)
        if h < 0.999 * state.next_step:  # the interval was short, not the step
            factor = max(factor, min(LARGEST_FACTOR, state.next_step / h))
    else:
        factor = min(factor, SAFETY)
        state.rejected += 1
    state.next_step = h * factor
    return accepted


@compiled_for_callers
def controlled_factor(error: float, last: float, order: int) -> float:
    """Return the factor by which the PI controller changes the step; errors are relative to the accepted error."""
    if not isfinite(error):
        return SMALLEST_FACTOR
    if error == 0.0:
        return LARGEST_FACTOR
    factor = SAFETY * error ** (-INTEGRAL / order)
    if last > 0.0:
        factor *= last ** (PROPORTIONAL / order)
    return min(LARGEST_FACTOR, max(SMALLEST_FACTOR, factor))


@compiled_for_callers
def has_crossed(c: Coupling) -> bool:
    """Whether a watched value has another sign than at the last save."""
    for j in c.crossings:
        if (c.reals[j] > 0.0) != (c.history[Row.KEPT, j] > 0.0):
            return True
    return False
