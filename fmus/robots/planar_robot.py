"""The planar arm in an FMU: its parameters, which plants and controllers declare, and its start values."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, DefinitionError, Drawing, Icon, Model
from fmus import icons, start
from fmus.drawings.arm import arm as drawn_arm
from fmus.elements import RATE, of_links
from fmus.mechanics.arm import ArmModel, ArmParameter
from fmus.mechanics.joints import Joints
from fmus.mechanics.planar_arm import PlanarArm
from fmus.mechanics.planar_model import PlanarArmModel, PlanarPlantModel, planar_parameters
from fmus.mechanics.task import Task
from fmus.robots.substep import LONGEST


@dataclass(frozen=True)
class PlanarRobot:
    """A planar arm with start values; see `fmus.robots.robot.Robot`.

    Attributes
    ----------
    n
        Number of joints, 2 or 3.
    pose
        Whether the task is position and angle of the tip, which needs three joints; else it is the position.

    Raises
    ------
    DefinitionError
        If there are no start values of such an arm.
    """

    n: int = 2
    pose: bool = False

    def __post_init__(self) -> None:
        """Refuse arms without start values."""
        if self.pose and self.n != len(start.POSE_ARM.q):
            known = len(start.POSE_ARM.q)
            msg = f"PlanarRobot: there is an arm with a task of position and angle with {known} joints, not {self.n}."
            raise DefinitionError(msg)
        if self.n not in start.ARMS:
            known = " or ".join(map(str, start.ARMS))
            msg = f"PlanarRobot: there are arms with {known} joints, not {self.n}."
            raise DefinitionError(msg)

    @cached_property
    def arm(self) -> PlanarArm:
        """Equations of the arm."""
        return PlanarArm(self.n, self.pose)

    @property
    def joints(self) -> Joints:
        """Joints that turn, by their numbers."""
        return Joints.numbered(self.n)

    @property
    def task(self) -> Task:
        """Task coordinates of the tip."""
        return self.arm.task

    @property
    def parameters(self) -> Sequence[ArmParameter]:
        """What the elements of p are, shape (3 n,)."""
        return planar_parameters(self.n)

    @property
    def start(self) -> start.ArmStart:
        """Masses, lengths and motion at the start."""
        return start.POSE_ARM if self.pose else start.ARMS[self.n]

    @property
    def dt_max(self) -> float:
        """Longest sub-step of its plant at the start, s."""
        return LONGEST

    @property
    def p_start(self) -> Sequence[float]:
        """Parameters p at the start, shape (3 n,): no friction."""
        return [*self.start.masses, *([0.0] * 2 * self.n)]

    @property
    def uncertain(self) -> Sequence[bool]:
        """Whether an element of p is adapted by default, shape (3 n,): the last mass, which has the payload."""
        return [i == self.n - 1 for i in range(3 * self.n)]

    @property
    def title(self) -> str:
        """What its plant is."""
        return "Planar arm with point masses"

    @property
    def modules(self) -> Sequence[str]:
        """Names of the modules whose docstrings hold its equations."""
        return ["fmus.mechanics.planar_arm"]

    def place_of_wall(self, number: int) -> tuple[Sequence[float], float]:
        """Start values of a wall: its unit normal, and the distance of its surface, m."""
        return start.WALL_NORMALS[number], start.WALL_OFFSETS[number]

    def icon(self, *, corner: bool = False) -> Icon:
        """Icon of its plant."""
        return icons.arm(self.n, corner=corner)

    def drawing(self, walls: int = 1) -> Drawing:
        """Draw its frames and signs."""
        return drawn_arm(self.n, walls)

    def declare_known(self, model: Model) -> ArmModel:
        """Declare lengths, gravity and the velocity of friction."""
        l = _lengths(model, self)
        gravity = _gravity(model)
        return PlanarArmModel(self.arm, l, gravity, _coulomb_velocity(model))

    def declare_true(self, model: Model) -> tuple[ArmModel, ca.SX]:
        """Declare masses, lengths, friction and gravity of a plant; returns the arm and p, shape (3 n,)."""
        n = self.n
        m = model.parameter(
            "m", self.start.masses, unit="kg", limits=POSITIVE, description=of_links("Point mass at the end", n)
        )
        l = _lengths(model, self)
        viscous = model.parameter(
            "viscous",
            [0.0] * n,
            unit="N.m.s/rad",
            limits=NOT_NEGATIVE,
            description=self.joints.texts("Coefficient of viscous friction"),
        )
        coulomb = model.parameter(
            "coulomb",
            [0.0] * n,
            unit="N.m",
            limits=NOT_NEGATIVE,
            description=self.joints.texts("Coulomb friction torque"),
        )
        coulomb_velocity = _coulomb_velocity(model)
        arm = PlanarPlantModel(self.arm, l, _gravity(model), coulomb_velocity)
        return arm, ca.vertcat(m, viscous, coulomb)


def _lengths(model: Model, robot: PlanarRobot) -> ca.SX:
    """Declare the lengths of the links."""
    lengths = robot.start.link_lengths
    return model.parameter("l", lengths, unit="m", limits=POSITIVE, description=of_links("Length", robot.n))


def _gravity(model: Model) -> ca.SX:
    """Declare the gravitational acceleration."""
    return model.parameter("gravity", 0.0, unit="m/s2", description="Gravitational acceleration along -x2")


def _coulomb_velocity(model: Model) -> ca.SX:
    """Declare the joint rate that smooths Coulomb friction."""
    return model.parameter(
        "coulomb_velocity",
        start.COULOMB_VELOCITY,
        unit="rad/s",
        display_unit=RATE,
        limits=POSITIVE,
        description="Joint rate over which Coulomb friction changes sign (tanh)",
    )
