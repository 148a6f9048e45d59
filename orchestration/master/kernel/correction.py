"""How assumed inputs are corrected: Aitken's relaxation, or Newton's method on the interface.

With u the assumed values and y(u) what their sources show at the end of the step, the residual is
r(u) = y(u) - u. Aitken (B. Irons, R. Tuck, 1969): u <- u + w r with

    w <- -w r_old . (r - r_old) / |r - r_old|^2

in units of the tolerances. Newton: (I - dy/du) d = r, u <- u + d; the Jacobian dy/du stays as long
as it serves.
"""

import numpy as np
from numba import njit

from orchestration.fmi.codes import WORST_ACCEPTED
from orchestration.fmi.native_calls import call_direction
from orchestration.master.kernel.coupling import (
    GET_DIRECTION,
    HAS_JACOBIAN,
    ITERATION,
    ITERATIONS,
    JACOBIAN_STEP,
    N_PAST,
    ONE,
    RATE_1,
    REFERENCE,
    SOURCE,
    STARTING,
    TARGET_UNIT,
    Coupling,
    Method,
    Work,
)
from orchestration.master.kernel.exchange import AGAIN, ALL, DIRECTION, FINE, Failure, copy, polynomial, sweep, turn
from orchestration.master.kernel.flat_system import COMPONENT, COUNT, GET_REAL, REFERENCES, VALUES, Plan

NOT_CONVERGED, SINGULAR = 100, 101
SLOW = 0.2  # an iteration that leaves more of the residual asks for a new Jacobian
_options = {"cache": True, "nogil": True, "error_model": "numpy"}


@njit(inline="always", **_options)
def corrected_step(plan: Plan, coupling: Coupling, work: Work, method: Method, step: tuple[float, float]) -> Failure:
    """Sweep, and go on if inputs are corrected until the assumed values are those that come out.

    A step without a past to extrapolate is made with held inputs, then again towards what came out.
    """
    starting = method.restarts and work.integers[N_PAST] == 1
    correcting = method.max_iterations > 0
    work.integers[STARTING] = starting
    failure = FINE
    if starting or correcting:
        for j in coupling.assumed:
            work.end[j] = extrapolated(coupling.links[j], work, method.order, step[1])
        if method.sweeps != 1:
            failure = turn(plan, coupling, work, ITERATION, AGAIN, False)
    sweeps, factor = 0, 1.0
    while failure[2] <= WORST_ACCEPTED:
        failure = sweep(plan, coupling, work, method, step, ALL if sweeps == 0 else AGAIN)
        sweeps += 1
        if failure[2] > WORST_ACCEPTED or not (correcting or (starting and sweeps == 1)):
            break
        if starting:
            for j in coupling.assumed:
                work.end[j] = plan.reals[coupling.links[j, SOURCE]]
        else:
            work.integers[ITERATIONS] += 1
            worst, size = worst_residual(plan, coupling, work)
            if sweeps == method.sweeps or (method.sweeps == 0 and size <= 1.0):
                break
            if method.sweeps == 0 and sweeps >= method.max_iterations:
                return worst, 0, NOT_CONVERGED
            if method.newton:
                failure = newton(plan, coupling, work, method, step, sweeps)
            else:
                factor = relax(coupling, work, method, factor, sweeps)
        if failure[2] <= WORST_ACCEPTED:
            failure = turn(plan, coupling, work, ITERATION, AGAIN, True)
    work.integers[STARTING] = 0
    return failure


@njit(**_options)
def extrapolated(link: np.ndarray, work: Work, order: int, h: float) -> float:
    """The value to assume first at the end of a step: the polynomial through the past."""
    if link[RATE_1] < 0 or order == 0:
        return work.past[0, link[SOURCE]]
    value, rate, curvature = polynomial(link[SOURCE], work, order, h, False, 0.0)
    return value + h * (rate + 0.5 * h * curvature)


@njit(**_options)
def worst_residual(plan: Plan, coupling: Coupling, work: Work) -> tuple[int, float]:
    """Compute the residual; returns the worst link and the residual there over its tolerance.

    Discrete inputs must equal their sources; one that does not counts as infinite, with the number of
    Real links added to its own.
    """
    copy(work.residual, work.last_residual)
    worst, size = -1, 0.0
    for place, j in enumerate(coupling.assumed):
        value = plan.reals[coupling.links[j, SOURCE]]
        work.residual[place] = value - work.end[j]
        accepted = coupling.link_tolerances[j, 0] + coupling.link_tolerances[j, 1] * abs(value)
        over = abs(work.residual[place]) / accepted
        if not over <= size:  # NaN is the worst
            worst, size = j, over
    for j in coupling.exact:
        if plan.discretes[plan.discrete_links[j, 0]] != plan.discretes[plan.discrete_links[j, 1]]:
            return coupling.links.shape[0] + j, np.inf
    return worst, size


@njit(**_options)
def relax(coupling: Coupling, work: Work, method: Method, factor: float, sweeps: int) -> float:
    """Correct the assumed values by Aitken's relaxation; returns the factor used.

    In a parallel sweep a change comes back after two: there, two sweeps are one of Aitken's
    iterations, and the first of them takes the values as they come out.
    """
    period = 1 if method.sequential else 2
    phase = (sweeps - 1) % period
    if phase == 0:
        for place, j in enumerate(coupling.assumed):
            work.pair_start[place] = work.end[j]
    if phase < period - 1:
        for place, j in enumerate(coupling.assumed):
            work.end[j] += work.residual[place]
        return factor
    product, square = 0.0, 0.0
    for place, j in enumerate(coupling.assumed):
        weight = 1.0 / coupling.link_tolerances[j, 0]
        before = weight * work.pair_residual[place]
        change = weight * (work.end[j] + work.residual[place] - work.pair_start[place]) - before
        product += before * change
        square += change * change
    if sweeps > period and square > 0.0 and product != 0.0:
        factor = -factor * product / square
    for place, j in enumerate(coupling.assumed):
        work.pair_residual[place] = work.end[j] + work.residual[place] - work.pair_start[place]
        work.end[j] = work.pair_start[place] + factor * work.pair_residual[place]
    return factor


@njit(inline="always", **_options)
def newton(
    plan: Plan, coupling: Coupling, work: Work, method: Method, step: tuple[float, float], sweeps: int
) -> Failure:
    """Correct the assumed values by Newton's method; the units are left anywhere within the step."""
    if needs_jacobian(coupling, work, step[1], sweeps):
        if method.directional:
            failure = directional_jacobian(plan, coupling, work)
        else:
            failure = difference_jacobian(plan, coupling, work, method, step)
        if failure[2] > WORST_ACCEPTED:
            return failure
        for row in range(coupling.assumed.shape[0]):
            for column in range(coupling.assumed.shape[0]):
                work.jacobian[row, column] = (1.0 if row == column else 0.0) - work.jacobian[row, column]
        if not factorize(work.jacobian, work.pivots):
            work.integers[HAS_JACOBIAN] = 0
            return coupling.assumed[0], 0, SINGULAR
        work.integers[HAS_JACOBIAN] = 1
        work.numbers[JACOBIAN_STEP] = step[1]
    copy(work.residual, work.scratch)
    solve(work.jacobian, work.pivots, work.scratch)
    for place, j in enumerate(coupling.assumed):
        work.end[j] += work.scratch[place]
    return FINE


@njit(**_options)
def difference_jacobian(
    plan: Plan, coupling: Coupling, work: Work, method: Method, step: tuple[float, float]
) -> Failure:
    """dy/du by repeating the step with one assumed value after the other displaced.

    In a parallel exchange that moves one unit only.
    """
    failure = FINE
    copy(plan.reals, work.trial)
    for column, j in enumerate(coupling.assumed):
        value, only = work.end[j], AGAIN if method.sequential else coupling.links[j, TARGET_UNIT]
        work.end[j] = value + 1e-6 * abs(value) + 1e3 * coupling.link_tolerances[j, 0]
        copy(work.trial, plan.reals)
        failure = turn(plan, coupling, work, ITERATION, only, True)
        if failure[2] <= WORST_ACCEPTED:
            failure = sweep(plan, coupling, work, method, step, only)
        if failure[2] > WORST_ACCEPTED:
            return failure
        displacement = work.end[j] - value
        work.end[j] = value
        for row, i in enumerate(coupling.assumed):
            source = coupling.links[i, SOURCE]
            work.jacobian[row, column] = (plan.reals[source] - work.trial[source]) / displacement
    copy(work.trial, plan.reals)
    return failure


@njit(**_options)
def directional_jacobian(plan: Plan, coupling: Coupling, work: Work) -> Failure:
    """dy/du as the units declare it: direct feedthrough at the end of the step.

    A unit writes the differentials of its outputs where its outputs belong.
    """
    copy(plan.reals, work.trial)
    for column, j in enumerate(coupling.assumed):
        i = coupling.links[j, TARGET_UNIT]
        for k in range(plan.reals.shape[0]):
            plan.reals[k] = 0.0
        status = 0
        if plan.table[i, GET_REAL + COUNT] > 0:
            status = call_direction(
                coupling.units[i, GET_DIRECTION],
                plan.table[i, COMPONENT],
                plan.table[i, GET_REAL + REFERENCES],
                plan.table[i, GET_REAL + COUNT],
                coupling.links[j, REFERENCE],
                coupling.links[j, ONE],
                plan.table[i, GET_REAL + VALUES],
            )
        for row, k in enumerate(coupling.assumed):
            work.jacobian[row, column] = plan.reals[coupling.links[k, SOURCE]]
        copy(work.trial, plan.reals)
        if status > WORST_ACCEPTED:
            return i, DIRECTION, status
    return FINE


@njit(**_options)
def needs_jacobian(coupling: Coupling, work: Work, h: float, sweeps: int) -> bool:
    """Whether there is none for this step size, or the one there is does not serve."""
    if work.integers[HAS_JACOBIAN] == 0 or work.numbers[JACOBIAN_STEP] != h:
        return True
    if sweeps < 2:
        return False
    now, before = 0.0, 0.0
    for place, j in enumerate(coupling.assumed):
        weight = 1.0 / coupling.link_tolerances[j, 0]
        now = max(now, abs(weight * work.residual[place]))
        before = max(before, abs(weight * work.last_residual[place]))
    return not now <= SLOW * before


@njit(**_options)
def factorize(a: np.ndarray, pivots: np.ndarray) -> bool:
    """LU factors of a square matrix in place, with partial pivoting; False if it is singular."""
    n = a.shape[0]
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[p, k]):
                p = i
        pivots[k] = p
        if not abs(a[p, k]) > 0.0:
            return False
        for j in range(n):
            a[k, j], a[p, j] = a[p, j], a[k, j]
        for i in range(k + 1, n):
            a[i, k] /= a[k, k]
            for j in range(k + 1, n):
                a[i, j] -= a[i, k] * a[k, j]
    return True


@njit(**_options)
def solve(a: np.ndarray, pivots: np.ndarray, b: np.ndarray) -> None:
    """Solve with the factors of `factorize`, in place of the right-hand side."""
    n = a.shape[0]
    for k in range(n):
        b[k], b[pivots[k]] = b[pivots[k]], b[k]
    for i in range(n):
        for j in range(i):
            b[i] -= a[i, j] * b[j]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            b[i] -= a[i, j] * b[j]
        b[i] /= a[i, i]
