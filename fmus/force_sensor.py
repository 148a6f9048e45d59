"""ForceSensor: measures the force of the tip, with bounded noise of a truncated normal distribution.

The error has the density of two independent normal components of standard deviation `noise_std`,
truncated where its Euclidean norm exceeds `noise_bound`, so |F_hat - F_ext| <= noise_bound (the
delta of eq. (21)):

    r = min(noise_std sqrt(-2 log1p(u0 expm1(-(noise_bound / noise_std)^2 / 2))), noise_bound)
    error = r (cos 2 pi u1, sin 2 pi u1)

with log1p(x) = ln(1 + x) and expm1(x) = exp(x) - 1, which keep their digits where noise_std is far above
noise_bound; the distribution then is the uniform one on the disc of radius noise_bound. The numbers u0, u1 are
uniform in (0, 1), drawn anew at each tick from (seed, tick). With a `noise_period` longer than a tick the error
has a bandwidth: draw k serves the ticks from k noise_period on, and is held until the next draw. Such a
noise_period must be a whole multiple of the sampling period. With `contact_gated` the error is zero while no
force acts. A bias, a range and a resolution follow, all off by default:

    F_hat = resolution floor(clip(F_ext + bias + error, -range, range) / resolution + 1/2)

The variant FailingForceSensor has a failure, too (`fmus.sensor_failure`).

ForceSensorPose measures moments, too. It draws the errors of (F_p, F_phi / L) in pairs, each as above with the bound
noise_bound / sqrt(number of pairs). So the norm of all errors is at most noise_bound, and a moment's error is L times
that of a force. Moments have a range and a resolution of their own.
"""

import math
from functools import reduce

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, Formula, Formulas, SampledModel, Type
from fmus import icons
from fmus.drawings.characteristics import sensor
from fmus.drawings.loop import SENSOR
from fmus.elements import of_task
from fmus.mechanics.task import Metric, Task
from fmus.metric import declare_metric
from fmus.project import group_signals, publish
from fmus.sensor_failure import declare_failure

OFF = 1e9  # N, a range that limits nothing
DIGITS = 2.0**26
ROUNDING = 1e-9  # relative, by which a multiple of the sampling period may be off


FORMULAS = Formulas(
    "Measurement at tick k",
    [
        Formula(
            r"\hat{F} = F_{\text{ext}} + b + \varepsilon, \quad \|\varepsilon\| \le \delta",
            "The reading is the force with a bias b and an error that never exceeds delta, the noise_bound.",
            "21",
        ),
        Formula(
            r"\varepsilon = r\,(\cos 2\pi u_1, \; \sin 2\pi u_1)^{T}, \quad"
            r" r = \sigma \sqrt{-2 \ln\left( 1 - u_0 (1 - e^{-\delta^2 / 2\sigma^2}) \right)}",
            "The error has the density of a normal distribution with noise_std, cut at delta. The numbers u0 and u1"
            " are uniform, and follow from seed and tick.",
        ),
    ],
)


def force_sensor(name: str = "ForceSensor", task: Task | None = None, *, failing: bool = False) -> SampledModel:
    """Declare the model of a wrist force sensor, which is ideal by default and may have a failure.

    Parameters
    ----------
    task
        Whose force it measures, by default the two components of a force in the plane.
    failing
        Whether it may fail.
    """
    task = task or Task()
    what = "force and moment sensor" if task.angles else "force sensor"
    model = SampledModel(name, f"Wrist {what} with bounded noise{' and a failure' if failing else ''}")
    failure_modules = ["fmus.sensor_failure"] if failing else []
    publish(model, icons.sensor(), SENSOR, [sensor()], __name__, *failure_modules, "fmus")
    units = task.each("N", "N.m")
    texts = of_task("Force of the tip on the wall", task, "Moment of the tip on the wall")
    F_ext = model.input("F_ext", [0.0] * task.size, unit=units, description=texts)
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
    ticks = ticks_per_draw(model)
    bias = model.parameter("bias", [0.0] * task.size, unit=units, description=of_task("Constant error", task))
    resolution, span = _declare_reading(model, task)
    metric = declare_metric(model, task)
    noise = model.random(lambda u: _noise(u, std, bound, metric), active=std, seed="seed", ticks=ticks)
    free = ca.logic_and(gated, reduce(ca.logic_and, (component == 0 for component in ca.vertsplit(F_ext))))
    force = F_ext + bias + ca.if_else(free, 0, noise)
    failure = declare_failure(model, task) if failing else None
    force = force if failure is None else failure.disturbed(force)
    within = ca.fmin(ca.fmax(force, -span), span)
    steps = ca.floor(within / resolution + 0.5)
    F_hat = ca.if_else(resolution > 0, steps * resolution, within)
    F_hat = F_hat if failure is None else failure.reading(model, F_hat, F_ext)
    texts = of_task("Measured force", task, "Measured moment")
    model.output("F_hat", F_hat, unit=units, description=texts)
    if failure is not None:
        model.output("failed", failure.active, type=Type.BOOLEAN, description="Whether the sensor fails")
    group_signals(model)
    return model


def _declare_reading(model: SampledModel, task: Task) -> tuple[ca.SX, ca.SX]:
    """Declare resolution and range, each of shape (1,), or (m,) where there are moments."""
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
        return resolution, span
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
    return each[0], each[1]


def _noise(u: ca.SX, std: ca.SX, bound: ca.SX, metric: Metric) -> ca.SX:
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


def ticks_per_draw(model: SampledModel) -> ca.SX:
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
