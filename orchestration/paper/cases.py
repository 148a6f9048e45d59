"""The cases in which the claims are asked: the paper's arm in the plane, and the PUMA 560 in space.

Both have the same runs, by the name of the paper's figure, and the same criteria. What differs is data: sizes, the
parameters that are looked for, and the scale of limits that are lengths or forces.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from orchestration.paper import spatial_numbers as space
from orchestration.paper.numbers import (
    NO_TORQUE_LIMIT,
    NOISE_BOUND,
    TARGET_INERTIA,
    TARGET_STIFFNESS,
    TIP_START,
    TORQUE_LIMITS,
    TRUE_M2,
    TRUE_MASSES,
)
from orchestration.paper.scenario import Scenario
from orchestration.paper.scenarios import ALL_SCENARIOS
from orchestration.paper.spatial_scenarios import SPATIAL
from orchestration.paper.task_shape import ESTIMATES, PLANAR_SHAPE, TaskShape, payload_number, scales
from orchestration.paper.task_shape import SPATIAL as SPATIAL_SIZE
from orchestration.paper.wall import wall_points

FIGURES = ("fig2", "fig3", "fig4", "fig5", "fig6", "fig7")
IDEAL, FIXED_INVERSE = "ideal", "spong-ortega"
Kinetic = Callable[[np.ndarray, np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Case:
    """An arm with its runs, of which the claims are asked.

    Attributes
    ----------
    name
        Short name.
    runs
        Name of the scenario that is the run of a figure, by the name of the figure, ``ideal`` or ``spong-ortega``.
    shape
        Task and joints.
    true
        True values of the parameters that are adapted, by their number among the elements of p.
    ends
        Where the virtual trajectory meets the wall and leaves it, m.
    place
        What the tip returns to, in words.
    noise_bound
        The bound delta of |S^-1 F| in the coordinates of the task, N.
    torque_limits
        Limits of Figs. 6 and 7, N.m, shape (n,).
    dampings
        Gains K_d, N.s/m, and `periods`, s, at which the theory is tried.
    kinetic
        Twice the kinetic energy s' H_x s, from q, shape (n_ticks, n), and s, shape (n_ticks, m).
    scale
        What limits in mm and in N are multiplied by.
    """

    name: str
    runs: Mapping[str, str]
    shape: TaskShape
    true: Mapping[int, float]
    ends: tuple[np.ndarray, np.ndarray]
    place: str
    noise_bound: float
    torque_limits: Sequence[float]
    dampings: Sequence[float]
    periods: Sequence[float]
    kinetic: Kinetic = field(compare=False)
    scale: float = 1.0

    def scenario(self, figure: str) -> Scenario:
        """The run of a figure."""
        return ALL_SCENARIOS[self.runs[figure]]

    def columns(self, *names: str) -> list[str]:
        """Columns of arrays that have an element for each task coordinate, such as ``controller.e``."""
        return [f"{name}[{i}]" for name in names for i in range(1, self.shape.size + 1)]

    def by_joint(self, *names: str) -> list[str]:
        """Columns of arrays that have an element for each joint."""
        return [f"{name}[{i}]" for name in names for i in range(1, self.shape.joints + 1)]

    @property
    def estimates(self) -> list[str]:
        """Columns of the parameters that are adapted."""
        return [f"{ESTIMATES}[{number}]" for number in self.true]

    @property
    def unsaturated(self) -> Mapping[str, float]:
        """Start values that switch torque limits off."""
        return dict.fromkeys(self.by_joint("actuator.tau_max"), NO_TORQUE_LIMIT)

    def gains(self, figure: str, factor: float = 1.0) -> Mapping[str, float]:
        """Gamma of the parameters that are adapted in the run of a figure, times a factor, as start values."""
        values = self.scenario(figure).values
        paths = [f"controller.Gamma[{number}]" for number in self.true]
        return {path: factor * values[path].number for path in paths if path in values}

    def damping(self, K_d: float) -> Mapping[str, float]:
        """K_d of all coordinates, as start values; that of an angle has the factor L^2."""
        squares = scales(self.shape.size) ** 2
        return {path: K_d * float(s) for path, s in zip(self.columns("controller.K_d"), squares, strict=True)}


def _planar_energy(q: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Of point masses at the ends of the links: the second one moves with s, and the first one with l_1 dq_1."""
    second = q[:, 0] + q[:, 1]
    speed = (s[:, 0] * np.cos(second) + s[:, 1] * np.sin(second)) / np.sin(q[:, 1])
    return TRUE_MASSES[0] * speed**2 + TRUE_MASSES[1] * (s[:, 0] ** 2 + s[:, 1] ** 2)


def _spatial_energy(q: np.ndarray, s: np.ndarray) -> np.ndarray:
    from orchestration.paper.spatial_theory import kinetic_energy

    return kinetic_energy(q, s)


def _table_points() -> tuple[np.ndarray, np.ndarray]:
    """Where the ellipse of the PUMA meets the table, m; the tip moves along axis 2 of the base in contact."""
    x, y, z = space.ELLIPSE_CENTER
    height = -space.TABLE_OFFSET
    along = space.ELLIPSE[1] * float(np.sqrt(1 - ((height - z) / space.ELLIPSE[0]) ** 2))
    return np.array([x, y - along, height]), np.array([x, y + along, height])


PLANAR_CASE = Case(
    name="planar",
    runs={name: name for name in (*FIGURES, IDEAL, FIXED_INVERSE)},
    shape=PLANAR_SHAPE,
    true={2: TRUE_M2},
    ends=wall_points(),
    place=f"({TIP_START[0]:g}, {TIP_START[1]:g})",
    noise_bound=NOISE_BOUND,
    torque_limits=TORQUE_LIMITS,
    dampings=(30.0, 100.0, 300.0, 1000.0, 3000.0),
    periods=(4e-5, 2e-5, 1e-5, 5e-6),
    kinetic=_planar_energy,
)
"""The paper's arm."""

STIFFNESS = space.STIFFNESS_RATE * space.INERTIA  # N/m
PUMA_CASE = replace(
    PLANAR_CASE,
    name="puma",
    runs={
        "fig2": "puma-ideal",
        "fig3": "puma-ideal",
        "fig4": "puma-hogan",
        "fig5": "puma-craig",
        "fig6": "puma-craig-saturated",
        "fig7": "puma",
        IDEAL: "puma-ideal",
        FIXED_INVERSE: "puma-spong-ortega",
    },
    shape=TaskShape(SPATIAL_SIZE, space.JOINTS, f"{ESTIMATES}[{space.FIRST_OF_PAYLOAD}]", r"\hat m"),
    true=dict(enumerate(space.payload_parameters(), payload_number(space.JOINTS))),
    ends=_table_points(),
    place="the start",
    # A moment counts E' m in the coordinates, and the norm of E is sqrt(1 + |sin(pitch)|).
    noise_bound=space.NOISE_BOUND * float(np.sqrt(1 + np.sin(np.abs(space.TILT[1])))),
    torque_limits=space.TORQUE_LIMITS,
    dampings=tuple(K_d * space.INERTIA / TARGET_INERTIA for K_d in PLANAR_CASE.dampings),
    periods=tuple(space.STEP * factor for factor in (2.0, 1.0, 0.5, 0.25)),
    kinetic=_spatial_energy,
    # K is four times the paper's, so that the same force takes a fourth of the way; and the impact is a fourth of the
    # paper's, too.
    scale=TARGET_STIFFNESS / STIFFNESS,
)
"""The PUMA 560 with a payload on a table; m2 of the claims is the payload's mass."""

CASES: Mapping[str, Case] = {case.name: case for case in (PLANAR_CASE, PUMA_CASE)}
"""The cases by name."""


def case_of(scenario: str) -> Case:
    """The case to which a scenario belongs."""
    return PUMA_CASE if scenario in SPATIAL else PLANAR_CASE
