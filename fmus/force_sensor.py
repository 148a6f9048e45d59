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

from adaptimp_fmu import Formula, Formulas, SampledModel, Type
from fmus import icons
from fmus.drawings.characteristics import sensor
from fmus.drawings.loop import SENSOR
from fmus.elements import of_task
from fmus.mechanics.task import Task
from fmus.metric import declare_metric
from fmus.project import group_signals, publish
from fmus.sensor_failure import declare_failure
from fmus.sensor_reading import declare_noise, declare_reading

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

    Examples
    --------
    >>> from fmus.force_sensor import force_sensor
    >>> force_sensor("FailingForceSensor", failing=True).description
    'Wrist force sensor with bounded noise and a failure'
    """
    task = task or Task()
    what = "force and moment sensor" if task.angles else "force sensor"
    model = SampledModel(name, f"Wrist {what} with bounded noise{' and a failure' if failing else ''}")
    failure_modules = ["fmus.sensor_failure"] if failing else []
    publish(model, icons.sensor(), SENSOR, [sensor()], __name__, *failure_modules, "fmus")
    units = task.each("N", "N.m")
    texts = of_task("Force of the tip on the wall", task, "Moment of the tip on the wall")
    F_ext = model.input("F_ext", [0.0] * task.size, unit=units, description=texts)
    noise = declare_noise(model)
    bias = model.parameter("bias", [0.0] * task.size, unit=units, description=of_task("Constant error", task))
    reading = declare_reading(model, task)
    force = F_ext + bias + noise.error(model, declare_metric(model, task), F_ext)
    failure = declare_failure(model, task) if failing else None
    force = force if failure is None else failure.disturbed(force)
    F_hat = reading.of(force)
    F_hat = F_hat if failure is None else failure.reading(model, F_hat, F_ext)
    texts = of_task("Measured force", task, "Measured moment")
    model.output("F_hat", F_hat, unit=units, description=texts)
    if failure is not None:
        model.output("failed", failure.active, type=Type.BOOLEAN, description="Whether the sensor fails")
    group_signals(model)
    return model
