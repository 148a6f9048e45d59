"""Names the numbers that the compiled loops and their callers share: columns of tables, codes, fields of records.

Tables of integers have an IntEnum of columns, tables of mixed numbers a record type with named fields.
A name stands for one number: no member of one enumeration is a member of another. Compiled code takes both
at no cost, and compiles a function once for all members of an enumeration (once for each number otherwise).
"""

from enum import IntEnum

import numpy as np


class Column(IntEnum):
    """Columns of the table of components, which has a row for each component; a call is named by its first column."""

    INSTANCE = 0  # the address of the instance
    DO_STEP = 1  # the address of the function
    FIRST_REAL = 2  # the component's range in the Real links, then in the discrete ones
    END_REAL = 3
    FIRST_DISCRETE = 4
    END_DISCRETE = 5
    SET_REAL = 6  # a group of columns, see `Group`; so are the next five
    SET_INTEGER = 10
    SET_BOOLEAN = 14
    GET_REAL = 18
    GET_INTEGER = 22
    GET_BOOLEAN = 26
    GET_STATE = 30  # addresses of functions
    SET_STATE = 31
    GET_DIRECTION = 32
    SET_RATES = 33  # a group with orders
    IS_CONTINUOUS = 38  # 1, or 0 for a component that is sampled
    RATIO = 39  # communication steps per step of the component
    REAL_OUTPUTS = 40  # number of outputs among the fetched Reals, of which they are the first


N_COLUMNS = 41
GROUP_SIZE = 4


class Group(IntEnum):
    """Columns of a call with variables, counted from its first."""

    FUNCTION = 0  # address
    REFERENCES = 1  # address of the value references
    COUNT = 2  # number of variables; 0 for no call
    VALUES = 3  # address of the first value
    ORDERS = 4  # address of the orders of derivatives, of SET_RATES only


CALL_NAMES = {
    Column.DO_STEP: "fmi2DoStep",
    Column.SET_REAL: "fmi2SetReal",
    Column.SET_INTEGER: "fmi2SetInteger",
    Column.SET_BOOLEAN: "fmi2SetBoolean",
    Column.GET_REAL: "fmi2GetReal",
    Column.GET_INTEGER: "fmi2GetInteger",
    Column.GET_BOOLEAN: "fmi2GetBoolean",
    Column.GET_STATE: "fmi2GetFMUstate",
    Column.SET_STATE: "fmi2SetFMUstate",
    Column.GET_DIRECTION: "fmi2GetDirectionalDerivative",
    Column.SET_RATES: "fmi2SetRealInputDerivatives",
}
"""The FMI function behind each call."""


class Kind(IntEnum):
    """Kinds of operations in a fixed step."""

    TRANSFER = 0
    STEP = 1
    COPY_REALS = 2
    COPY_DISCRETES = 3


OPERATION = np.dtype(
    [
        ("kind", np.int64),
        ("function", np.int64),  # address
        ("instance", np.int64),  # address
        ("first", np.int64),  # address of the value references, or the first place to copy from
        ("count", np.int64),
        ("place", np.int64),  # address of the first value, or the first place to copy to
        ("subject", np.int64),  # position of the component
        ("call", np.int64),  # a `Column`
    ]
)
"""An operation of a fixed step."""

LINK = np.dtype(
    [
        ("source", np.int64),  # place in the buffer of Real values
        ("target", np.int64),
        ("rate", np.int64),  # place of the input's first derivative; -1 if the input is held
        ("curvature", np.int64),  # place of its second derivative; -1 for none
        ("fresh", np.int64),  # whether the source has stepped when the input is set
        ("assumed", np.int64),  # whether the source's value at the end of the step is assumed
        ("component", np.int64),  # position of the component with the input
        ("reference", np.int64),  # address of the input's value reference
        ("absolute", np.float64),  # tolerances of the correction
        ("relative", np.float64),
        ("end", np.float64),  # assumed value at the end of the step
        ("residual", np.float64),  # source minus assumed value
        ("last_residual", np.float64),  # of the sweep before
        ("pair_start", np.float64),  # of Aitken's iteration: the assumed value before it,
        ("pair_residual", np.float64),  # and what it changes unrelaxed
    ]
)
"""A connection of Real variables: indices of both ends, and the state of its correction."""

WATCHED = np.dtype(
    [
        ("index", np.int64),  # place in the buffer of Real values
        ("accumulates", np.int64),  # whether errors add up from step to step, or come anew from the inputs
        ("absolute", np.float64),
        ("relative", np.float64),
    ]
)
"""A value under step control, and its tolerances."""

METHOD = np.dtype(
    [
        ("sequential", np.int64),  # whether components step one after the other
        ("order", np.int64),  # of the polynomials of inputs
        ("newton", np.int64),  # whether Newton's method corrects; else Aitken's relaxation
        ("directional", np.int64),  # whether the components give the Jacobian
        ("sweeps", np.int64),  # 0 for as many as converge
        ("max_iterations", np.int64),  # 0 for no correction
        ("restarts", np.int64),  # whether a step without a past is made twice, to be as exact as the others
        ("controlled", np.int64),  # whether the step size is controlled
        ("error_order", np.int64),  # of the estimated error
        ("first_step", np.float64),  # s
        ("smallest_step", np.float64),  # s
        ("largest_step", np.float64),  # s
        ("duration", np.float64),  # of the run, s
        ("crossing_tolerance", np.float64),  # how closely crossings are located, s
        ("one", np.int64),  # address of the number one
        ("saved_states", np.int64),  # address of the table of saved states
        ("history", np.int64),  # addresses of the history, of the buffers, and of a copy
        ("reals", np.int64),
        ("discretes", np.int64),
        ("kept_discretes", np.int64),
        ("give", np.int64),  # address of the function that gives inputs the values of series; 0 without series
        ("series", np.int64),  # address of the table of series
    ]
)
"""An algorithm as numbers, and its limits."""

STATE = np.dtype(
    [
        ("interval", np.int64),  # intervals between given points that are done
        ("steps_made", np.int64),
        ("n_past", np.int64),  # values that polynomials may use
        ("kept_n_past", np.int64),  # at the last save
        ("has_jacobian", np.int64),
        ("iterations", np.int64),  # sweeps of corrections
        ("rejected", np.int64),  # steps refused by step control
        ("starting", np.int64),  # whether a step without a past is being made
        ("moved", np.int64),  # the component to sweep over alone
        ("time", np.float64),  # s
        ("next_step", np.float64),  # s, as step control wants it
        ("last_error", np.float64),  # of the last step over the accepted error
        ("jacobian_step", np.float64),  # step for which the Jacobian was made, s
    ]
)
"""The state of a run of any algorithm."""


class Row(IntEnum):
    """Rows of the history: Real values at some time, with the time in the last column."""

    LAST = 0  # the present communication point and the two before it
    BEFORE = 1
    OLDEST = 2
    KEPT_LAST = 3  # the same at the last save
    KEPT_BEFORE = 4
    KEPT_OLDEST = 5
    KEPT = 6  # the buffer at the last save
    WHOLE = 7  # after a step made as a whole
    TRIAL = 8  # before inputs are displaced


N_ROWS = 9
N_PAST = 3


class Level(IntEnum):
    """Levels of nested rollbacks: a correction goes back within step control or event location."""

    ITERATION = 0
    CONTROL = 1


N_LEVELS = 2


class Turn(IntEnum):
    """What a loop does with the components' states."""

    SAVE = 0
    RESTORE = 1


class Scope(IntEnum):
    """Sets of components that a sweep, a save or a restoration can be for."""

    ALL = 0
    AGAIN = 1  # the continuous ones
    ONE = 2  # the one in ``moved`` of the state


class Action(IntEnum):
    """What a sweep does with a component."""

    GIVE = 0
    MAKE = 1
    SHOW = 2
    DONE = 3


class Reason(IntEnum):
    """Reasons why a loop ended although no call of an FMI function failed; the numbers are above every fmi2Status."""

    NOT_CONVERGED = 100
    SINGULAR = 101
    TOO_SMALL = 102


Failure = tuple[int, int, int]
"""(subject, call, status): the fmi2Status that a call, a `Column`, of a component returned; or a `Reason`,
with the link or the watched value it is about."""
