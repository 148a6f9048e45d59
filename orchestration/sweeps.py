"""Sweeps over the units, their inputs, and going back: what every algorithm's step is made of.

Every function returns (subject, call, status): status 0 or 1 means that all went well; else it is the
fmi2Status of that call of component `subject`.
"""

from numba import njit

from orchestration.calls import call_do_step, call_rates, call_state
from orchestration.coupling import (
    ASSUMED,
    CONTINUOUS,
    FRESH,
    GET_STATE,
    INTERVAL,
    ITERATION,
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
from orchestration.fmu import WORST_ACCEPTED
from orchestration.loop import (
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
_options = {"cache": True, "nogil": True, "error_model": "numpy"}


@njit(**_options)
def first_sweep(plan: Plan, coupling: Coupling, work: Work, method: Method, step: tuple[float, float]) -> Failure:
    """Step every unit; one of ratio r > 1 makes a step of r h in every r-th interval.

    A continuous one of these shows what it reached when the time is reached.
    """
    table, units, interval = plan.table, coupling.units, work.integers[INTERVAL]
    n = table.shape[0]
    if method.sequential:
        for i in range(n):
            if interval % units[i, RATIO] == 0:
                failure = step_unit(plan, coupling, work, method, i, step)
                if failure[2] <= WORST_ACCEPTED and not (units[i, RATIO] > 1 and units[i, CONTINUOUS]):
                    failure = show(plan, i)
                if failure[2] > WORST_ACCEPTED:
                    return failure
    else:
        for i in range(n):
            if interval % units[i, RATIO] == 0:
                failure = give_inputs(plan, coupling, work, method, i, step)
                if failure[2] > WORST_ACCEPTED:
                    return failure
        for i in range(n):
            if interval % units[i, RATIO] == 0:
                status = call_do_step(table[i, DO_STEP], table[i, COMPONENT], step[0], step[1] * units[i, RATIO])
                if status > WORST_ACCEPTED:
                    return i, DO_STEP, status
    for i in range(n):
        slow = units[i, RATIO] > 1 and units[i, CONTINUOUS] == 1
        due = (interval + 1) % units[i, RATIO] == 0 if slow else not method.sequential
        if due:
            failure = show(plan, i)
            if failure[2] > WORST_ACCEPTED:
                return failure
    return FINE


@njit(**_options)
def repeat_sweep(plan: Plan, coupling: Coupling, work: Work, method: Method, step: tuple[float, float]) -> Failure:
    """Step the continuous units again, with the assumed values as they are now."""
    failure = restore(plan, coupling, work, ITERATION)
    if failure[2] > WORST_ACCEPTED:
        return failure
    for i in range(plan.table.shape[0]):
        if coupling.units[i, CONTINUOUS]:
            failure = step_unit(plan, coupling, work, method, i, step)
            if failure[2] <= WORST_ACCEPTED:
                failure = show(plan, i)
            if failure[2] > WORST_ACCEPTED:
                return failure
    return FINE


@njit(**_options)
def step_unit(plan: Plan, coupling: Coupling, work: Work, method: Method, i: int, step: tuple[float, float]) -> Failure:
    """Hand component i its inputs and step it."""
    failure = give_inputs(plan, coupling, work, method, i, step)
    if failure[2] > WORST_ACCEPTED:
        return failure
    table = plan.table
    status = call_do_step(table[i, DO_STEP], table[i, COMPONENT], step[0], step[1] * coupling.units[i, RATIO])
    return i, DO_STEP, status


@njit(**_options)
def show(plan: Plan, i: int) -> Failure:
    """Fetch the outputs of component i."""
    call, status = get_outputs(plan.table, i)
    return i, call, status


@njit(**_options)
def give_inputs(
    plan: Plan, coupling: Coupling, work: Work, method: Method, i: int, step: tuple[float, float]
) -> Failure:
    """Set the inputs of component i for the step, and how they move in it."""
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
    return i, call, status


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
        past[age] = past[age - 1]
        times[age] = times[age - 1]
    past[0] = plan.reals
    times[0] = t
    work.integers[N_PAST] = min(work.integers[N_PAST] + 1, N_PAST_KEPT)


@njit(**_options)
def save(plan: Plan, coupling: Coupling, work: Work, level: int) -> Failure:
    """Save the state of every unit (level `STEP`) or of the continuous ones (level `ITERATION`)."""
    table, units = plan.table, coupling.units
    for i in range(table.shape[0]):
        if level == STEP or units[i, CONTINUOUS]:
            status = call_state(units[i, GET_STATE], table[i, COMPONENT], units[i, SAVED + level])
            if status > WORST_ACCEPTED:
                return i, SAVE, status
    if level == STEP:
        work.kept_reals[:] = plan.reals
        work.kept_discretes[:] = plan.discretes
        work.kept_past[:] = work.past
        work.kept_times[:] = work.past_times
        work.kept_integers[:] = work.integers
    return FINE


@njit(**_options)
def restore(plan: Plan, coupling: Coupling, work: Work, level: int) -> Failure:
    """Go back to what `save` saved."""
    table, units = plan.table, coupling.units
    for i in range(table.shape[0]):
        if level == STEP or units[i, CONTINUOUS]:
            status = call_state(units[i, SET_STATE], table[i, COMPONENT], work.states[level, i])
            if status > WORST_ACCEPTED:
                return i, RESTORE, status
    if level == STEP:
        plan.reals[:] = work.kept_reals
        plan.discretes[:] = work.kept_discretes
        work.past[:] = work.kept_past
        work.past_times[:] = work.kept_times
        work.integers[N_PAST] = work.kept_integers[N_PAST]
    return FINE
