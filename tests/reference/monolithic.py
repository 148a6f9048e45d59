"""Monolithic reference of the loop trajectory, force sensor, controller, actuator, plant, with NumPy and SciPy only.

At each tick t_k = t0 + k Ts, in this order:

    x_v, dx_v, ddx_v at t_k;  F_hat = F_ext(t_k) + noise;  the controller's torque from the state at t_k;
    tau = clip(tau_cmd, -tau_max, tau_max), held on [t_k, t_k+1);  the plant, with events, to t_k+1.

Row 0 is the initial state with the outputs of tick 0. Row k + 1 holds the sampled values of tick k and the plant at
t_k+1. ``plant.ddq`` is the left limit there (under the torque of tick k). A controller at tick k reads the ddq and the
saturation flags of the rows up to this tick. At tick 0 the controller reads those under its own first torque, which
depends on neither.

Compiled code is cached, so only the first run waits for the compiler.
"""

from dataclasses import dataclass

import numpy as np

from .arm import Arm, Plant, Wall, external_force, tip_position, tip_velocity, wall_gap
from .compiled import compiled
from .controllers import KINDS, Law, adaptation_rate, advance_reference, reference_transition, tip, torque
from .segment import MESSAGES, OK, Solver, advance, initial_mode, left_acceleration

WIDTHS = (
    ("plant.q", 2), ("plant.dq", 2), ("plant.ddq", 2), ("plant.x", 2), ("plant.dx", 2), ("plant.F_ext", 2),
    ("plant.gap", 0), ("plant.penetration", 0),
    ("sensor.F_hat", 2), ("trajectory.x_v", 2), ("trajectory.dx_v", 2), ("trajectory.ddx_v", 2),
    ("controller.tau_cmd", 2), ("controller.x_t", 2), ("controller.dx_t", 2), ("controller.e", 2),
    ("controller.p_hat", 6), ("actuator.tau", 2), ("actuator.saturated", 2),
)  # fmt: skip
COLUMNS = tuple(name if n == 0 else f"{name}[{i + 1}]" for name, n in WIDTHS for i in range(max(n, 1)))
SENSOR = COLUMNS.index("sensor.F_hat[1]")
SOLVER = Solver()


class SetupError(ValueError):
    """Error for a Setup with a number that does not make sense."""


class IntegrationError(RuntimeError):
    """Error for a plant that cannot be integrated to the required accuracy."""


@dataclass(frozen=True)
class Setup:
    """All numbers of one run, in SI units (rad, m, s, N, kg); the defaults are the start values of the FMUs.

    Pairs are per joint (`m`, `l`, `viscous`, `coulomb`, `q_start`, `dq_start`, `tau_max`) or per axis (the others).
    Sextuples follow p = (m1, m2, viscous1, viscous2, coulomb1, coulomb2). `noise_std`, `noise_bound` (N) and
    `noise_period` belong to the sensor; `controller_noise_bound` is delta of (25). The controller shares `l`, `gravity`
    and `coulomb_velocity` with the plant. The trajectory shares the wall with the plant. `p_min` and `p_max` clamp
    p_hat when `projection` is set. With `update_divisor` = N the controller adapts at ticks 0, N, 2N, ... with the step
    N Ts.
    """

    controller: str = "HoganImpedance"
    sample_time: float = 1e-4
    stop_time: float = 2.0
    t0: float = 0.0
    q_start: tuple[float, float] = (-0.7227342478, 1.4454684956)
    dq_start: tuple[float, float] = (2.0943951024, 0.0)
    m: tuple[float, float] = (2.0, 1.0)
    l: tuple[float, float] = (1.0, 1.0)
    viscous: tuple[float, float] = (0.0, 0.0)
    coulomb: tuple[float, float] = (0.0, 0.0)
    coulomb_velocity: float = 1e-2
    gravity: float = 0.0
    wall_normal: tuple[float, float] = (-1.0, 0.0)
    wall_offset: float = 1.45
    K_f: float = 1e5
    D_f: float = 0.0
    mu: float = 0.0
    friction_velocity: float = 1e-2
    semi_axis: tuple[float, float] = (1.5, 1.0)
    period: float = 2.0
    depth: float = 0.01
    noise_std: float = 0.0
    noise_bound: float = 0.0
    noise_period: float = 0.0
    contact_gated: bool = True
    seed: int = 0
    tau_max: tuple[float, float] = (1e9, 1e9)
    M: tuple[float, float] = (2.0, 2.0)
    B: tuple[float, float] = (340.0, 340.0)
    K: tuple[float, float] = (4000.0, 4000.0)
    p_start: tuple[float, ...] = (2.0, 1.0, 0.0, 0.0, 0.0, 0.0)
    Gamma: tuple[float, ...] = (0.0,) * 6
    Psi: tuple[float, float] = (100.0, 100.0)
    K_d: tuple[float, float] = (100.0, 100.0)
    p_min: tuple[float, ...] = (0.0,) * 6
    p_max: tuple[float, ...] = (1e9,) * 6
    projection: bool = False
    dead_zone: float = 0.0
    freeze_when_saturated: bool = False
    update_divisor: int = 1
    controller_noise_bound: float = 0.0
    contact_threshold: float = 0.0
    gamma_margin: float = 1.5
    gamma_eps: float = 1e-4
    acc_filter_time: float = 1e-4

    def __post_init__(self):
        """Raise SetupError for a number that does not make sense."""
        steps = (self.stop_time - self.t0) / self.sample_time
        length = np.hypot(*self.wall_normal)
        problems = (
            (
                self.controller not in KINDS,
                f"controller {self.controller!r} is unknown; known: {', '.join(KINDS)}.",
            ),
            (
                steps < 0.5 or abs(steps - round(steps)) > 1e-6,
                f"{self.t0} s to {self.stop_time} s is {steps} samples of {self.sample_time} s; give a whole number.",
            ),
            (
                abs(length - 1.0) > 1e-9,
                f"wall_normal {self.wall_normal} has length {length}; give a unit vector.",
            ),
            (
                self.noise_std > 0.0 and not self.noise_bound > 0.0,
                f"noise_std is {self.noise_std} N but noise_bound {self.noise_bound} N; give both.",
            ),
        )
        for wrong, message in problems:
            if wrong:
                raise SetupError(message)


def simulate_reference(setup, solver=SOLVER):
    """Simulate the sampled-data loop as one monolithic program.

    Parameters
    ----------
    setup : Setup
        Numbers of the run.
    solver : Solver, optional
        Accuracy of the integration of the plant between ticks.

    Returns
    -------
    dict of str to ndarray, shape (N + 1,)
        "time" (s) and all columns, float64, by FMI names ("plant.q[1]", ...). The module docstring explains the rows.

    Raises
    ------
    IntegrationError
        If a segment cannot be integrated to `solver`'s tolerance.
    """
    ticks = round((setup.stop_time - setup.t0) / setup.sample_time)
    time = setup.t0 + np.arange(ticks + 1) * setup.sample_time
    noise = sensor_noise(setup, ticks)
    virtual = virtual_trajectory(setup, time[:-1])
    rows = np.empty((ticks + 1, len(COLUMNS)))
    y = np.array([*setup.q_start, *setup.dq_start], dtype=np.float64)
    tau_max = np.array(setup.tau_max, dtype=np.float64)
    gated = bool(setup.contact_gated)
    tick, status = run(plant_of(setup), law_of(setup), y, (virtual, noise, gated, tau_max), solver, rows)
    if status != OK:
        message = f"plant: in the segment from t = {time[tick]} s (tick {tick}), {MESSAGES[status]}."
        raise IntegrationError(message)
    return {"time": time, **{name: rows[:, i].copy() for i, name in enumerate(COLUMNS)}}


def virtual_trajectory(setup, time):
    """Return x_v (m), dx_v (m/s), ddx_v (m/s2), shape (n, 3, 2): an ellipse, clipped in the wall along the normal."""
    w, axes, n = 2.0 * np.pi / setup.period, np.array(setup.semi_axis), np.array(setup.wall_normal)
    c, s = np.cos(w * time), np.sin(w * time)
    virtual = np.stack([np.stack([c, s], 1), w * np.stack([-s, c], 1), -w * w * np.stack([c, s], 1)], 1) * axes
    limit = setup.wall_offset + setup.depth
    inside = virtual[:, 0] @ n > limit
    excess = virtual[inside] @ n - np.array([limit, 0.0, 0.0])
    virtual[inside] -= excess[:, :, None] * n
    return virtual


def sensor_noise(setup, ticks):
    """Return the errors of the sensor (N), shape (ticks, 2): draw n is block n of Philox4x64-10, key (seed, 0).

    A draw serves all ticks of a `noise_period`, or one tick if that is 0.
    """
    if setup.noise_std == 0.0:
        return np.zeros((ticks, 2))
    held = max(round(setup.noise_period / setup.sample_time), 1)
    draws = -(-ticks // held)
    # NumPy increments the counter before use, so the stream from counter -1 is block 0, 1, 2, ... of four words each.
    key = np.array([setup.seed, 0], dtype=np.uint64)
    words = np.random.Philox(key=key, counter=2**256 - 1).random_raw(4 * draws).reshape(draws, 4)
    u = ((words[:, :2] >> np.uint64(11)).astype(np.float64) + 0.5) * 2.0**-53
    reach = np.expm1(-((setup.noise_bound / setup.noise_std) ** 2) / 2.0)
    radius = setup.noise_std * np.sqrt(-2.0 * np.log1p(u[:, 0] * reach))
    angle = 2.0 * np.pi * u[:, 1]
    return np.repeat(np.stack([radius * np.cos(angle), radius * np.sin(angle)], 1), held, axis=0)[:ticks]


def plant_of(setup):
    """Return the plant of a Setup; all numbers become floats, so that numba compiles for one type only."""
    wall = (*setup.wall_normal, setup.wall_offset, setup.K_f, setup.D_f, setup.mu, setup.friction_velocity)
    p = np.array([*setup.m, *setup.viscous, *setup.coulomb], dtype=np.float64)
    return Plant(arm_of(setup), p, Wall(*map(float, wall)))


def law_of(setup):
    """Return the controller of a Setup."""
    derived = {
        "kind": KINDS[setup.controller],
        "arm": arm_of(setup),
        "tirt": reference_transition(setup.M, setup.B, setup.K, setup.sample_time),
    }
    types = {name: kind for name, kind in Law.__annotations__.items() if name not in derived}
    given = {name: getattr(setup, name) for name in types}
    arrays = {name: np.array(given[name], dtype=np.float64) for name, kind in types.items() if kind is np.ndarray}
    scalars = {name: kind(given[name]) for name, kind in types.items() if kind is not np.ndarray}
    return Law(**derived, **arrays, **scalars)


def arm_of(setup):
    """Return the geometry of the arm of a Setup."""
    return Arm(*map(float, (*setup.l, setup.gravity, setup.coulomb_velocity)))


@compiled
def run(plant, law, y, signals, solver, rows):
    """Fill `rows` tick by tick; return (tick, status) of the last segment."""
    virtual, noise, gated, tau_max = signals
    mode, p_hat, a_f = initial_mode(y, plant), law.p_start.copy(), np.zeros(2)
    ddq, saturated = np.zeros(2), False
    x_t, dx_t = virtual[0, 0].copy(), virtual[0, 1].copy()
    smoothing = law.sample_time / (law.acc_filter_time + law.sample_time)
    for n in range(len(virtual)):
        q, dq = y[:2].copy(), y[2:].copy()
        F_hat = measured_force(plant, q, dq, noise[n], gated)
        sample = (q, dq, F_hat, virtual[n], x_t, dx_t)
        a_f += smoothing * (ddq - a_f)
        tau_cmd = torque(law, sample, p_hat, a_f)
        tau = np.minimum(np.maximum(tau_cmd, -tau_max), tau_max)
        over = np.abs(tau_cmd) > tau_max
        if n == 0:
            ddq[0], ddq[1] = left_acceleration(y, tau, plant)
            a_f[:], saturated = ddq, over.any()
            write_plant(plant, y, ddq, rows[0])
        write_sampled(sample, tip(law.arm, q) - x_t, p_hat, (tau_cmd, tau, over), rows[n + 1])
        if n % law.update_divisor == 0 and not (law.freeze_when_saturated and saturated):
            p_hat = p_hat + law.update_divisor * law.sample_time * adaptation_rate(law, sample, p_hat, ddq)
            if law.projection:
                p_hat = np.minimum(np.maximum(p_hat, law.p_min), law.p_max)
        x_t, dx_t = advance_reference(law, sample)
        status = advance(y, mode, tau, plant, law.sample_time, solver)
        if status != OK:
            return n, status
        ddq[0], ddq[1] = left_acceleration(y, tau, plant)
        saturated = over.any()
        write_plant(plant, y, ddq, rows[n + 1])
    rows[0, SENSOR:] = rows[1, SENSOR:]
    return len(virtual) - 1, OK


@compiled
def measured_force(plant, q, dq, noise, gated):
    """Return F_hat (N): the true force plus the error `noise`, which a gated sensor has in contact only."""
    F1, F2 = external_force(plant, q, dq)
    if gated and F1 == 0.0 and F2 == 0.0:
        return np.array([F1, F2])
    return np.array([F1 + noise[0], F2 + noise[1]])


@compiled
def write_plant(plant, y, ddq, row):
    """Write the plant columns of a row, in the order of COLUMNS."""
    q, dq = y[:2], y[2:]
    row[0:4] = y
    row[4:6] = ddq
    row[6], row[7] = tip_position(plant.arm, q)
    row[8], row[9] = tip_velocity(plant.arm, q, dq)
    row[10], row[11] = external_force(plant, q, dq)
    row[12] = wall_gap(plant, q)
    row[13] = max(row[12], 0.0)


@compiled
def write_sampled(sample, e, p_hat, torques, row):
    """Write the sampled columns of a row, in the order of COLUMNS."""
    tau_cmd, tau, over = torques
    _, _, F_hat, virtual, x_t, dx_t = sample
    row[14:16] = F_hat
    row[16:18], row[18:20], row[20:22] = virtual[0], virtual[1], virtual[2]
    row[22:24], row[24:26], row[26:28], row[28:30] = tau_cmd, x_t, dx_t, e
    row[30:36], row[36:38], row[38:40] = p_hat, tau, over
