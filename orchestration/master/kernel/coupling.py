"""The flat arrays and records that the loop of all algorithms works on, together with the flat form of the system."""

from typing import NamedTuple

import numpy as np

from orchestration.master.kernel.records import Link, Method, Records, State, Watched


class Coupling(NamedTuple):
    """All data that a step of a co-simulation algorithm reads and writes.

    The arrays are few, because compiled code hands each of them over as seven numbers at every call.

    Attributes
    ----------
    table, discrete_links, reals, discretes
        Those of the plan, see `orchestration.master.kernel.flat_system.Plan`.
    links
        The plan's Real links, in their order, records `orchestration.master.kernel.codes.LINK`.
    history
        Real values and, in the last column, the time, float64, shape (N_ROWS, n_reals + 1); see
        `orchestration.master.kernel.codes.Row`.
    rates
        Input derivatives, as they are handed over, float64.
    states
        Addresses of the saved states, int64, shape (N_LEVELS, n_components).
    assumed
        Links whose value is assumed and corrected, int64, shape (n_assumed,).
    exact
        Discrete links into continuous components, which a correction must satisfy, int64.
    watched
        Values under step control, records `orchestration.master.kernel.codes.WATCHED`.
    crossings
        Places of values whose change of sign is located, int64.
    jacobian
        Of the sources of assumed links to their assumed values, float64, shape (n_assumed, n_assumed + 1);
        after use its factors, and in the last column the correction.
    pivots
        Of the factors, int64, shape (n_assumed,).
    method, state
        A record `orchestration.master.kernel.codes.METHOD`, and a record
        `orchestration.master.kernel.codes.STATE`.
    """

    table: np.ndarray
    discrete_links: np.ndarray
    reals: np.ndarray
    discretes: np.ndarray
    links: Records[Link]
    history: np.ndarray
    rates: np.ndarray
    states: np.ndarray
    assumed: np.ndarray
    exact: np.ndarray
    watched: Records[Watched]
    crossings: np.ndarray
    jacobian: np.ndarray
    pivots: np.ndarray
    method: Method
    state: State
