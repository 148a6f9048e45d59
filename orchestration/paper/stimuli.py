"""Inputs and tunable parameters over time that each FMU is driven with when it runs alone.

Motions are chosen so that the equations act: the plant runs into the wall, the actuators saturate, the
sensor is noisy, and a controller sees a tip that deviates by millimetres while a noisy force sets in.
Everything is a function of time; nothing is recorded from a simulation.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from fmus.mechanics.planar_arm import PlanarArm
from fmus.start import ARMS

Columns = Mapping[str, np.ndarray]
ASSUMED_BOUND = 20.0  # N, of the sensor's error, as controllers are told
LIMITS = (500.0, 300.0, 100.0)  # N.m, of the actuators


@dataclass(frozen=True)
class Stimulus:
    """What an FMU is driven with: columns by variable at t_k = k step, k = 0 to n_steps; step in s.

    Attributes
    ----------
    columns
        Maps times, shape (n_steps + 1,), to a column of that shape by name.
    """

    step: float
    n_steps: int
    columns: Callable[[np.ndarray], Columns]

    def times(self) -> np.ndarray:
        """The communication points, s, shape (n_steps + 1,)."""
        return self.step * np.arange(self.n_steps + 1)


def _named(name: str, values: np.ndarray) -> dict[str, np.ndarray]:
    """Columns of a vector's elements from values of shape (n, rows)."""
    return {f"{name}[{i + 1}]": column for i, column in enumerate(values)}


def _constant(name: str, t: np.ndarray, *values: float) -> dict[str, np.ndarray]:
    """Columns of a vector that does not change; shape () gives a scalar."""
    return _named(name, np.tile(np.array(values)[:, np.newaxis], t.size))


def _nothing(t: np.ndarray) -> Columns:  # noqa: ARG001
    return {}


def _into_the_wall(n: int) -> Callable[[np.ndarray], Columns]:
    """Torque that turns the whole arm about its base, ever faster, until the tip hits the wall at 0.62 s."""
    arm, begin, acceleration = PlanarArm(n), ARMS[n], 8.0  # rad/s2

    def columns(t: np.ndarray) -> Columns:
        p = [*begin.masses, *[0.0] * 2 * n]
        torques = []
        for time in t:
            q, dq = np.array(begin.q), np.zeros(n)
            rate = 2 * np.pi / 3  # rad/s, the first joint's of begin.dq
            q[0] += rate * time + acceleration * time**2 / 2
            dq[0] = rate + acceleration * time
            ddq = np.eye(n)[0] * acceleration
            torques.append(np.array(arm.inverse_dynamics(q, dq, dq, ddq, p, begin.link_lengths, 0, 1)).ravel())
        return _named("tau", np.array(torques).T)

    return columns


def _contact_force(t: np.ndarray) -> np.ndarray:
    """Force on the wall in the middle half of the time, N, shape (2, rows): a smooth pulse, with sliding friction."""
    share = t / t[-1]
    pulse = np.where((share > 0.25) & (share < 0.75), np.sin(2 * np.pi * (share - 0.25)) ** 2, 0)
    return np.array([-40 * pulse, 8 * pulse])


def _noise(t: np.ndarray) -> np.ndarray:
    """Readings that look random, in [-1, 1], shape (2, rows)."""
    k = np.arange(t.size)
    return np.array([np.sin(2.3 * k**1.5), np.cos(1.7 * k**1.5)])


def _noisy_force(t: np.ndarray) -> Columns:
    columns = _named("F_ext", 20 * _contact_force(t))
    on = np.where(t > 0.4 * t[-1], 1.0, 0.0)  # from a time within the contact
    return {**columns, "noise_std": 30 * on, "noise_bound": 90 * on}


def _hard_commands(n: int) -> Callable[[np.ndarray], Columns]:
    """Torque of up to 1.5 times the limits."""

    def columns(t: np.ndarray) -> Columns:
        turns = np.arange(1, n + 1)[:, np.newaxis] * 2 * np.pi * t / t[-1]
        limits = np.array(LIMITS[:n])
        command = 1.5 * limits[:, np.newaxis] * np.sin(turns)
        return {**_named("tau_cmd", command), **_constant("tau_max", t, *limits)}

    return columns


def _along_a_path(n: int, *, adaptive: bool = False, noise_bound: bool = False) -> Callable[[np.ndarray], Columns]:
    """An oscillation of the joints, a virtual trajectory next to the tip's, and a noisy contact."""
    arm, begin = PlanarArm(n), ARMS[n]

    def columns(t: np.ndarray) -> Columns:
        rates = np.arange(n, 0, -1) * 5.0  # rad/s
        phases = np.outer(rates, t)
        rate = rates[:, np.newaxis]
        q = np.array(begin.q)[:, np.newaxis] + 0.1 * np.sin(phases)
        dq, ddq = 0.1 * rate * np.cos(phases), -0.1 * rate**2 * np.sin(phases)
        signals = {"q": q, "dq": dq, "ddq": ddq, "F_hat": _contact_force(t)}
        signals["F_hat"] = signals["F_hat"] + np.where(signals["F_hat"] != 0, ASSUMED_BOUND / 2 * _noise(t), 0)
        tip = [_tip(arm, begin.link_lengths, *row) for row in zip(q.T, dq.T, ddq.T, strict=True)]
        for i, name in enumerate(("x_v", "dx_v", "ddx_v")):
            signals[name] = np.array([row[i] for row in tip]).T + _deviation(t, order=i)
        result = {name: column for key, values in signals.items() for name, column in _named(key, values).items()}
        if adaptive:
            saturated = (t > 0.5 * t[-1]) & (t < 0.6 * t[-1])
            result |= _named("saturated", np.array([saturated] * n))
        return {**result, "noise_bound": np.full_like(t, ASSUMED_BOUND)} if noise_bound else result

    return columns


def _tip(arm: PlanarArm, l: tuple[float, ...], q: np.ndarray, dq: np.ndarray, ddq: np.ndarray) -> list[np.ndarray]:
    """Position, velocity and acceleration of the tip, shape (2,) each."""
    J = np.array(arm.jacobian(q, l))
    dJ = np.array(arm.jacobian_rate(q, dq, l))
    return [np.array(arm.forward_kinematics(q, l)).ravel(), J @ dq, J @ ddq + dJ @ dq]


def _deviation(t: np.ndarray, order: int) -> np.ndarray:
    """Offset of the virtual trajectory, 0.5 mm, or its derivative of that order; shape (2, rows)."""
    rates = np.array([[40.0], [25.0]])  # rad/s
    return 5e-4 * rates**order * np.sin(rates * t + order * np.pi / 2)


_TICKS, _PATH = (1e-3, 100), (1e-3, 60)  # ten ticks a step
STIMULI: Mapping[str, Stimulus] = {
    "VirtualTrajectory": Stimulus(0.02, 100, _nothing),
    "ForceSensor": Stimulus(*_TICKS, _noisy_force),
    "HoganImpedance": Stimulus(*_PATH, _along_a_path(2)),
    "CraigAdaptiveImpedance": Stimulus(*_PATH, _along_a_path(2, adaptive=True, noise_bound=True)),
    "SlotineLiAdaptiveImpedance": Stimulus(*_PATH, _along_a_path(2, adaptive=True)),
    "SpongOrtegaAdaptiveImpedance": Stimulus(*_PATH, _along_a_path(2, adaptive=True, noise_bound=True)),
    "Actuator": Stimulus(*_TICKS, _hard_commands(2)),
    "Plant": Stimulus(6e-3, 110, _into_the_wall(2)),
    "HoganImpedance3R": Stimulus(*_PATH, _along_a_path(3)),
    "Actuator3R": Stimulus(*_TICKS, _hard_commands(3)),
    "Plant3R": Stimulus(6e-3, 110, _into_the_wall(3)),
}
"""One stimulus for each unit of the catalog."""
