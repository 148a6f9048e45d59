"""What the stepping of every algorithm works on: flat arrays beside those of the plan.

All of it is numbers, for compiled code; `orchestration.master.kernel.step_control` has the steps.
"""

from typing import NamedTuple

import numpy as np

# Columns of `Coupling.units`: addresses of functions, then of the states saved at each level, the
# group of fmi2SetRealInputDerivatives, and what kind of unit it is.
GET_STATE, SET_STATE, GET_DIRECTION, SAVED = 0, 1, 2, 3
LEVELS = 2  # how deep rollbacks are nested: iteration within step control or event location
SET_RATES = SAVED + LEVELS
RATES_FUNCTION, RATES_REFERENCES, RATES_ORDERS, RATES_COUNT, RATES_VALUES = range(SET_RATES, SET_RATES + 5)
CONTINUOUS, RATIO = SET_RATES + 5, SET_RATES + 6
N_UNIT_COLUMNS = RATIO + 1
ITERATION, STEP = range(LEVELS)  # the levels

# Columns of `Coupling.links`, one row per Real link: places in the buffers, of the rates (-1: held),
# whether the source has stepped when the target's inputs are set, or its value is assumed, the target
# component, and addresses of the target's reference and of the number one.
SOURCE, TARGET, RATE_1, RATE_2, FRESH, ASSUMED, TARGET_UNIT, REFERENCE, ONE = range(9)
N_LINK_COLUMNS = 9

# Places in `Work.integers` and `Work.numbers`
N_INTEGERS, N_NUMBERS = 7, 4
INTERVAL, STEPS_MADE, N_PAST, HAS_JACOBIAN, ITERATIONS, REJECTED, STARTING = range(N_INTEGERS)
TIME, NEXT_STEP, LAST_ERROR, JACOBIAN_STEP = range(N_NUMBERS)
N_PAST_KEPT = 3


class Method(NamedTuple):
    """An algorithm as numbers.

    Attributes
    ----------
    sequential, order
        See `orchestration.master.algorithm.Algorithm`.
    newton, directional, sweeps, max_iterations
        Of the correction; `max_iterations` 0 for none, `sweeps` 0 for as many as converge.
    restarts
        Whether a step without a past is made twice, so that it is as exact as the others.
    controlled, error_order
        Whether steps are controlled, and the order of the estimated error.
    """

    sequential: bool
    order: int
    newton: bool
    directional: bool
    sweeps: int
    max_iterations: int
    restarts: bool
    controlled: bool
    error_order: int


class Coupling(NamedTuple):
    """What does not change during a run.

    Attributes
    ----------
    units
        int64, shape (n_components, `N_UNIT_COLUMNS`).
    links
        int64, shape (n_real_links, `N_LINK_COLUMNS`), in the order of the plan's Real links.
    link_tolerances, watched_tolerances
        Absolute and relative, of the correction by link and of step control by watched value,
        shape (n, 2).
    assumed
        Links whose source value is assumed and corrected, int64, shape (n_assumed,).
    exact
        Discrete links into continuous units, which a correction must satisfy, int64.
    watched, accumulates
        Places of values under step control, int64, and whether their errors add up from step to step
        (1) or come anew from the inputs (0).
    crossings
        Places of values whose change of sign is located, int64.
    limits
        First, smallest and largest step, duration of the run, and how closely events are located, s.
    """

    units: np.ndarray
    links: np.ndarray
    link_tolerances: np.ndarray
    assumed: np.ndarray
    exact: np.ndarray
    watched: np.ndarray
    accumulates: np.ndarray
    watched_tolerances: np.ndarray
    crossings: np.ndarray
    limits: np.ndarray


class Work(NamedTuple):
    """What changes during a run, besides the plan's buffers; a copy belongs to a snapshot.

    Attributes
    ----------
    rates
        Input derivatives, as they are handed over.
    past, past_times
        Real values at the last communication points, the present one first, shape (3, n_reals).
    end
        Assumed values at the end of the step, by link.
    residual, last_residual
        Of the assumed links, source minus assumed value.
    pair_start, pair_residual
        Of Aitken's iteration: assumed values before it, and what it changes unrelaxed.
    states
        Addresses of the states saved at each level, int64, shape (LEVELS, n_components).
    kept_reals, kept_discretes, kept_past, kept_times, kept_integers
        What there was at the last save of level `STEP`.
    whole, trial
        Real values after a step made as a whole, and before inputs are displaced.
    jacobian
        Of the sources of assumed links to their assumed values, minus one; factors after use.
    pivots, scratch
        Of its factors; shape (n_assumed,).
    integers, numbers
        See the places above.
    """

    rates: np.ndarray
    past: np.ndarray
    past_times: np.ndarray
    end: np.ndarray
    residual: np.ndarray
    last_residual: np.ndarray
    pair_start: np.ndarray
    pair_residual: np.ndarray
    states: np.ndarray
    kept_reals: np.ndarray
    kept_discretes: np.ndarray
    kept_past: np.ndarray
    kept_times: np.ndarray
    kept_integers: np.ndarray
    whole: np.ndarray
    trial: np.ndarray
    jacobian: np.ndarray
    pivots: np.ndarray
    scratch: np.ndarray
    integers: np.ndarray
    numbers: np.ndarray
