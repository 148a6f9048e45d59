"""ForceSensor of an arm in space: measures the wrench at the tip, in a frame of its own, as a wrist sensor does.

The inputs are F_ext, the force and the moment about the tip of the arm on what is beyond the sensor, in the axes of the
base, and x, whose angles tell the orientation R of the tip. The output F_hat is the same wrench as measured. Connected
to the plant's F_ext the sensor feels the contact alone; connected to F_wrist it feels the payload, too.

The sensor stands at `sensor_position`, r, in the frame of the tip, and is turned there by `sensor_rpy`, the rotation S.
With Q = R S, what it feels of a wrench (f, m), in its own axes and about its own origin, is

    T(f, m) = (Q' f,   Q' (m - (R r) x f))

At each tick the following happens to T F_ext, in this order:

1. Bias and noise are added. The noise has the bound `noise_bound` in the norm of (f, m / L), in the axes of the sensor.
   The six errors of (f, m / L) are drawn in three pairs. A pair has the density of two independent normal components of
   standard deviation `noise_std`, cut where its norm exceeds b = noise_bound / sqrt(3). With u0, u1 uniform in (0, 1):
   r = noise_std sqrt(-2 ln(1 - u0 (1 - exp(-(b / noise_std)^2 / 2)))), error = r (cos 2 pi u1, sin 2 pi u1).
   The draws follow from `seed` and tick, and each is held for `noise_period`. With `contact_gated` there is no noise
   while F_ext is exactly 0, which the plant's F_wrist never is.
2. Range and resolution limit and round each component: what the hardware can read.
3. The weight of the tool, `tool_mass` at `tool_center` in the frame of the tip, is taken off, for the orientation that
   the angles tell. A tool at rest is not felt then. While the arm accelerates, the tool's inertia is felt.
4. A filter of first order follows, with the time constant `filter_time` T. It begins with the first reading, without
   noise: y[k] = y[k-1] + (1 - exp(-Ts / T)) (u[k] - y[k-1]).
5. The zero is taken off. At each tick while the parameter `zero` is true, the present value becomes the zero, so that
   F_hat is 0 to rounding; afterwards the last one stays. `zero` is tunable: a host sets it between steps. A zero holds
   the bias, and also the contact and the noise of its moment.

T turns the result back to the tip and the axes of the base. All this is off by default, and then F_hat is F_ext, bit
for bit: only what steps 1 to 5 change is turned back, and added to F_ext.

A moment at the tip has the error of the moment at the sensor, and the one that r makes of a force's error. So the norm
of the error at the tip, with the same L, exceeds that in the axes of the sensor by a factor of at most

    (s + sqrt(s^2 + 4)) / 2 <= 1 + s,   s = |r| / L

The noise bound of a controller (delta) is noise_bound times this factor. The filter keeps this bound of the noise, but
its lag is an error of its own. A zero that was taken in noise has an error of at most the same bound.
"""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, Formula, Formulas, SampledModel, Type
from fmus import icons
from fmus.drawings.loop import SENSOR
from fmus.drawings.spatial_sensor import wrist_sensor
from fmus.elements import ANGLE, SPACE, along, of_task, of_tip, of_wrench
from fmus.mechanics.orientation import rotation
from fmus.mechanics.spatial_model import TASK
from fmus.metric import declare_metric
from fmus.project import TIP, group_signals, publish, publish_in_space
from fmus.robots.spatial_robot import GRAVITY, SpatialRobot, declare_reference
from fmus.sensor_reading import declare_noise, declare_reading

UNITS = TASK.each("N", "N.m")
SENSOR_AXES = tuple(f"axis {i + 1} of the sensor" for i in range(SPACE))
FORMULAS = Formulas(
    "Measurement at tick k",
    [
        Formula(
            r"T\,(f, m) = \left( Q^{T} f, \; Q^{T} (m - (R\,r) \times f) \right), \quad Q = R\,S",
            "What the sensor feels of a wrench at the tip: R is the orientation of the tip, r the sensor_position, and"
            " S follows from sensor_rpy.",
        ),
        Formula(
            r"u = \mathrm{read}(T\,F_{\text{ext}} + b + \varepsilon) - T\,W(R), \quad \|\varepsilon\| \le \delta",
            "Bias b and noise are read within range and resolution; then the weight W of the tool is taken off.",
            "21",
        ),
        Formula(
            r"(\varepsilon_f, \; \varepsilon_m / L) = (r_1 e_1, \; r_2 e_2, \; r_3 e_3), \quad"
            r" r_k = \sigma \sqrt{-2 \ln\left( 1 - u_k (1 - e^{-\delta_k^2 / 2\sigma^2}) \right)}, \quad"
            r" \delta_k = \delta / \sqrt{3}",
            "The errors of forces, and those of moments divided by L, are drawn in three pairs: each has a random"
            " direction e in its plane and the density of a normal distribution with noise_std, cut at its share of"
            " delta, the noise_bound. The numbers follow from seed and tick.",
        ),
        Formula(
            r"y_k = y_{k-1} + (1 - e^{-T_s / T_f})(u_k - y_{k-1}), \quad \hat{F} = T^{-1} (y_k - z)",
            "The filter follows, and the zero z, which is y_k while the parameter zero is true.",
        ),
    ],
)


@dataclass(frozen=True)
class SensorFrame:
    """Where a sensor stands, for wrenches at the tip in the axes of the base.

    Attributes
    ----------
    Q
        Rotation matrix of the sensor in the base, shape (3, 3).
    lever
        Vector from the tip to the sensor, m, shape (3,), in the axes of the base.
    """

    Q: ca.SX
    lever: ca.SX

    def felt(self, wrench: ca.SX) -> ca.SX:
        """A wrench at the tip, N and N.m, shape (6,), in the axes of the sensor and about its origin."""
        force, moment = wrench[:SPACE], wrench[SPACE:]
        return ca.vertcat(self.Q.T @ force, self.Q.T @ (moment - ca.cross(self.lever, force)))

    def at_tip(self, wrench: ca.SX) -> ca.SX:
        """The inverse of `felt`, shape (6,)."""
        force = self.Q @ wrench[:SPACE]
        return ca.vertcat(force, self.Q @ wrench[SPACE:] + ca.cross(self.lever, force))


def wrench_sensor(robot: SpatialRobot, name: str = "ForceSensor") -> SampledModel:
    """Declare the model of a force and moment sensor at the wrist of an arm in space, which is ideal by default.

    Examples
    --------
    >>> from fmus.robots.puma560 import PUMA
    >>> from fmus.wrench_sensor import wrench_sensor
    >>> model = wrench_sensor(PUMA, "ForceSensorPuma560")
    >>> [variable.name for variable in model.variables if variable.name.startswith("zero")]
    ['zero']
    """
    model = SampledModel(name, "Wrist force and moment sensor with noise, filter, zero and weight compensation")
    publish(model, icons.sensor(), SENSOR, [wrist_sensor()], __name__, "fmus")
    publish_in_space(model, SENSOR)
    F_ext = model.input(
        "F_ext", [0.0] * TASK.size, unit=UNITS, description=of_wrench("Force of the tip", "Moment of the tip", TASK)
    )
    texts = of_task("Position of the tip", TASK, "Angle of the tip")
    x = model.input("x", robot.start.x_v, unit=TASK.each("m", "rad"), description=texts)
    noise = declare_noise(model)
    texts = [f"Constant error along {axis}" for axis in SENSOR_AXES]
    texts += [f"Constant error of the moment about {axis}" for axis in SENSOR_AXES]
    bias = model.parameter("bias", [0.0] * TASK.size, unit=UNITS, description=texts)
    reading, metric = declare_reading(model, TASK), declare_metric(model, TASK)
    tip = rotation(x[TASK.positions :]) @ rotation(declare_reference(model, robot.path))
    frame = _declare_frame(model, tip)
    weight = _declare_tool(model, tip)

    true = frame.felt(F_ext)

    def compensated(force: ca.SX) -> ca.SX:
        return reading.of(force) - frame.felt(weight)

    filtered = _filtered(model, compensated(true + bias + noise.error(model, metric, F_ext)), compensated(true + bias))
    zero = model.parameter(
        "zero",
        False,
        type=Type.BOOLEAN,
        tunable=True,
        description="Whether the present reading becomes the zero, at each tick while it is true",
    )
    last = model.state("zero_reading", [0.0] * TASK.size)
    present = ca.if_else(zero, filtered, last)
    model.update(last, present)
    F_hat = F_ext + frame.at_tip((filtered - present) - true)
    texts = of_wrench("Measured force", "Measured moment", TASK)
    model.output("F_hat", F_hat, unit=UNITS, description=texts)
    group_signals(model, TIP)
    return model


def _declare_frame(model: SampledModel, tip: ca.SX) -> SensorFrame:
    """Declare where the sensor stands in the frame of the tip, whose orientation in the base is given."""
    place = model.parameter("sensor_position", [0.0] * SPACE, unit="m", description=of_tip("Position of the sensor"))
    turns = model.parameter(
        "sensor_rpy",
        [0.0] * SPACE,
        unit="rad",
        display_unit=ANGLE,
        description=[f"{turn} of the sensor in the frame of the tip" for turn in ("Roll", "Pitch", "Yaw")],
    )
    return SensorFrame(tip @ rotation(turns), tip @ place)


def _declare_tool(model: SampledModel, tip: ca.SX) -> ca.SX:
    """Declare the tool whose weight is compensated; returns the wrench at the tip that holds it, shape (6,)."""
    mass = model.parameter(
        "tool_mass",
        0.0,
        unit="kg",
        limits=NOT_NEGATIVE,
        description="Mass beyond the sensor whose weight is taken off the reading; 0 = off",
    )
    center = model.parameter(
        "tool_center", [0.0] * SPACE, unit="m", description=of_tip("Centre of mass beyond the sensor")
    )
    gravity = model.parameter(
        "gravity",
        GRAVITY,
        unit="m/s2",
        description=along("Acceleration of a falling body", SPACE),
    )
    holding = -mass * gravity
    return ca.vertcat(holding, ca.cross(tip @ center, holding))


def _filtered(model: SampledModel, reading: ca.SX, first: ca.SX) -> ca.SX:
    """Declare the filter of a reading, shape (6,), that begins at `first`; returns what it gives at this tick."""
    time = model.parameter(
        "filter_time",
        0.0,
        unit="s",
        limits=NOT_NEGATIVE,
        description="Time constant of the first-order filter of the reading; 0 = off",
    )
    previous = model.state("filtered", first)
    share = -ca.expm1(-model.period / time)
    filtered = ca.if_else(time > 0, previous + share * (reading - previous), reading)
    model.update(previous, filtered)
    return filtered
