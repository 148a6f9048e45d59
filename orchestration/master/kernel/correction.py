"""Corrects the assumed inputs of a step by iteration: by Aitken's relaxation, or Newton's method on the interface.

With u the assumed values and y(u) what their sources show at the end of the step, the residual is
r(u) = y(u) - u. Aitken (B. Irons, R. Tuck, 1969): u <- u + w r with

    w <- -w r_old . (r - r_old) / |r - r_old|^2

in units of the tolerances. Newton: (I - dy/du) d = r, u <- u + d; the Jacobian dy/du stays as long
as it serves.
"""

import numpy as np

from orchestration.fmi.codes import WORST_ACCEPTED
from orchestration.fmi.native_calls import call_direction, call_do_step
from orchestration.master.kernel.codes import Column, Failure, Group, Level, Reason, Row, Scope, Turn
from orchestration.master.kernel.compiled import compiled_for_callers, compiled_in_place
from orchestration.master.kernel.coupling import Coupling
from orchestration.master.kernel.exchange import FINE, bring_back, polynomial, store, sweep, turn
from orchestration.master.kernel.linear_solve import factorize, solve

SLOW = 0.2  # an iteration that leaves more of the residual asks for a new Jacobian


@compiled_in_place
def corrected_step(c: Coupling, step: tuple[float, float]) -> Failure:
    """Make a step, and repeat it with corrected inputs until the assumed values equal the resulting ones.

    If there is no past to extrapolate from, the step is made with held inputs, then again with inputs that move to
    the resulting values.
    """
    method, state = c.method, c.state
    starting = method.restarts == 1 and state.n_past == 1
    correcting = method.max_iterations > 0
    state.starting = starting
    failure = FINE
    if method.give != 0:
        call_do_step(method.give, method.series, step[0], step[1])
    if starting or correcting:
        extrapolate(c, step[1])
        if method.sweeps != 1:
            failure = turn(c, Level.ITERATION, Scope.AGAIN, Turn.SAVE)
    sweeps, factor = 0, 1.0
    while failure[2] <= WORST_ACCEPTED:
        failure = sweep(c, step, Scope.ALL if sweeps == 0 else Scope.AGAIN)
        sweeps += 1
        if failure[2] > WORST_ACCEPTED or not (correcting or (starting and sweeps == 1)):
            break
        if starting:
            for j in c.assumed:
                c.links[j].end = c.reals[c.links[j].source]
        else:
            state.iterations += 1
            worst, size = worst_residual(c)
            if sweeps == method.sweeps or (method.sweeps == 0 and size <= 1.0):
                break
            if method.sweeps == 0 and sweeps >= method.max_iterations:
                return worst, 0, Reason.NOT_CONVERGED.value
            if method.newton == 1:
                failure = newton(c, step, sweeps)
            else:
                factor = relax(c, factor, sweeps)
        if failure[2] <= WORST_ACCEPTED:
            failure = turn(c, Level.ITERATION, Scope.AGAIN, Turn.RESTORE)
    state.starting = 0
    return failure


@compiled_for_callers
def extrapolate(c: Coupling, h: float) -> None:
    """Assume the values of the polynomials through the past for the end of a step."""
    for j in c.assumed:
        link = c.links[j]
        if link.rate < 0 or c.method.order == 0:
            link.end = c.history[Row.LAST, link.source]
        else:
            value, rate, curvature = polynomial(c, link.source)
            link.end = value + h * (rate + 0.5 * h * curvature)


@compiled_for_callers
def worst_residual(c: Coupling) -> tuple[int, float]:
    """Compute the residual; returns the worst link and the residual there over its tolerance.

    Discrete inputs must equal their sources; one that does not counts as infinite, with the number of
    Real links added to its own.
    """
    worst, size = -1, 0.0
    for j in c.assumed:
        link = c.links[j]
        value = c.reals[link.source]
        link.last_residual = link.residual
        link.residual = value - link.end
        over = abs(link.residual) / (link.absolute + link.relative * abs(value))
        if not over <= size:  # NaN is the worst
            worst, size = j, over
    for j in c.exact:
        if c.discretes[c.discrete_links[j, 0]] != c.discretes[c.discrete_links[j, 1]]:
            return c.links.shape[0] + j, np.inf
    return worst, size


@compiled_for_callers
def relax(c: Coupling, factor: float, sweeps: int) -> float:
    """Correct the assumed values by Aitken's relaxation; returns the factor used.

    In parallel sweeps a change comes back after two sweeps. There, two sweeps are one of Aitken's iterations, and the
    first of the two takes the resulting values unchanged.
    """
    period = 1 if c.method.sequential == 1 else 2
    phase = (sweeps - 1) % period
    product, square = 0.0, 0.0
    for j in c.assumed:
        link = c.links[j]
        if phase == 0:
            link.pair_start = link.end
        if phase < period - 1:
            link.end += link.residual
        else:
            weight = 1.0 / link.absolute
            before = weight * link.pair_residual
            change = weight * (link.end + link.residual - link.pair_start) - before
            product += before * change
            square += change * change
    if phase < period - 1:
        return factor
    if sweeps > period and square > 0.0 and product != 0.0:
        factor = -factor * product / square
    for j in c.assumed:
        link = c.links[j]
        link.pair_residual = link.end + link.residual - link.pair_start
        link.end = link.pair_start + factor * link.pair_residual
    return factor


@compiled_in_place
def newton(c: Coupling, step: tuple[float, float], sweeps: int) -> Failure:
    """Correct the assumed values by Newton's method; the components are left anywhere within the step."""
    jacobian, n = c.jacobian, c.assumed.shape[0]
    if needs_jacobian(c, step[1], sweeps):
        if c.method.directional == 1:
            failure = directional_jacobian(c)
        else:
            failure = difference_jacobian(c, step)
        if failure[2] > WORST_ACCEPTED:
            return failure
        for row in range(n):
            for column in range(n):
                jacobian[row, column] = (1.0 if row == column else 0.0) - jacobian[row, column]
        if not factorize(jacobian, c.pivots):
            c.state.has_jacobian = 0
            return c.assumed[0], 0, Reason.SINGULAR.value
        c.state.has_jacobian = 1
        c.state.jacobian_step = step[1]
    for row in range(n):
        jacobian[row, n] = c.links[c.assumed[row]].residual
    solve(jacobian, c.pivots)
    for row in range(n):
        c.links[c.assumed[row]].end += jacobian[row, n]
    return FINE


@compiled_for_callers
def difference_jacobian(c: Coupling, step: tuple[float, float]) -> Failure:
    """Compute dy/du by repeating the step with one assumed value after the other displaced.

    In a parallel exchange a displaced value moves one component only.
    """
    failure = FINE
    store(c, Row.TRIAL)
    for column in range(c.assumed.shape[0]):
        link = c.links[c.assumed[column]]
        value, scope = link.end, Scope.AGAIN if c.method.sequential == 1 else Scope.ONE
        c.state.moved = link.component
        link.end = value + 1e-6 * abs(value) + 1e3 * link.absolute
        bring_back(c, Row.TRIAL)
        failure = turn(c, Level.ITERATION, scope, Turn.RESTORE)
        if failure[2] <= WORST_ACCEPTED:
            failure = sweep(c, step, scope)
        if failure[2] > WORST_ACCEPTED:
            return failure
        displacement = link.end - value
        link.end = value
        for row in range(c.assumed.shape[0]):
            source = c.links[c.assumed[row]].source
            c.jacobian[row, column] = (c.reals[source] - c.history[Row.TRIAL, source]) / displacement
    bring_back(c, Row.TRIAL)
    return failure


@compiled_for_callers
def directional_jacobian(c: Coupling) -> Failure:
    """Compute dy/du from the components' directional derivatives: direct feedthrough at the end of the step.

    A component writes the differentials of its outputs where its outputs belong.
    """
    store(c, Row.TRIAL)
    for column in range(c.assumed.shape[0]):
        link = c.links[c.assumed[column]]
        i = link.component
        for k in range(c.reals.shape[0]):
            c.reals[k] = 0.0
        status = 0
        if c.table[i, Column.REAL_OUTPUTS] > 0:
            status = call_direction(
                c.table[i, Column.GET_DIRECTION],
                c.table[i, Column.INSTANCE],
                c.table[i, Column.GET_REAL + Group.REFERENCES],
                c.table[i, Column.REAL_OUTPUTS],
                link.reference,
                c.method.one,
                c.table[i, Column.GET_REAL + Group.VALUES],
            )
        for row in range(c.assumed.shape[0]):
            c.jacobian[row, column] = c.reals[c.links[c.assumed[row]].source]
        bring_back(c, Row.TRIAL)
        if status > WORST_ACCEPTED:
            return i, Column.GET_DIRECTION.value, status
    return FINE


@compiled_for_callers
def needs_jacobian(c: Coupling, h: float, sweeps: int) -> bool:
    """Whether a new Jacobian is needed: none exists for this step size, or the present one converges too slowly."""
    if c.state.has_jacobian == 0 or c.state.jacobian_step != h:
        return True
    if sweeps < 2:
        return False
    now, before = 0.0, 0.0
    for j in c.assumed:
        link = c.links[j]
        weight = 1.0 / link.absolute
        now = max(now, abs(weight * link.residual))
        before = max(before, abs(weight * link.last_residual))
    return not now <= SLOW * before
