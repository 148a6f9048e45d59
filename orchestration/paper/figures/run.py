"""What figures show of a run: its curves, when the tip touches the wall, and where the wall is."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from orchestration.paper.measure import ESTIMATE, at_ticks, contact, norms
from orchestration.paper.numbers import TARGET_STIFFNESS, WALL_NORMAL
from orchestration.paper.wall import wall_points
from orchestration.results.result import Result

Span = tuple[float, float]


@dataclass(frozen=True)
class Run:
    """The curves of a run, each computed once. Arrays over ticks have the shape (n_ticks,) or (n_ticks, 2)."""

    result: Result

    @cached_property
    def ticks(self) -> np.ndarray:
        """Times of the controller's ticks, s."""
        return self.result.tick_times("controller.e[1]")

    @cached_property
    def x(self) -> np.ndarray:
        """Position of the tip at the communication points, m, shape (n_rows, 2)."""
        return self.result["plant.x"]

    @cached_property
    def x_v(self) -> np.ndarray:
        """Virtual trajectory, m."""
        return at_ticks(self.result, "trajectory.x_v")

    @cached_property
    def e(self) -> np.ndarray:
        """Tracking error x - x_t, mm."""
        return 1e3 * at_ticks(self.result, "controller.e")

    @cached_property
    def estimate(self) -> np.ndarray:
        """Estimate of m2, kg."""
        return self.result.at_ticks(ESTIMATE)

    @cached_property
    def command(self) -> np.ndarray:
        """Commanded torque, N.m."""
        return at_ticks(self.result, "controller.tau_cmd")

    @cached_property
    def torque(self) -> np.ndarray:
        """Torque of the actuators, N.m."""
        return at_ticks(self.result, "actuator.tau")

    @cached_property
    def saturated(self) -> np.ndarray:
        """Whether an actuator gives less than its command, by joint."""
        return np.abs(self.command) > np.abs(self.torque)

    @property
    def saturates(self) -> bool:
        """Whether an actuator saturates at any tick."""
        return bool(self.saturated.any())

    @cached_property
    def force(self) -> np.ndarray:
        """|F_ext| at the communication points, N, shape (n_rows,)."""
        return norms(self.result["plant.F_ext"])

    @cached_property
    def measured(self) -> np.ndarray:
        """|F_hat|, N."""
        return norms(at_ticks(self.result, "sensor.F_hat"))

    @cached_property
    def force_at_ticks(self) -> np.ndarray:
        """|F_ext| at the ticks, N."""
        return np.interp(self.ticks, self.result.time, self.force)

    @cached_property
    def noisy(self) -> bool:
        """Whether the sensor's force differs from the true force."""
        return bool(np.abs(self.measured - self.force_at_ticks).max() > 1e-6 * self.force.max())

    @cached_property
    def phases(self) -> np.ndarray:
        """Begin and end of every separate contact, s, shape (n_phases, 2)."""
        touching = np.concatenate([[False], self.force > 0, [False]]).astype(int)
        begin, end = np.flatnonzero(np.diff(touching) > 0), np.flatnonzero(np.diff(touching) < 0) - 1
        return np.column_stack([self.result.time[begin], self.result.time[end]])

    @cached_property
    def span(self) -> Span:
        """First and last instant of contact, s; the figures have no meaning without a contact."""
        touch = contact(self.result)
        return touch.first, touch.last

    @cached_property
    def sliding(self) -> np.ndarray:
        """Whether the tip slides, at the communication points: it touches, and half of the contact is over."""
        first, last = self.span
        time = self.result.time
        return (time >= (first + last) / 2) & (time <= last) & (self.force > 0)

    @cached_property
    def wall_offset(self) -> float:
        """Distance of the wall from the arm's base, m."""
        return float(self.x[0] @ np.array(WALL_NORMAL) - self.result["plant.gap"][0])

    @cached_property
    def depth(self) -> float:
        """How deep the straight segment of the virtual trajectory lies in the wall, m."""
        return float((self.x_v @ np.array(WALL_NORMAL)).max() - self.wall_offset)

    @property
    def steady_force(self) -> float:
        """The force K depth at which the target impedance rests, N."""
        return TARGET_STIFFNESS * self.depth

    @property
    def a_and_b(self) -> tuple[np.ndarray, np.ndarray]:
        """The points at which the ellipse meets the wall and leaves it, m."""
        return wall_points(self.wall_offset)
