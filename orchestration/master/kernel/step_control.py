"""A run of any algorithm, compiled: intervals between given points, steps within them.

    for each interval [times[k], times[k + 1]]:
        until its end is reached:
            h = the whole interval, or less if step control or an event asks for it
            save                                             if the step may have to be undone
            step (with step control: whole, back, and in two halves)
            too large an error: back, and a smaller h
            a chosen value has changed its sign: back, and bisect h until it changes within a tolerance
            record

Steps end on the points exactly: ticks of sampled units are among them.
"""

from math import isfinite

import numpy as np
from numba import njit

from orchestration.fmi.codes import WORST_ACCEPTED
from orchestration.master.kernel.correction import corrected_step
from orchestration.master.kernel.coupling import (
    HAS_JACOBIAN,
    INTERVAL,
    LAST_ERROR,
    N_PAST,
    NEXT_STEP,
    REJECTED,
    STEPS_MADE,
    TIME,
    Coupling,
    Method,
    Work,
)
from orchestration.master.kernel.exchange import FINE, Failure, copy, remember, restore, save
from orchestration.master.kernel.flat_system import Plan, record

TOO_SMALL = 102
DISCARD = 2
FULL, REACHED = -1, -2  # why a run returned, besides a failure
SAFETY, SMALLEST_FACTOR, LARGEST_FACTOR = 0.9, 0.2, 5.0
INTEGRAL, PROPORTIONAL = 0.7, 0.4  # exponents of the PI controller, over the error's order
_options = {"cache": True, "nogil": True, "error_model": "numpy"}


@njit(inline="always", **_options)
def advance(plan: Plan, coupling: Coupling, work: Work, method: Method, t: float, h: float) -> Failure:
    """One step of h s from t s; with step control made whole, taken back, and made in two halves."""
    failure = FINE
    for part in range(3 if method.controlled else 1):
        begin = t + 0.5 * h if part == 2 else t
        length = h if part == 0 else 0.5 * h
        if part == 1:
            copy(plan.reals, work.whole)
            failure = restore(plan, coupling, work)
        if failure[2] <= WORST_ACCEPTED:
            failure = corrected_step(plan, coupling, work, method, (begin, length))
        if failure[2] > WORST_ACCEPTED:
            return failure
        remember(plan, work, begin + length)
    return failure


@njit(**_options)
def estimate(plan: Plan, coupling: Coupling, work: Work, method: Method, h: float) -> tuple[float, int]:
    """The error of a step over what it may be, and the watched value with the largest."""
    share = h / coupling.limits[3]
    divisor = 2.0**method.error_order - 1.0
    largest, worst = 0.0, 0
    for j in range(coupling.watched.shape[0]):
        value = plan.reals[coupling.watched[j]]
        error = abs(value - work.whole[coupling.watched[j]]) / divisor
        accepted = coupling.watched_tolerances[j, 0] + coupling.watched_tolerances[j, 1] * abs(value)
        over = error / (accepted * share if coupling.accumulates[j] else accepted)
        if not over <= largest:  # NaN is the largest
            largest, worst = over, j
    return largest, worst


@njit(**_options)
def controlled_factor(error: float, last: float, order: int) -> float:
    """By which factor the PI controller changes the step; errors are relative to the accepted."""
    if not isfinite(error):
        return SMALLEST_FACTOR
    if error == 0.0:
        return LARGEST_FACTOR
    factor = SAFETY * error ** (-INTEGRAL / order)
    if last > 0.0:
        factor *= last ** (PROPORTIONAL / order)
    return min(LARGEST_FACTOR, max(SMALLEST_FACTOR, factor))


@njit(**_options)
def has_crossed(plan: Plan, coupling: Coupling, work: Work) -> bool:
    """Whether a value to watch has another sign than at the last save."""
    for j in coupling.crossings:
        if (plan.reals[j] > 0.0) != (work.kept_reals[j] > 0.0):
            return True
    return False


@njit(inline="always", **_options)
def attempt(plan: Plan, coupling: Coupling, work: Work, method: Method, t: float, h: float) -> tuple[float, Failure]:
    """Step h; if a watched sign changes, bisect to just after that.

    Returns
    -------
    tuple
        The step made, s, or 0 if step control refuses it; and how that went.
    """
    below, above, trial = 0.0, h, h
    tolerance = max(coupling.limits[4], 4e-16 * (abs(t) + h))
    found = False
    while True:
        failure = advance(plan, coupling, work, method, t, trial)
        if trial == h and not found and method.controlled:
            error, worst = estimate(plan, coupling, work, method, h)
            if failure[2] == DISCARD:
                failure, error = FINE, 1e300
            if failure[2] <= WORST_ACCEPTED and not adapt(work, method, h, error):
                return 0.0, (worst, 0, TOO_SMALL if work.numbers[NEXT_STEP] < coupling.limits[1] else 0)
        if failure[2] > WORST_ACCEPTED or found or coupling.crossings.shape[0] == 0:
            return trial, failure
        crossed = has_crossed(plan, coupling, work)
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
        failure = restore(plan, coupling, work)
        if failure[2] > WORST_ACCEPTED:
            return trial, failure


@njit(**_options)
def next_step(coupling: Coupling, work: Work, method: Method, left: float) -> float:
    """The step to try, s, when an interval has so much left."""
    if not method.controlled:
        return left
    h = min(work.numbers[NEXT_STEP], coupling.limits[2])
    if h >= left * (1.0 - 1e-12):
        return left
    return 0.5 * left if 2.0 * h > left else h


@njit(**_options)
def adapt(work: Work, method: Method, h: float, error: float) -> bool:
    """Choose the next step from the error of this one; returns whether this one is accepted."""
    accepted = error <= 1.0
    last = work.numbers[LAST_ERROR] if accepted else 0.0
    factor = controlled_factor(error, last, method.error_order)
    if accepted:
        work.numbers[LAST_ERROR] = max(error, 1e-4)
        if h < 0.999 * work.numbers[NEXT_STEP]:  # the interval was short, not the step
            factor = max(factor, min(LARGEST_FACTOR, work.numbers[NEXT_STEP] / h))
    else:
        factor = min(factor, SAFETY)
        work.integers[REJECTED] += 1
    work.numbers[NEXT_STEP] = h * factor
    return accepted


@njit(**_options)
def run(
    plan: Plan,
    coupling: Coupling,
    work: Work,
    method: Method,
    grid: tuple,
    span: tuple[int, int, int],
    rows: tuple,
) -> tuple[int, Failure]:
    """Go on until an interval is reached, the rows are full, or enough steps are made.

    Parameters
    ----------
    grid
        Points, s, shape (n + 1,), and lengths of the intervals, s, shape (n,), or (1,) if all are equal.
    span
        Interval to stop before, number of steps after which to return, and of how many steps one is
        recorded; the step that ends on an event is always.
    rows
        Times, s, shape (n_rows,), and recorded outputs, shape (n_rows, n_columns), to be filled.

    Returns
    -------
    tuple
        Number of rows filled, and (subject, call, status); the subject is `FULL` or `REACHED` if
        nothing failed.
    """
    times, lengths = grid
    row_times, values = rows
    last, budget, every = span
    guarded = method.controlled or coupling.crossings.shape[0] > 0
    count = 0
    while work.integers[INTERVAL] < last:
        due = coupling.crossings.shape[0] > 0 or (work.integers[STEPS_MADE] + 1) % every == 0
        if (due and count == row_times.shape[0]) or budget == 0:
            return count, (FULL, 0, 0)
        k = work.integers[INTERVAL]
        t = work.numbers[TIME]
        whole = t == times[k]
        left = (lengths[k] if lengths.shape[0] > 1 else lengths[0]) if whole else times[k + 1] - t
        h = next_step(coupling, work, method, left)
        if guarded:
            failure = save(plan, coupling, work)
            if failure[2] > WORST_ACCEPTED:
                return count, failure
        budget -= 1
        made, failure = attempt(plan, coupling, work, method, t, h)
        if failure[2] > WORST_ACCEPTED:
            return count, failure
        if made == 0.0:
            failure = restore(plan, coupling, work)
            if failure[2] > WORST_ACCEPTED:
                return count, failure
            if method.restarts:  # the error of the last value, over a small h, would be a large slope
                work.integers[N_PAST] = 1
            continue
        event = guarded and has_crossed(plan, coupling, work)
        if event:
            work.integers[N_PAST] = 1
            work.integers[HAS_JACOBIAN] = 0
        if made == left:
            work.integers[INTERVAL] = k + 1
            work.numbers[TIME] = times[k + 1]
        else:
            work.numbers[TIME] = t + made
        work.past_times[0] = work.numbers[TIME]
        work.integers[STEPS_MADE] += 1
        if event or work.integers[STEPS_MADE] % every == 0:
            row_times[count] = work.numbers[TIME]
            record(plan, values, np.uint64(count))
            count += 1
    return count, (REACHED, 0, 0)
