"""How a sensor of forces reads: its bounded noise, its range and its resolution, for a force or for a wrench.

The equations are those of `fmus.force_sensor`.
"""

import math
from dataclasses import dataclass
from functools import reduce

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, SampledModel, Type
from fmus.mechanics.task import Metric, Task

OFF = 1e9  # N, a range that limits nothing
DIGITS = 2.0**26
ROUNDING = 1e-9  # relative, by which a multiple of the sampling period may be off


@dataclass(frozen=True)
class Noise:
    """Parameters of the noise of a sensor, each of shape (1,).

    Attributes
    ----------
    std, bound
        Standard deviation of a component before truncation, and largest norm, N.
    gated
        Whether there is no noise while the force is exactly zero.
    ticks
        Number of ticks for which a draw is held.
    """

    std: ca.SX
    bound: ca.SX
    gated: ca.SX
    ticks: ca.SX

    def error(self, model: SampledModel, metric: Metric, force: ca.SX) -> ca.SX:
        """Declare the draws; returns the error of a reading, N and N.m, shape (m,).

        Parameters
        ----------
        metric
            Norm of a force.
        force
            True force, shape (m,), which opens the gate.
        """
        drawn = model.random(
            lambda u: _drawn(u, self.std, self.bound, metric), active=self.std, seed="seed", ticks=self.ticks
        )
        free = ca.logic_and(self.gated, reduce(ca.logic_and, (component == 0 for component in ca.vertsplit(force))))
        return ca.if_else(free, 0, drawn)


@dataclass(frozen=True)
class Reading:
    """Resolution and range of a sensor, N and N.m, each of shape (1,), or (m,) where there are moments."""

    resolution: ca.SX
    span: ca.SX

    def of(self, force: ca.SX) -> ca.SX:
        """What is read of a force, N and N.m, of its shape (m,)."""
        within = ca.fmin(ca.fmax(force, -self.span), self.span)
        steps = ca.floor(within / self.resolution + 0.5)
        return ca.if_else(self.resolution > 0, steps * self.resolution, within)


def declare_noise(model: SampledModel) -> Noise:
    """Declare the parameters of the noise, which is off by default."""
    std = model.parameter(
        "noise_std",
        0.0,
        unit="N",
        limits=NOT_NEGATIVE,
        tunable=True,
        description="Standard deviation of each component of the noise before truncation; 0 = no noise",
    )
    bound = model.parameter(
        "noise_bound",
        0.0,
        unit="N",
        limits=NOT_NEGATIVE,
        tunable=True,
        description="Largest Euclidean norm of the noise",
    )
    gated = model.parameter(
        "contact_gated",
        True,
        type=Type.BOOLEAN,
        description="Whether the noise is zero while the force is exactly zero",
    )
    model.parameter(
        "seed",
        0,
        type=Type.INTEGER,
        limits=NOT_NEGATIVE,
        description="Key of the noise; the same seed gives the same noise at the same tick",
    )
    model.require(
        ca.if_else(std > 0, bound, 1),
        "noise_bound must be positive where noise_std is",
    )
    return Noise(std, bound, gated, _ticks_per_draw(model))


def declare_reading(model: SampledModel, task: Task) -> Reading:
    """Declare resolution and range, which are off by default."""
    resolution = model.parameter(
        "resolution",
        0.0,
        unit="N",
        limits=NOT_NEGATIVE,
        description="Step to which each component is rounded; 0 = not rounded",
    )
    span = model.parameter(
        "range",
        OFF,
        unit="N",
        limits=POSITIVE,
        description="Largest absolute component that is measured; 1e9 = no limit",
    )
    if not task.angles:
        return Reading(resolution, span)
    moment_resolution = model.parameter(
        "moment_resolution",
        0.0,
        unit="N.m",
        limits=NOT_NEGATIVE,
        description="Step to which each moment is rounded; 0 = not rounded",
    )
    moment_span = model.parameter(
        "moment_range",
        OFF,
        unit="N.m",
        limits=POSITIVE,
        description="Largest absolute moment that is measured; 1e9 = no limit",
    )
    parts = ((resolution, moment_resolution), (span, moment_span))
    each = [
        ca.vertcat(force * ca.SX.ones(task.positions, 1), moment * ca.SX.ones(task.angles, 1))
        for force, moment in parts
    ]
    return Reading(each[0], each[1])


def _drawn(u: ca.SX, std: ca.SX, bound: ca.SX, metric: Metric) -> ca.SX:
    """Error of a reading, N and N.m, shape (m,), from four uniform numbers."""
    size = metric.task.size
    pairs = (size + 1) // 2
    if pairs == 1:
        return truncated_normal(u[0], u[1], std, bound)[:size]
    # Digits beyond the first 26 binary ones are uniform, too, and serve a third and a fourth pair.
    more = u * DIGITS - ca.floor(u * DIGITS)
    uniform = ca.vertcat(u, more)
    drawn = [truncated_normal(uniform[2 * k], uniform[2 * k + 1], std, bound / math.sqrt(pairs)) for k in range(pairs)]
    return metric.of_newtons(ca.vertcat(*drawn)[:size])


def _ticks_per_draw(model: SampledModel) -> ca.SX:
    """Declare `noise_period`, and return the number of ticks for which an error is held."""
    period = model.parameter(
        "noise_period",
        0.0,
        unit="s",
        limits=NOT_NEGATIVE,
        description="Time for which a draw of the noise is held: a whole multiple of sample_time, or less for one tick",
    )
    ratio = period / model.period
    ticks = ca.fmax(ca.floor(ratio + 0.5), 1)
    model.require(
        ca.if_else(period > model.period, ROUNDING * ticks - ca.fabs(ratio - ticks), 1),
        "noise_period must be a whole multiple of sample_time, or shorter than one",
    )
    return ticks


def truncated_normal(u0: ca.SX, u1: ca.SX, std: ca.SX, bound: ca.SX) -> ca.SX:
    """Return a normally distributed vector of the plane, of norm at most `bound`, from two uniform numbers."""
    # 1 - exp(x) and ln(1 - x) would lose all digits of a small x, where the bound is far below std.
    inside = ca.expm1(-((bound / std) ** 2) / 2)
    # Rounding may carry r beyond the bound (u0 next to 1, or a bound far below std).
    r = ca.fmin(std * ca.sqrt(-2 * ca.log1p(u0 * inside)), bound)
    return r * ca.vertcat(ca.cos(2 * math.pi * u1), ca.sin(2 * math.pi * u1))
