"""Sweeps over the components of a system: set inputs, make steps, get outputs, and restore saved states.

Every step of every algorithm consists of sweeps. A function that makes several calls returns
`orchestration.master.kernel.codes.Failure`; `FINE` says that all went well.
"""

import numpy as np

from orchestration.fmi.codes import WORST_ACCEPTED
from orchestration.fmi.native_calls import call_do_step, call_rates, call_state, copy_bytes
from orchestration.master.kernel.codes import (
    N_PAST,
    Action,
    Column,
    Failure,
    Group,
    Level,
    Row,
    Scope,
    Turn,
)
from orchestration.master.kernel.compiled import compiled_for_callers
from orchestration.master.kernel.coupling import Coupling
from orchestration.master.kernel.flat_system import copy_links, exchange

FINE = (-1, 0, 0)
SIZE_OF_ADDRESS, SIZE_OF_REAL, SIZE_OF_DISCRETE = 8, 8, 4  # bytes


@compiled_for_callers
def sweep(c: Coupling, step: tuple[float, float], scope: Scope) -> Failure:
    """Set inputs, make steps and get outputs: of all components, of continuous ones again, or of one again.

    The order is component by component, or in the first sweep of a parallel exchange action by action.
    A component of ratio r > 1 makes a step of r h in every r-th interval. If it is continuous, its new outputs are
    fetched when the end of its step is reached. Each call stands in one place, because code that is inlined twice
    is compiled twice.
    """
    table, interval = c.table, c.state.interval
    n = table.shape[0]
    by_component = c.method.sequential == 1 or scope != Scope.ALL
    i = action = zero = table.shape[0] - n  # a literal 0 would be a type of its own: callees compiled twice
    call, status = 0, 0
    while i < n and action < Action.DONE:
        ratio, continuous = table[i, Column.RATIO], table[i, Column.IS_CONTINUOUS] == 1
        due = concerns(c, i, scope) and interval % ratio == 0
        if action == Action.SHOW and ratio > 1 and continuous:
            due = (interval + 1) % ratio == 0
        if due:
            if action == Action.MAKE:
                call = Column.DO_STEP.value
                status = call_do_step(table[i, Column.DO_STEP], table[i, Column.INSTANCE], step[0], step[1] * ratio)
            else:
                if action == Action.GIVE:
                    move_inputs(c, i, step[1])
                call, status = exchange(table, i, Column.SET_REAL if action == Action.GIVE else Column.GET_REAL)
                if action == Action.GIVE and status <= WORST_ACCEPTED and rates_count(table, i) > 0:
                    call, status = set_rates(table, i)
            if status > WORST_ACCEPTED:
                return i, call, status
        if by_component:
            action += 1
            if action == Action.DONE:
                i, action = i + 1, zero
        else:
            i += 1
            if i == n:
                i, action = zero, action + 1
    return FINE


@compiled_for_callers
def concerns(c: Coupling, i: int, scope: Scope) -> bool:
    """Whether component i is within the scope."""
    if scope == Scope.ONE:
        return i == c.state.moved
    return scope == Scope.ALL or c.table[i, Column.IS_CONTINUOUS] == 1


@compiled_for_callers
def move_inputs(c: Coupling, i: int, h: float) -> None:
    """Compute the inputs of component i for a step of h s, and how they move in it."""
    correcting = c.method.max_iterations > 0 or c.state.starting == 1
    for j in range(c.table[i, Column.FIRST_REAL], c.table[i, Column.END_REAL]):
        link = c.links[j]
        assumed = link.assumed == 1 and correcting
        end = link.end if assumed else c.reals[link.source]
        if link.rate < 0:
            c.reals[link.target] = end
        else:
            if assumed or link.fresh == 1:
                value, rate, curvature = polynomial_to(c, link.source, h, end)
            else:
                value, rate, curvature = polynomial(c, link.source)
            c.reals[link.target] = value
            c.rates[link.rate] = rate
            if link.curvature >= 0:
                c.rates[link.curvature] = curvature
    first, last = c.table[i, Column.FIRST_DISCRETE], c.table[i, Column.END_DISCRETE]
    copy_links(c.discrete_links, first, last, c.discretes)


@compiled_for_callers
def rates_count(table: np.ndarray, i: int) -> int:
    """Return the number of input derivatives that component i accepts."""
    return table[i, Column.SET_RATES + Group.COUNT]


@compiled_for_callers
def set_rates(table: np.ndarray, i: int) -> tuple[int, int]:
    """Hand component i its input derivatives; returns (call, status)."""
    status = call_rates(
        table[i, Column.SET_RATES + Group.FUNCTION],
        table[i, Column.INSTANCE],
        table[i, Column.SET_RATES + Group.REFERENCES],
        table[i, Column.SET_RATES + Group.COUNT],
        table[i, Column.SET_RATES + Group.ORDERS],
        table[i, Column.SET_RATES + Group.VALUES],
    )
    return Column.SET_RATES.value, status


@compiled_for_callers
def polynomial_to(c: Coupling, source: int, h: float, end: float) -> tuple[float, float, float]:
    """Return value, first and second derivative at t of a polynomial through `end` at t + h.

    The polynomial also passes through values of the output at t and before. Their number is that of the method's
    order, or smaller if the past since the last event is shorter.
    """
    y, t = c.history, c.reals.shape[0]
    value = y[Row.LAST, source]
    to_end = (end - value) / h
    if c.method.order < 2 or c.state.n_past < 2:
        return value, to_end, 0.0
    behind = y[Row.LAST, t] - y[Row.BEFORE, t]
    slope = (value - y[Row.BEFORE, source]) / behind
    bend = (to_end - slope) / (h + behind)
    return value, slope + bend * behind, 2 * bend


@compiled_for_callers
def polynomial(c: Coupling, source: int) -> tuple[float, float, float]:
    """Return value, first and second derivative at t of the polynomial through an output's past values.

    The number of values is that of the method's order, or smaller if the past since the last event is shorter.
    """
    y, t, n = c.history, c.reals.shape[0], c.state.n_past
    value = y[Row.LAST, source]
    if n < 2:
        return value, 0.0, 0.0
    behind = y[Row.LAST, t] - y[Row.BEFORE, t]
    slope = (value - y[Row.BEFORE, source]) / behind
    if c.method.order < 2 or n < 3:
        return value, slope, 0.0
    before = (y[Row.BEFORE, source] - y[Row.OLDEST, source]) / (y[Row.BEFORE, t] - y[Row.OLDEST, t])
    bend = (slope - before) / (y[Row.LAST, t] - y[Row.OLDEST, t])
    return value, slope + bend * behind, 2 * bend


@compiled_for_callers
def row_address(c: Coupling, row: Row) -> int:
    """The address of a row of the history."""
    return c.method.history + SIZE_OF_REAL * row * c.history.shape[1]


@compiled_for_callers
def copy_past(c: Coupling, source: Row, target: Row) -> None:
    """Copy three rows of the history that follow each other."""
    copy_bytes(row_address(c, source), row_address(c, target), N_PAST * SIZE_OF_REAL * c.history.shape[1])


@compiled_for_callers
def store(c: Coupling, target: Row) -> None:
    """Copy the present Real values into a row of the history."""
    copy_bytes(c.method.reals, row_address(c, target), SIZE_OF_REAL * c.reals.shape[0])


@compiled_for_callers
def bring_back(c: Coupling, source: Row) -> None:
    """Copy a row of the history to the present Real values."""
    copy_bytes(row_address(c, source), c.method.reals, SIZE_OF_REAL * c.reals.shape[0])


@compiled_for_callers
def remember(c: Coupling, t: float) -> None:
    """Add the present values to the history as its youngest row."""
    row = SIZE_OF_REAL * c.history.shape[1]
    copy_bytes(c.method.history + row, c.method.history + 2 * row, row)
    copy_bytes(c.method.history, c.method.history + row, row)
    store(c, Row.LAST)
    c.history[Row.LAST, c.reals.shape[0]] = t
    if c.state.n_past < N_PAST:
        c.state.n_past += 1


@compiled_for_callers
def turn(c: Coupling, level: Level, scope: Scope, to: Turn) -> Failure:
    """Save or restore the states of the components within the scope."""
    n = c.table.shape[0]
    back = to == Turn.RESTORE
    call = Column.SET_STATE.value if back else Column.GET_STATE.value
    for i in range(n):
        if concerns(c, i, scope):
            slot = c.method.saved_states + SIZE_OF_ADDRESS * (level * n + i)
            state = c.states[level, i] if back else slot
            status = call_state(c.table[i, call], c.table[i, Column.INSTANCE], state)
            if status > WORST_ACCEPTED:
                return i, call, status
    return FINE


@compiled_for_callers
def save(c: Coupling) -> Failure:
    """Save everything that step control or the location of a crossing may have to go back to."""
    store(c, Row.KEPT)
    copy_bytes(c.method.discretes, c.method.kept_discretes, SIZE_OF_DISCRETE * c.discretes.shape[0])
    copy_past(c, Row.LAST, Row.KEPT_LAST)
    c.state.kept_n_past = c.state.n_past
    return turn(c, Level.CONTROL, Scope.ALL, Turn.SAVE)


@compiled_for_callers
def restore(c: Coupling) -> Failure:
    """Restore the values and states that `save` saved."""
    bring_back(c, Row.KEPT)
    copy_bytes(c.method.kept_discretes, c.method.discretes, SIZE_OF_DISCRETE * c.discretes.shape[0])
    copy_past(c, Row.KEPT_LAST, Row.LAST)
    c.state.n_past = c.state.kept_n_past
    return turn(c, Level.CONTROL, Scope.ALL, Turn.RESTORE)
