"""Sweeps over the units, their inputs, and going back: what every algorithm's step is made of.

Every function returns (subject, call, status): status 0 or 1 means that all went well; else it is the
fmi2Status of that call of component `subject`.
"""

import numpy as np
from numba import njit

from orchestration.fmi.codes import WORST_ACCEPTED
from orchestration.fmi.native_calls import call_do_step, call_rates, call_state
from orchestration.master.kernel.coupling import (
    ASSUMED,
    CONTINUOUS,
    FRESH,
    GET_STATE,
    INTERVAL,
    N_PAST,
    N_PAST_KEPT,
    RATE_1,
    RATE_2,
    RATES_COUNT,
    RATES_FUNCTION,
    RATES_ORDERS,
    RATES_REFERENCES,
    RATES_VALUES,
    RATIO,
    SAVED,
    SET_STATE,
    SOURCE,
    STARTING,
    STEP,
    TARGET,
    Coupling,
    Method,
    Work,
)
from orchestration.master.kernel.flat_system import (
    CALL_NAMES,
    COMPONENT,
    DO_STEP,
    END_DISCRETE,
    END_REAL,
    FIRST_DISCRETE,
    FIRST_REAL,
    Plan,
    copy_links,
    get_outputs,
    set_inputs,
)

Failure = tuple[int, int, int]
FINE = (0, 0, 0)
SAVE, RESTORE, RATES, DIRECTION = 1000, 1001, 1002, 1003
STEP_CALL_NAMES = CALL_NAMES | {
    SAVE: "fmi2GetFMUstate",
    RESTORE: "fmi2SetFMUstate",
    RATES: "fmi2SetRealInputDerivatives",
    DIRECTION: "fmi2GetDirectionalDerivative",
}
ALL, AGAIN = -1, -2  # what to sweep over
GIVE, MAKE, SHOW = range(3)
_options = {"cache": True, "nogil": True, "error_model": "numpy"}


@njit(**_options)
def copy(source: np.ndarray, target: np.ndarray) -> None:
    """Copy numbers; an assignment of slices would compile a second of error messages each time."""
    for i in range(source.shape[0]):
        target[i] = source[i]


@njit(**_options)
def sweep(plan: Plan, coupling: Coupling, work: Work, method: Method, step: tuple[float, float], only: int) -> Failure:
    """Set inputs, step, get outputs: of all units, of the continuous ones again, or of one of them again.

    The order is unit by unit, or in the first sweep of a parallel exchange action by action. (There is
    one place for each call: what is inlined twice is compiled twice.) A unit of ratio r > 1 makes a
    step of r h in every r-th interval; a continuous one of these shows what it reached when the time is
    reached.

    Parameters
    ----------
    only
        `ALL`, `AGAIN`, or a component.
    """
    table, units, interval = plan.table, coupling.units, work.integers[INTERVAL]
    n = table.shape[0]
    by_unit = method.sequential or only != ALL
    i, action = 0, GIVE
    call, status = 0, 0
    while i < n and action <= SHOW:
        ratio, continuous = units[i, RATIO], units[i, CONTINUOUS] == 1
        due = (only == ALL or only == i or (only == AGAIN and continuous)) and interval % ratio == 0
        if action == SHOW and ratio > 1 and continuous:
            due = (interval + 1) % ratio == 0
        if due:
            if action == GIVE:
                call, status = give_inputs(plan, coupling, work, method, i, step)
            elif action == MAKE:
                call, status = DO_STEP, call_do_step(table[i, DO_STEP], table[i, COMPONENT], step[0], step[1] * ratio)
            else:
                call, status = get_outputs(table, i)
            if status > WORST_ACCEPTED:
                return i, call, status
        if by_unit:
            action += 1
            if action > SHOW:
                i, action = i + 1, GIVE
        else:
            i += 1
            if i == n:
                i, action = 0, action + 1
    return FINE


@njit(**_options)
def give_inputs(
    plan: Plan, coupling: Coupling, work: Work, method: Method, i: int, step: tuple[float, float]
) -> tuple[int, int]:
    """Set the inputs of component i for the step, and how they move in it; returns (call, status)."""
    table, reals, row = plan.table, plan.reals, coupling.units[i]
    correcting = method.max_iterations > 0 or work.integers[STARTING] == 1
    for j in range(table[i, FIRST_REAL], table[i, END_REAL]):
        link = coupling.links[j]
        assumed = link[ASSUMED] == 1 and correcting
        end = work.end[j] if assumed else reals[link[SOURCE]]
        if link[RATE_1] < 0:
            reals[link[TARGET]] = end
        else:
            known = assumed or link[FRESH] == 1
            value, rate, curvature = polynomial(link[SOURCE], work, method.order, step[1], known, end)
            reals[link[TARGET]] = value
            work.rates[link[RATE_1]] = rate
            if link[RATE_2] >= 0:
                work.rates[link[RATE_2]] = curvature
    copy_links(plan.discrete_links, table[i, FIRST_DISCRETE], table[i, END_DISCRETE], plan.discretes)
    call, status = set_inputs(table, i)
    if status <= WORST_ACCEPTED and row[RATES_COUNT] > 0:
        call = RATES
        status = call_rates(
            row[RATES_FUNCTION],
            table[i, COMPONENT],
            row[RATES_REFERENCES],
            row[RATES_COUNT],
            row[RATES_ORDERS],
            row[RATES_VALUES],
        )
    return call, status


@njit(**_options)
def polynomial(source: int, work: Work, order: int, h: float, known: bool, end: float) -> tuple[float, float, float]:
    """Value, first and second derivative at t of the polynomial through an output's values.

    It passes through the value `end` at t + h, if that is known, and as many values at t and before
    as `order` asks for and the past since the last event has.
    """
    y, t = work.past, work.past_times
    n = work.integers[N_PAST]
    value = y[0, source]
    if known:
        to_end = (end - value) / h
        if order < 2 or n < 2:
            return value, to_end, 0.0
        behind = t[0] - t[1]
        slope = (value - y[1, source]) / behind
        bend = (to_end - slope) / (h + behind)
        return value, slope + bend * behind, 2 * bend
    if n < 2:
        return value, 0.0, 0.0
    behind = t[0] - t[1]
    slope = (value - y[1, source]) / behind
    if order < 2 or n < 3:
        return value, slope, 0.0
    before = (y[1, source] - y[2, source]) / (t[1] - t[2])
    bend = (slope - before) / (t[0] - t[2])
    return value, slope + bend * behind, 2 * bend


@njit(**_options)
def remember(plan: Plan, work: Work, t: float) -> None:
    """Make the present values the youngest of the past."""
    past, times = work.past, work.past_times
    for age in range(N_PAST_KEPT - 1, 0, -1):
        copy(past[age - 1], past[age])
        times[age] = times[age - 1]
    copy(plan.reals, past[0])
    times[0] = t
    work.integers[N_PAST] = min(work.integers[N_PAST] + 1, N_PAST_KEPT)


@njit(**_options)
def turn(plan: Plan, coupling: Coupling, work: Work, level: int, only: int, back: bool) -> Failure:
    """Save, or go `back` to, the state of all units, of the continuous ones (`AGAIN`), or of one."""
    table, units = plan.table, coupling.units
    for i in range(table.shape[0]):
        if only == ALL or only == i or (only == AGAIN and units[i, CONTINUOUS] == 1):
            state = work.states[level, i] if back else units[i, SAVED + level]
            status = call_state(units[i, SET_STATE if back else GET_STATE], table[i, COMPONENT], state)
            if status > WORST_ACCEPTED:
                return i, RESTORE if back else SAVE, status
    return FINE


@njit(**_options)
def save(plan: Plan, coupling: Coupling, work: Work) -> Failure:
    """Save everything at level `STEP`."""
    copy(plan.reals, work.kept_reals)
    copy(plan.discretes, work.kept_discretes)
    copy(work.past_times, work.kept_times)
    copy(work.integers, work.kept_integers)
    for age in range(N_PAST_KEPT):
        copy(work.past[age], work.kept_past[age])
    return turn(plan, coupling, work, STEP, ALL, False)


@njit(**_options)
def restore(plan: Plan, coupling: Coupling, work: Work) -> Failure:
    """Go back to what `save` saved."""
    copy(work.kept_reals, plan.reals)
    copy(work.kept_discretes, plan.discretes)
    copy(work.kept_times, work.past_times)
    for age in range(N_PAST_KEPT):
        copy(work.kept_past[age], work.past[age])
    work.integers[N_PAST] = work.kept_integers[N_PAST]
    return turn(plan, coupling, work, STEP, ALL, True)
