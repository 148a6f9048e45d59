"""Monolithic reference of the loop of the PUMA 560: trajectory, force sensor, controller, actuator, plant.

At each tick t_k = k Ts, in this order: the virtual trajectory at t_k; F_hat = F_ext(t_k) + noise; the controller's
torque from the state at t_k, clipped, and held on [t_k, t_k+1); the plant, with events, to t_k+1. Row 0 is the initial
state with the outputs of tick 0. Row k + 1 holds the sampled values of tick k and the plant at t_k+1. ``plant.ddq`` is
the left limit there. The rules are those of `tests.reference.monolithic`, which has the planar arm.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from tests.reference.controllers import reference_transition
from tests.reference.segment import GAP, Solver

from .arm import JOINTS, hold, pin, puma, ten_of_body
from .laws import Kinematics, Law, Sample, friction
from .segment import Segment

AXES = 6
OF_PLANT = (
    ("plant.q", JOINTS), ("plant.dq", JOINTS), ("plant.ddq", JOINTS), ("plant.x", AXES), ("plant.dx", AXES),
    ("plant.F_ext", AXES), ("plant.gap", 0), ("plant.penetration", 0),
)  # fmt: skip
SAMPLED = (
    ("sensor.F_hat", AXES), ("trajectory.x_v", AXES), ("trajectory.dx_v", AXES), ("trajectory.ddx_v", AXES),
    ("controller.tau_cmd", JOINTS), ("controller.x_t", AXES), ("controller.dx_t", AXES), ("controller.e", AXES),
    ("controller.p_hat", 10), ("actuator.tau", JOINTS),
    ("actuator.saturated", JOINTS),
)  # fmt: skip
WIDTHS = OF_PLANT + SAMPLED
PAYLOAD = 13 * JOINTS  # elements of p before those of the payload


@dataclass(frozen=True, kw_only=True)
class Setup:
    """All numbers of one run, in SI units (rad, m, s, N, kg); the names are those of the FMUs' parameters.

    `viscous` and `coulomb` are friction in the plant, `assumed_viscous` and `assumed_coulomb` that which the controller
    assumes. `payload_*` is the plant's payload in the frame of the tip; the controller starts with the ten parameters
    `p_hat` and adapts them with the gains `Gamma`, both of shape (10,). Gains of six elements act along the axes of
    the base, turned by `task_rpy`. `noise_*`, `seed` and the frame `sensor_*` belong to the sensor.
    """

    controller: str
    q_start: tuple[float, ...]
    dq_start: tuple[float, ...]
    sample_time: float
    stop_time: float
    gravity: tuple[float, ...]
    reference_rpy: tuple[float, ...]
    coulomb_velocity: float
    viscous: tuple[float, ...]
    coulomb: tuple[float, ...]
    assumed_viscous: tuple[float, ...]
    assumed_coulomb: tuple[float, ...]
    payload_mass: float
    payload_center: tuple[float, ...]
    payload_inertia: tuple[float, ...]
    contact_point: tuple[float, ...]
    wall_normal: tuple[float, ...]
    wall_offset: float
    K_f: float
    D_f: float
    mu: float
    friction_velocity: float
    center: tuple[float, ...]
    plane_rpy: tuple[float, ...]
    semi_axis: tuple[float, ...]
    period: float
    depth: float
    orientation: tuple[float, ...]
    tilt: tuple[float, ...]
    noise_std: float
    noise_bound: float
    noise_period: float
    contact_gated: float
    seed: float
    sensor_L: float
    sensor_position: tuple[float, ...]
    sensor_rpy: tuple[float, ...]
    tau_max: tuple[float, ...]
    task_rpy: tuple[float, ...]
    M: tuple[float, ...]
    B: tuple[float, ...]
    K: tuple[float, ...]
    p_hat: tuple[float, ...]
    L: float = 1.0
    Psi: tuple[float, ...] = (0.0,) * 6
    K_d: tuple[float, ...] = (0.0,) * 6
    Gamma: tuple[float, ...] = (0.0,) * 10


def simulate_reference(setup, solver=Solver()):  # noqa: B008 - a tuple of numbers
    """Simulate the sampled-data loop of the PUMA 560 as one monolithic program.

    Returns
    -------
    dict of str to ndarray, shape (N + 1,)
        "time" (s) and all columns by FMI names ("plant.q[1]", ...). The elements of p_hat are those of the payload,
        ``controller.p_hat[79]`` to ``[88]``. The module docstring explains the rows.

    Raises
    ------
    IntegrationError
        If a segment cannot be integrated to the tolerance of `solver`.
    """
    ticks = round(setup.stop_time / setup.sample_time)
    time = np.arange(ticks + 1) * setup.sample_time
    rows = {name: np.empty((ticks + 1, max(width, 1))) for name, width in WIDTHS}
    _run(setup, solver, (virtual_trajectory(setup, time[:-1]), sensor_noise(setup, ticks)), rows)
    columns = {"time": time}
    for name, width in WIDTHS:
        first = PAYLOAD if name == "controller.p_hat" else 0
        for i in range(max(width, 1)):
            columns[name if width == 0 else f"{name}[{first + i + 1}]"] = rows[name][:, i].copy()
    return columns


def virtual_trajectory(setup, time):
    """Return x_v, dx_v, ddx_v, shape (N, 3, 6): an ellipse in space, clipped in the wall, and angles that tilt."""
    w = 2.0 * np.pi / setup.period
    c, s, zero, one = np.cos(w * time), np.sin(w * time), 0.0 * time, 1.0 + 0.0 * time
    plane = Rotation.from_euler("xyz", setup.plane_rpy).as_matrix()[:, :2] * setup.semi_axis
    path = np.stack([np.stack([c, s], 1), w * np.stack([-s, c], 1), -w * w * np.stack([c, s], 1)], 1) @ plane.T
    path[:, 0] += setup.center
    normal, limit = np.array(setup.wall_normal), setup.wall_offset + setup.depth
    inside = path[:, 0] @ normal > limit
    excess = path[inside] @ normal - np.array([limit, 0.0, 0.0])
    path[inside] -= excess[:, :, None] * normal
    turned = np.stack([one - c, w * s, w * w * c], 1)[:, :, None] * np.array(setup.tilt) / 2.0
    turned += np.stack([one, zero, zero], 1)[:, :, None] * np.array(setup.orientation)
    return np.concatenate([path, turned], axis=2)


def sensor_noise(setup, ticks):
    """Return the errors of the sensor in its own axes, N and N.m, shape (ticks, 6).

    Draw n is block n of Philox4x64-10 with the key (seed, 0), and serves all ticks of a `noise_period`, or one. Its
    four uniform numbers, and what is left of them behind 26 binary digits, make three pairs of truncated normal numbers
    whose bound is noise_bound / sqrt(3). The last three numbers times L are moments.
    """
    if setup.noise_std == 0.0:
        return np.zeros((ticks, AXES))
    held = max(round(setup.noise_period / setup.sample_time), 1)
    draws = -(-ticks // held)
    key = np.array([setup.seed, 0], dtype=np.uint64)
    words = np.random.Philox(key=key, counter=2**256 - 1).random_raw(4 * draws).reshape(draws, 4)
    u = ((words >> np.uint64(11)).astype(np.float64) + 0.5) * 2.0**-53
    u = np.concatenate([u, np.modf(u * 2.0**26)[0]], axis=1)[:, :6].reshape(draws, 3, 2)
    bound = setup.noise_bound / np.sqrt(3.0)
    reach = np.expm1(-((bound / setup.noise_std) ** 2) / 2.0)
    radius = setup.noise_std * np.sqrt(-2.0 * np.log1p(u[:, :, 0] * reach))
    angle = 2.0 * np.pi * u[:, :, 1]
    pairs = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=2).reshape(draws, AXES)
    lengths = np.array([1.0] * 3 + [setup.sensor_L] * 3)
    return np.repeat(pairs * lengths, held, axis=0)[:ticks]


class Sensor:
    """A force and moment sensor, which is turned by `sensor_rpy` at `sensor_position` in the frame of the tip."""

    def __init__(self, setup):
        self.axes = Rotation.from_euler("xyz", setup.sensor_rpy).as_matrix()
        self.place, self.gated = np.array(setup.sensor_position), bool(setup.contact_gated)

    def measured(self, wrench, error, R):
        """Return F_hat at the tip in the axes of the base: the wrench, and an error of the sensor carried there."""
        if self.gated and not wrench.any():
            return wrench
        turned = R @ self.axes
        force = turned @ error[:3]
        return wrench + np.concatenate([force, turned @ error[3:] + np.cross(R @ self.place, force)])


class Plant:
    """The arm with its payload and friction, and the wall: what `Segment` integrates."""

    def __init__(self, setup):
        self.setup, bare = setup, puma(setup.gravity, setup.contact_point)
        body = ten_of_body(setup.payload_mass, setup.payload_center, setup.payload_inertia)
        self.model = hold(bare, body)
        self.data, self.touch = self.model.createData(), self.model.getFrameId("touch")
        self.normal, self.damped = np.array(setup.wall_normal), setup.D_f > 0.0
        self.viscous, self.coulomb = np.array(setup.viscous), np.array(setup.coulomb)
        self.felt = pin.StdVec_Force()
        for _ in range(JOINTS + 1):
            self.felt.append(pin.Force.Zero())

    def flow(self, y, tau, loaded):
        """Return (dq, ddq) at a state y = (q, dq), with the force law of the mode, whatever the gap is."""
        q, dq = y[:JOINTS], y[JOINTS:]
        torque = tau - friction(dq, self.viscous, self.coulomb, self.setup)
        if loaded:
            force = self.contact_force(*self.touching(q, dq))
            about_base = pin.Force(-force, np.cross(self.data.oMf[self.touch].translation, -force))
            self.felt[JOINTS] = self.data.oMi[JOINTS].actInv(about_base)
            return np.concatenate([dq, pin.aba(self.model, self.data, q, dq, torque, self.felt)])
        return np.concatenate([dq, pin.aba(self.model, self.data, q, dq, torque)])

    def touching(self, q, dq):
        """Return position m and velocity m/s of the contact point, shape (3,) each."""
        pin.forwardKinematics(self.model, self.data, q, dq)
        place = pin.updateFramePlacement(self.model, self.data, self.touch).translation
        rate = pin.getFrameVelocity(self.model, self.data, self.touch, pin.LOCAL_WORLD_ALIGNED).linear
        return place, rate

    def contact_force(self, place, rate):
        """Return the force on a loaded wall, N, shape (3,): K_f gap (1 + D_f gap_rate) (n + mu tanh(v/v_mu) slide)."""
        setup, n = self.setup, self.normal
        along = n @ rate
        normal = setup.K_f * (n @ place - setup.wall_offset) * (1.0 + setup.D_f * along)
        slide = rate - along * n
        speed = np.sqrt(slide @ slide)
        drag = setup.mu * np.tanh(speed / setup.friction_velocity) / speed if speed > 0.0 else 0.0
        return normal * (n + drag * slide)

    def event(self, which, y, dy):
        """Return the value and the rate of the gap, or of 1 + D_f gap_rate; `dy` is the rate of the state y."""
        setup, n = self.setup, self.normal
        place, rate = self.touching(y[:JOINTS], y[JOINTS:])
        if which == GAP:
            return n @ place - setup.wall_offset, n @ rate
        pin.forwardKinematics(self.model, self.data, y[:JOINTS], y[JOINTS:], dy[JOINTS:])
        axes = pin.LOCAL_WORLD_ALIGNED
        second = pin.getFrameClassicalAcceleration(self.model, self.data, self.touch, axes).linear
        return 1.0 + setup.D_f * (n @ rate), setup.D_f * (n @ second)

    def wrench(self, q, dq, R):
        """Return F_ext at the tip, N and N.m, shape (6,); R turns from the axes of the tip to those of the base."""
        place, rate = self.touching(q, dq)
        gap = self.normal @ place - self.setup.wall_offset
        if gap <= 0.0 or 1.0 + self.setup.D_f * (self.normal @ rate) <= 0.0:
            return np.zeros(AXES)
        force = self.contact_force(place, rate)
        return np.concatenate([force, np.cross(R @ np.array(self.setup.contact_point), force)])


def _run(setup, solver, signals, rows):
    """Fill `rows` tick by tick; `signals` are the virtual trajectory and the errors of the sensor."""
    virtual, noise = signals
    plant, bare = Plant(setup), puma(setup.gravity)
    law, kinematics, segment = Law(setup, bare), Kinematics(bare, setup.reference_rpy), Segment(plant, solver)
    sensor, limit = Sensor(setup), np.array(setup.tau_max)
    transition = reference_transition(setup.M, setup.B, setup.K, setup.sample_time)
    y, p_hat, ddq = np.array([*setup.q_start, *setup.dq_start]), np.array(setup.p_hat), np.zeros(JOINTS)
    turn = law.turn
    x_t, dx_t = virtual[0, 0] @ turn, virtual[0, 1] @ turn  # in the axes of the task, as all that the law knows
    segment.begin(y)
    tip = kinematics.tip(y[:JOINTS], y[JOINTS:])
    wrench = plant.wrench(y[:JOINTS], y[JOINTS:], tip.R)
    for n in range(len(virtual)):
        F_hat = sensor.measured(wrench, noise[n], tip.R)
        of_task = tip.turned(turn)
        seen = Sample(y[:JOINTS], y[JOINTS:], ddq, of_task, tip.force(F_hat) @ turn, virtual[n] @ turn, x_t, dx_t)
        command = law.torque(seen, p_hat)
        tau = np.clip(command, -limit, limit)
        if n == 0:
            ddq = plant.flow(y, tau, segment.loaded)[JOINTS:]
            seen = replace(seen, ddq=ddq)
            _write_plant(plant, y, ddq, (tip, wrench), rows, 0)
        e = turn @ (of_task.x - x_t)
        sampled = (F_hat, *virtual[n], command, turn @ x_t, turn @ dx_t, e, p_hat, tau, np.abs(command) > limit)
        for (name, _), value in zip(SAMPLED, sampled, strict=True):
            rows[name][n + 1] = value
        p_hat = p_hat + setup.sample_time * law.adaptation_rate(seen, p_hat)
        x_t, dx_t = _advance_reference(setup.sample_time, transition, seen.virtual, seen.F, x_t, dx_t)
        y = segment.advance(y, tau, setup.sample_time)
        ddq = plant.flow(y, tau, segment.loaded)[JOINTS:]
        tip = kinematics.tip(y[:JOINTS], y[JOINTS:])
        wrench = plant.wrench(y[:JOINTS], y[JOINTS:], tip.R)
        _write_plant(plant, y, ddq, (tip, wrench), rows, n + 1)
    for name, _ in SAMPLED:
        rows[name][0] = rows[name][1]


def _advance_reference(h, transition, v, F, x_t, dx_t):
    """Return x_t and dx_t of the next tick, eq. (11): exact in x_t - x_v, with x_v by its Taylor polynomial."""
    d = np.stack([x_t - v[0], dx_t - v[1], F], axis=1)
    moved = np.einsum("aij,aj->ai", transition, d)
    return v[0] + h * v[1] + 0.5 * h * h * v[2] + moved[:, 0], v[1] + h * v[2] + moved[:, 1]


def _write_plant(plant, y, ddq, seen, rows, k):
    """Write the plant's columns of a row; `seen` is the tip and its wrench."""
    tip, wrench = seen
    gap = plant.event(GAP, y, y)[0]
    values = (y[:JOINTS], y[JOINTS:], ddq, tip.x, tip.dx, wrench, gap, max(gap, 0.0))
    for (name, _), value in zip(OF_PLANT, values, strict=True):
        rows[name][k] = value
