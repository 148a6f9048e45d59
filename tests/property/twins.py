"""Two planar arms with tasks of position and angle as one robot of six joints and six task coordinates.

Task coordinates are both positions, and after them both angles. Every matrix of the pair is made of those of the two
arms, so that what a law does with six coordinates can be compared with what it does with three.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, Drawing, Icon, Model
from fmus import icons, start
from fmus.mechanics.arm import ArmParameter, Demand
from fmus.mechanics.joints import Joints
from fmus.mechanics.planar_model import PlanarArmModel
from fmus.mechanics.task import Task
from fmus.robots.planar_robot import PlanarRobot
from fmus.start import MotionStart

ONE = PlanarRobot(3, pose=True)
FIRST, SECOND = (0, 1, 4), (2, 3, 5)
"""Task coordinates of the two arms."""


@dataclass(frozen=True)
class TwinModel:
    """Equations of the pair; see `fmus.mechanics.arm.ArmModel`."""

    arms: tuple[PlanarArmModel, PlanarArmModel]

    n = 6
    task = Task(positions=4, angles=2)
    parameters: Sequence[ArmParameter] = (*ONE.parameters, *ONE.parameters)

    def forward_kinematics(self, q: ca.SX) -> ca.SX:
        """Task coordinates x."""
        return _ordered(ca.vertcat(*(arm.forward_kinematics(part) for arm, part in self._parts(q))))

    def jacobian(self, q: ca.SX) -> ca.SX:
        """Jacobian J."""
        return _ordered(ca.diagcat(*(arm.jacobian(part) for arm, part in self._parts(q))))

    def jacobian_rate(self, q: ca.SX, dq: ca.SX) -> ca.SX:
        """Time derivative of the Jacobian."""
        return _ordered(ca.diagcat(*(arm.jacobian_rate(*parts) for arm, *parts in self._parts(q, dq))))

    def wrench_force(self, q: ca.SX, wrench: ca.SX) -> ca.SX:
        """The wrench itself."""
        del q
        return wrench

    def wrench_torque(self, q: ca.SX, wrench: ca.SX) -> ca.SX:
        """Torques J' F."""
        return ca.mtimes(self.jacobian(q).T, wrench)

    def wrench_gain(self, q: ca.SX) -> ca.SX:
        """Factor of errors."""
        del q
        return ca.SX(1)

    def inertia(self, q: ca.SX, p: ca.SX) -> ca.SX:
        """Inertia matrix H."""
        return ca.diagcat(*(arm.inertia(*parts) for arm, *parts in self._parts(q, p)))

    def bias(self, q: ca.SX, dq: ca.SX, p: ca.SX) -> ca.SX:
        """Torque C dq + g + f."""
        return ca.vertcat(*(arm.bias(*parts) for arm, *parts in self._parts(q, dq, p)))

    def inverse_dynamics(self, q: ca.SX, dq: ca.SX, v: ca.SX, a: ca.SX, p: ca.SX) -> ca.SX:
        """Torque H a + C v + g + f."""
        return ca.vertcat(*(arm.inverse_dynamics(*parts) for arm, *parts in self._parts(q, dq, v, a, p)))

    def regressor(self, q: ca.SX, dq: ca.SX, v: ca.SX, a: ca.SX) -> ca.SX:
        """Regressor Y."""
        return ca.diagcat(*(arm.regressor(*parts) for arm, *parts in self._parts(q, dq, v, a)))

    def demands(self, q: ca.SX) -> Sequence[Demand]:
        """Conditions of both arms."""
        return [demand for arm, part in self._parts(q) for demand in arm.demands(part)]

    def _parts(self, *vectors: ca.SX) -> list[list]:
        """Each arm with its halves of the vectors."""
        halves = [ca.vertsplit(vector, vector.shape[0] // 2) for vector in vectors]
        return [[arm, *(half[i] for half in halves)] for i, arm in enumerate(self.arms)]


@dataclass(frozen=True)
class TwinRobot:
    """The pair with start values; see `fmus.robots.robot.Robot`."""

    n = 6
    task = TwinModel.task
    joints = Joints.numbered(6)
    dt_max = ONE.dt_max
    parameters: Sequence[ArmParameter] = (*ONE.parameters, *ONE.parameters)
    p_start: Sequence[float] = (*ONE.p_start, *ONE.p_start)
    uncertain: Sequence[bool] = (*ONE.uncertain, *ONE.uncertain)
    title = "Two planar arms"
    modules = ("fmus.mechanics.planar_arm",)

    @property
    def start(self) -> MotionStart:
        """Both arms at the start of one arm."""
        one = ONE.start
        joints = {name: 2 * getattr(one, name) for name in ("q", "dq", "ddq")}
        task = {name: 2 * getattr(one, name)[:2] + 2 * getattr(one, name)[2:] for name in ("x_v", "dx_v", "ddx_v")}
        return MotionStart(**joints, **task)

    def place_of_wall(self, number: int) -> tuple[Sequence[float], float]:
        """Start values of a wall: its unit normal, and the distance of its surface, m."""
        return [*start.WALL_NORMALS[number], 0.0, 0.0], start.WALL_OFFSETS[number]

    def icon(self, *, corner: bool = False) -> Icon:
        """Icon of one arm."""
        return icons.arm(ONE.n, corner=corner)

    def drawing(self, walls: int = 1) -> Drawing:
        """Draw one arm."""
        return ONE.drawing(walls)

    def declare_known(self, model: Model) -> TwinModel:
        """Declare lengths of both arms, a gravity and a velocity of friction."""
        lengths = 2 * ONE.start.link_lengths
        l = model.parameter("l", lengths, unit="m", limits=POSITIVE, description="Length of a link")
        gravity = model.parameter("gravity", 0.0, unit="m/s2", description="Gravitational acceleration")
        velocity = model.parameter("coulomb_velocity", 0.1, unit="rad/s", limits=POSITIVE, description="Joint rate")
        first, second = (PlanarArmModel(ONE.arm, part, gravity, velocity) for part in (l[:3], l[3:]))
        return TwinModel((first, second))

    def declare_true(self, model: Model) -> tuple[TwinModel, ca.SX]:
        """Declare the numbers of a plant."""
        units = [parameter.unit for parameter in self.parameters]
        p = model.parameter("p", self.p_start, unit=units, limits=NOT_NEGATIVE, description="Parameter of an arm")
        return self.declare_known(model), p


def _ordered(rows: ca.SX) -> ca.SX:
    """Rows of the first arm and of the second one in the order of the pair's task coordinates."""
    order = [0, 1, 3, 4, 2, 5]
    return rows[order, :]
