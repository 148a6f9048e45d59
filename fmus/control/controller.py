"""What all controllers share: inputs, outputs, a model of the arm, and the reference trajectory of eq. (11).

A controller's outputs are those of a tick: e = x - x_t, the torque, p_hat and x_t are shown before
the states advance to the next tick.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca

from adaptimp_fmu import ANY, NOT_NEGATIVE, POSITIVE, DefinitionError, Drawing, SampledModel
from fmus.control.full_tirt import LARGEST_NORM, FullImpedance, companion, row_norm
from fmus.control.gains import declare_gain, require_definite
from fmus.control.impedance import ArmEstimate, Measured
from fmus.control.joint_limits import declare_repulsion
from fmus.control.tirt import Impedance
from fmus.drawings.characteristics import impedance as drawn_impedance
from fmus.elements import ACCELERATION, ANGLE, LENGTH, RATE, of_axes, of_task, of_wrench
from fmus.mechanics.algebra import factors_spd
from fmus.mechanics.arm import ArmModel
from fmus.mechanics.orientation import rotation
from fmus.mechanics.spatial_model import SpatialArmModel
from fmus.mechanics.task import Task
from fmus.mechanics.turned_task import TurnedTask
from fmus.project import group_signals
from fmus.robots.planar_robot import PlanarRobot
from fmus.robots.robot import Robot

EQUATIONS = (
    "fmus.control.controller",
    "fmus.control.impedance",
    "fmus.control.tirt",
)
"""Modules with the equations that every controller shares, for its documentation; those of the robot follow."""


IN_SPACE = ("fmus.mechanics.turned_task", "fmus.control.joint_limits")
"""Further modules with equations of every controller of an arm in space."""
TURNS = ("Roll", "Pitch", "Yaw")


@dataclass(frozen=True)
class Controller:
    """A controller that is being declared: its model, and the symbols that every control law uses.

    Vectors of the task are in the axes of the gains. In space `in_base` turns them to those of the base.

    Attributes
    ----------
    ddq
        Measured joint acceleration, rad/s2, shape (n,).
    virtual
        x_v, dx_v, ddx_v, shape (m,) each.
    p_start
        Parameters of the arm that the controller starts from, shape (r,).
    x, dx
        Task coordinates and their rates by the arm's kinematics, shape (m,).
    x_t, dx_t
        State of the TIRT, shape (m,).
    repulsion
        Torque that keeps the joints from the ends of their ranges, N.m, shape (n,); None for an arm in the plane.
    """

    model: SampledModel
    robot: Robot
    arm: ArmModel
    measured: Measured
    ddq: ca.SX
    virtual: tuple[ca.SX, ca.SX, ca.SX]
    impedance: Impedance | FullImpedance
    p_start: ca.SX
    x: ca.SX
    dx: ca.SX
    x_t: ca.SX
    dx_t: ca.SX
    repulsion: ca.SX | None = None

    @property
    def modules(self) -> Sequence[str]:
        """Names of the modules with the equations that every controller of such a robot shares, for documentation."""
        return [*EQUATIONS, *(IN_SPACE if self.robot.task.in_space else ()), *self.robot.modules, "fmus"]

    def in_base(self, v: ca.SX) -> ca.SX:
        """A vector of the task in the axes of the base, of the shape of v, (m,)."""
        return self.arm.in_base(v) if isinstance(self.arm, TurnedTask) else v

    @property
    def e(self) -> ca.SX:
        """Regression error x - x_t, m or rad, shape (m,)."""
        return self.x - self.x_t

    @property
    def units_of_p(self) -> list[str]:
        """Units of p, shape (r,)."""
        return [parameter.unit for parameter in self.robot.parameters]

    def texts_of_p(self, attribute: str) -> list[str]:
        """Descriptions of the elements of p, beginning with `attribute`, shape (r,)."""
        return [f"{attribute} {parameter.text}" for parameter in self.robot.parameters]

    def with_parameters(self, p: ca.SX) -> ArmEstimate:
        """The arm with parameters p, shape (r,)."""
        return ArmEstimate(self.arm, p)

    @property
    def full(self) -> bool:
        """Whether the gains are full matrices."""
        return isinstance(self.impedance, FullImpedance)

    def require_invertible(self, name: str, H: ca.SX, masses: str, advice: str) -> None:
        """Demand that an inertia which the law inverts is not singular.

        Parameters
        ----------
        name, H
            The inertia and its name, kg.m2, shape (n, n).
        masses
            Name of the variable whose first elements are the masses, or other inertial parameters, in H.
        advice
            What the user is to do, for the message.
        """
        inertial = [unit for unit in self.units_of_p if unit.startswith("kg")]
        what = "masses" if set(inertial) == {"kg"} else "inertial parameters"
        sentence = (
            f"{name} is singular because of the {what} {masses}[1] to {masses}[{len(inertial)}], and the control law"
            f" needs its inverse; {advice}. Size of a pivot of {name}, kg.m2"
        )
        _, pivots = factors_spd(H)
        for pivot in pivots:
            self.model.require(ca.fabs(pivot), sentence)

    def finish(self, tau_cmd: ca.SX, p_hat: ca.SX) -> SampledModel:
        """Declare the common outputs and the terminals, let the TIRT advance, and return the model."""
        model, task = self.model, self.arm.task
        if self.repulsion is not None:
            tau_cmd = tau_cmd + self.repulsion
        joints = self.robot.joints
        commanded = joints.texts("Commanded torque", "Commanded force")
        model.output("tau_cmd", tau_cmd, unit=joints.each("N.m", "N"), description=commanded)
        text = "Target-impedance reference trajectory, eq. (11),"
        model.output("x_t", self.in_base(self.x_t), unit=task.each("m", "rad"), description=of_task(text, task))
        of_rate = of_task("Rate of x_t", task)
        model.output("dx_t", self.in_base(self.dx_t), unit=task.each("m/s", "rad/s"), description=of_rate)
        model.output(
            "e",
            self.in_base(self.e),
            unit=task.each("m", "rad"),
            display_unit=task.each(LENGTH, ANGLE),
            description=of_task("Regression error x - x_t", task),
        )
        model.output("p_hat", p_hat, unit=self.units_of_p, description=self.texts_of_p("Estimated"))
        x_t, dx_t = self.impedance.advance(self.x_t, self.dx_t, self.virtual, self.measured.F_hat, model.period)
        model.update(self.x_t, x_t)
        model.update(self.dx_t, dx_t)
        group_signals(model)
        return model


def declare_controller(name: str, description: str, robot: Robot | None = None, *, full: bool = False) -> Controller:
    """Declare a controller of a robot, by default of the paper's: the common inputs, parameters and TIRT.

    With `full` the gains are symmetric positive definite matrices; else they are diagonal.

    Raises
    ------
    DefinitionError
        If gains are to be full where coordinates are angles.
    """
    robot = robot or PlanarRobot()
    _require_diagonal_gains_of_angles(name, robot.task, full=full)
    whose = ", for positions and angles of the tip" if robot.task.angles else ""
    model = SampledModel(name, f"{description}{', with full matrices' if full else ''}{whose}")
    measured, ddq = _declare_measurements(model, robot)
    virtual = _declare_virtual(model, robot)
    impedance = _impedance(model, robot.task, full=full)
    arm = robot.declare_known(model)
    if isinstance(arm, SpatialArmModel):
        arm = replace(arm, wanted=virtual[0][robot.task.positions :])  # else e jumps by a full turn at 180 deg
        arm = TurnedTask(arm, rotation(_declare_task_axes(model)))
        virtual = arm.in_task(virtual[0]), arm.in_task(virtual[1]), arm.in_task(virtual[2])
    measured = replace(measured, F_hat=arm.wrench_force(measured.q, measured.F_hat))
    p_start = model.parameter(
        "p_start",
        robot.p_start,
        unit=[parameter.unit for parameter in robot.parameters],
        limits=ANY if any(parameter.signed for parameter in robot.parameters) else NOT_NEGATIVE,
        description=[f"Assumed {parameter.text}" for parameter in robot.parameters],
    )
    for demand in arm.demands(measured.q):
        model.require(demand.value, demand.sentence)
    limits = declare_repulsion(model, robot.joints) if robot.task.in_space else None
    return Controller(
        model=model,
        robot=robot,
        arm=arm,
        measured=measured,
        ddq=ddq,
        virtual=virtual,
        impedance=impedance,
        p_start=p_start,
        x=arm.forward_kinematics(measured.q),
        dx=ca.mtimes(arm.jacobian(measured.q), measured.dq),
        x_t=model.state("x_t", virtual[0]),
        dx_t=model.state("dx_t", virtual[1]),
        repulsion=None if limits is None else limits.torque(measured),
    )


def require_square(controller: Controller, law: str) -> None:
    """Refuse a redundant arm for a law that needs the inverse of J.

    Raises
    ------
    DefinitionError
        If the arm has another number of joints than of task coordinates.
    """
    n, m = controller.arm.n, controller.arm.task.size
    if n != m:
        msg = (
            f"{controller.model.name}: {law} needs as many joints as task coordinates, since the paper derives it with"
            f" the inverse of J; the arm has {n} joints and {m} task coordinates. Use HoganImpedance, form (5),"
            " SlotineLiAdaptiveImpedance, which goes beyond the paper here, or another task."
        )
        raise DefinitionError(msg)


def drawings(robot: Robot) -> list[Drawing]:
    """Draw what the variables of every controller mean: the target impedance, and the frames of the arm."""
    return [drawn_impedance(), robot.drawing()]


def _declare_measurements(model: SampledModel, robot: Robot) -> tuple[Measured, ca.SX]:
    """Declare the inputs that sensors give: q, dq, F_hat, and ddq beside them."""
    joints, begin, task = robot.joints, robot.start, robot.task
    q, dq, ddq = (
        model.input(
            name,
            value,
            unit=joints.each(f"rad{per}", f"m{per}"),
            display_unit=joints.each(*shown),
            description=joints.texts(text, of_slide),
        )
        for name, value, per, shown, text, of_slide in (
            ("q", begin.q, "", (ANGLE, LENGTH), "Angle", "Position"),
            ("dq", begin.dq, "/s", (RATE, ""), "Rate", ""),
            ("ddq", begin.ddq, "/s2", (ACCELERATION, ""), "Acceleration", ""),
        )
    )
    texts = of_wrench("Measured force of the tip on the wall", "Measured moment of the tip on the wall", task)
    F_hat = model.input("F_hat", [0.0] * task.size, unit=task.each("N", "N.m"), description=texts)
    return Measured(q, dq, F_hat), ddq


def _declare_virtual(model: SampledModel, robot: Robot) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Declare the inputs x_v, dx_v and ddx_v."""
    begin, task = robot.start, robot.task
    # The rates of roll, pitch and yaw are no angular velocity.
    rate, second = (
        ("rate", "acceleration of the angle") if task.in_space else ("angular velocity", "angular acceleration")
    )
    x_v, dx_v, ddx_v = (
        model.input(
            name,
            value,
            unit=task.each(f"m{per}", f"rad{per}"),
            description=of_task(f"Virtual {text} of the tip", task, f"Virtual {turning} of the tip"),
        )
        for name, value, per, text, turning in (
            ("x_v", begin.x_v, "", "position", "angle"),
            ("dx_v", begin.dx_v, "/s", "velocity", rate),
            ("ddx_v", begin.ddx_v, "/s2", "acceleration", second),
        )
    )
    return x_v, dx_v, ddx_v


def _declare_task_axes(model: SampledModel) -> ca.SX:
    """Declare the axes of the gains: roll, pitch and yaw, rad, shape (3,), from the axes of the base."""
    return model.parameter(
        "task_rpy",
        [0.0] * len(TURNS),
        unit="rad",
        display_unit=ANGLE,
        description=[
            f"{turn} of the axes of the task, which gains are along, from those of the base" for turn in TURNS
        ],
    )


def _require_diagonal_gains_of_angles(name: str, task: Task, *, full: bool) -> None:
    """Refuse full gains between positions and angles."""
    if full and task.angles:
        msg = (
            f"{name}: full gains are for tasks of positions, and this task has {task.angles} of {task.size} coordinates"
            " in rad; use diagonal gains. A symmetric Psi between metres and radians has no meaning."
        )
        raise DefinitionError(msg)


def _impedance(model: SampledModel, task: Task, *, full: bool) -> Impedance | FullImpedance:
    """Declare the target impedance, eq. (3).

    Assumed: that of angles is that of positions times (0.15 m)^2, so that all coordinates move alike.
    """
    declarations = {
        "M": (2.0, "kg", 0.045, "kg.m2", "Target inertia"),
        "B": (340.0, "N.s/m", 7.65, "N.m.s/rad", "Target damping"),
        "K": (4000.0, "N/m", 90.0, "N.m/rad", "Target stiffness"),
    }
    M, B, K = (
        declare_gain(
            model,
            name,
            [value] * task.positions + [turned] * task.angles,
            full=full,
            unit=unit if full else task.each(unit, turning),
            limits=POSITIVE,
            description=of_axes(text, task, full=full),
        )
        for name, (value, unit, turned, turning, text) in declarations.items()
    )
    if not full:
        return Impedance(M, B, K)
    for name, matrix in zip(declarations, (M, B, K), strict=True):
        require_definite(model, matrix, f"{name} must be positive definite")
    impedance = FullImpedance(M, B, K)
    model.require(
        LARGEST_NORM - row_norm(companion(impedance.b, impedance.k, model.period)),
        "sample_time is too long for the target impedance: no row of (sample_time^2 M^-1 K, sample_time M^-1 B) may"
        f" sum up to {LARGEST_NORM:.0f} or more; shorten sample_time, or reduce B and K",
    )
    return impedance
