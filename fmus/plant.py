"""Plant: a robot arm, eq. (1), whose tip touches a compliant wall, or two walls that make a corner.

    H(q) ddq + C(q, dq) dq + g(q) + f(dq) = tau - J' F_ext

States are q and dq. Contact begins and ends at located events, so the integrator never steps
across the corner of the contact force. Equations: `fmus.mechanics.planar_arm`, `fmus.environment.contact`.

F_ext is the sum of the forces on all walls. Each wall has contact events of its own. Where two walls are, the names of
the second wall's variables are those of the first wall with a 2 at the end.

The variant PlantWristPayload says what a sensor at the wrist measures, F_wrist, if a part of the last mass sits beyond
the sensor (`fmus.mechanics.payload`).
"""

from collections.abc import Callable, Mapping
from functools import reduce
from operator import add

import casadi as ca

from adaptimp_fmu import ContinuousModel, DefinitionError, Formula, Formulas
from fmus.drawings.loop import PLANT
from fmus.elements import ACCELERATION, ANGLE, LENGTH, RATE, SPACE, along, of_task, of_wrench
from fmus.environment.contact import Wall, declare_wall
from fmus.environment.contact_point import ContactPoint
from fmus.environment.half_space import ordinal, suffix
from fmus.mechanics.algebra import solve_spd
from fmus.mechanics.arm import ArmModel
from fmus.mechanics.payload import declare_payload, force_on_payload
from fmus.mechanics.planar_model import PlanarArmModel
from fmus.mechanics.spatial_model import SpatialArmModel
from fmus.mechanics.task import Task
from fmus.project import TIP, group_signals, publish, publish_in_space
from fmus.robots.planar_robot import PlanarRobot
from fmus.robots.robot import Robot
from fmus.spatial_plant import MODULES, SpatialPlant

FORMULAS = Formulas(
    "Motion of the arm",
    [
        Formula(
            r"H(q)\,\ddot{q} + C(q, \dot{q})\,\dot{q} + g(q) + f(\dot{q}) = \tau - J(q)^{T} F_{\text{ext}}",
            "The torques of the joints move the arm, and the contact force at the tip acts back.",
            "1",
        ),
        Formula(
            r"f_i = v_i\,\dot{q}_i + c_i\,\tanh\frac{\dot{q}_i}{\omega_c}",
            "Friction of joint i has the coefficients v (viscous) and c (coulomb), and the width coulomb_velocity.",
        ),
    ],
)


def plant(robot: Robot | None = None, name: str = "Plant", walls: int = 1, *, wrist: bool = False) -> ContinuousModel:
    """Declare the model of a robot, by default the paper's, with one wall or with two.

    With `wrist` a part of the last mass may sit beyond a sensor at the wrist. An arm in space always has such a sensor.

    Raises
    ------
    DefinitionError
        If the wrist's force is wanted of a robot in the plane whose task is not a position.

    Examples
    --------
    >>> from adaptimp_fmu import build
    >>> from fmus.plant import plant
    >>> from fmus.robots.planar_robot import PlanarRobot
    >>> build(plant(PlanarRobot(3), "Arm3")).name  # an arm of three joints
    'Arm3.fmu'
    """
    robot = robot or PlanarRobot()
    place = {1: "against a compliant wall", 2: "in a corner of two compliant walls"}[walls]
    aims = "; position and angle of its tip are the task" if robot.task.angles else ""
    model = ContinuousModel(name, f"{robot.title} {place}{aims}", dt_max=robot.dt_max)
    task = robot.task
    _document(model, robot, walls, wrist=wrist)
    tau, q_start, dq_start = _declare_joints(model, robot)
    arm, p = robot.declare_true(model)
    beyond = _declare_payload(model, robot, arm, p) if wrist and not isinstance(arm, SpatialArmModel) else None
    touched = {k: declare_wall(model, k, task.positions, robot.place_of_wall(k)) for k in range(1, walls + 1)}

    q, dq = model.state("q", q_start), model.state("dq", dq_start)
    x = arm.forward_kinematics(q)
    J = arm.jacobian(q)
    dx = ca.mtimes(J, dq)
    if isinstance(arm, SpatialArmModel):
        space = SpatialPlant.declare(model, arm, robot, (q, dq), q_start)
        point, torque = space.point, tau + space.tau_stop
    else:
        space, torque = None, tau
        point = ContactPoint(x[: task.positions], dx[: task.positions], angles=task.angles)
    forces = {number: _force(model, wall, point, number) for number, wall in touched.items()}
    F_ext = point.wrench(reduce(add, forces.values()))
    ddq = solve_spd(arm.inertia(q, p), torque - arm.bias(q, dq, p) - arm.wrench_torque(q, F_ext))
    model.derivative(q, dq)
    model.derivative(dq, ddq)

    _show_motion(model, robot, (q, dq, ddq), (x, dx))
    texts = of_wrench("Force of the tip on the wall", "Moment of the tip on the wall", task)
    model.output("F_ext", F_ext, unit=task.each("N", "N.m"), description=texts)
    if space is not None:
        space.show(model, F_ext, p, ddq)
    if beyond is not None:
        ddx = ca.mtimes(J, ddq) + ca.mtimes(arm.jacobian_rate(q, dq), dq)
        texts = along("Force of the arm on what is beyond the wrist sensor")
        model.output("F_wrist", beyond(F_ext, ddx), unit="N", description=texts)
    _show_walls(model, touched, forces, point)
    group_signals(model, None if space is None else TIP)
    return model


def _document(model: ContinuousModel, robot: Robot, walls: int, *, wrist: bool) -> None:
    """Give a plant its icon, its drawing, and the modules whose docstrings have its equations."""
    if robot.task.positions == SPACE:
        environment = [*MODULES, "fmus.environment.half_space"]
    else:
        payload = ["fmus.mechanics.payload"] if wrist else []
        environment = ["fmus.environment.contact", "fmus.environment.half_space", *payload]
    icon, drawing = robot.icon(corner=walls > 1), robot.drawing(walls)
    publish(model, icon, PLANT, [drawing], __name__, *robot.modules, *environment, "fmus")
    if robot.task.positions == SPACE:
        publish_in_space(model, PLANT)


def _declare_payload(model: ContinuousModel, robot: Robot, arm: ArmModel, p: ca.SX) -> Callable[[ca.SX, ca.SX], ca.SX]:
    """Declare what is beyond the wrist sensor; returns the force on it, N, shape (2,), of F_ext and ddx."""
    if not isinstance(arm, PlanarArmModel) or robot.task != Task():
        msg = (
            f"{model.name}: the force at the wrist is known of planar arms with a task of two positions only; leave"
            " wrist out."
        )
        raise DefinitionError(msg)
    payload, gravity = declare_payload(model, p[robot.n - 1]), arm.gravity
    return lambda F_ext, ddx: force_on_payload(payload, F_ext, ddx, gravity)


def _declare_joints(model: ContinuousModel, robot: Robot) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Declare what the joints do: the torques tau, and q and dq at the start; shape (n,) each."""
    joints, begin = robot.joints, robot.start
    tau = model.input("tau", [0.0] * robot.n, unit=joints.each("N.m", "N"), description=joints.texts("Torque", "Force"))
    q_start = model.parameter(
        "q_start",
        begin.q,
        unit=joints.each("rad", "m"),
        display_unit=joints.each(ANGLE, LENGTH),
        description=joints.texts("Angle at the start", "Position at the start"),
    )
    dq_start = model.parameter(
        "dq_start",
        begin.dq,
        unit=joints.each("rad/s", "m/s"),
        display_unit=joints.each(RATE, ""),
        description=joints.texts("Rate at the start"),
    )
    return tau, q_start, dq_start


def _show_motion(
    model: ContinuousModel, robot: Robot, motion: tuple[ca.SX, ca.SX, ca.SX], tip: tuple[ca.SX, ca.SX]
) -> None:
    """Declare the outputs that tell how the arm moves: q, dq, ddq of the joints, and x, dx of the tip."""
    joints, task = robot.joints, robot.task
    for name, value, per, shown, what, of_slide in (
        ("q", motion[0], "", (ANGLE, LENGTH), "Angle", "Position"),
        ("dq", motion[1], "/s", (RATE, ""), "Rate", ""),
        ("ddq", motion[2], "/s2", (ACCELERATION, ""), "Acceleration", ""),
    ):
        said = list(joints.texts(what, of_slide))
        if name == "q" and task.positions < SPACE:
            said = [said[0] + ", from x1", *(f"{text}, from the previous link" for text in said[1:])]
        if name == "ddq":
            said = [f"{text}; at a communication point its left limit" for text in said]
        units, displayed = joints.each(f"rad{per}", f"m{per}"), joints.each(*shown)
        model.output(name, value, unit=units, display_unit=displayed, description=said)
    texts = of_task("Position of the tip", task, "Angle of the tip")
    model.output("x", tip[0], unit=task.each("m", "rad"), description=texts)
    turning = "Angular velocity of the tip" if task.angles == 1 else "Rate of the tip's angle"
    texts = of_task("Velocity of the tip", task, turning)
    model.output("dx", tip[1], unit=task.each("m/s", "rad/s"), description=texts)


def _force(model: ContinuousModel, wall: Wall, point: ContactPoint, number: int) -> ca.SX:
    """Declare the contact events of a wall; returns the force of the point on the wall, N, of its shape."""
    in_contact = model.event(f"contact{suffix(number)}", wall.gap(point.position))
    pushing = model.event(f"pushing{suffix(number)}", wall.damping_factor(point.velocity))
    return wall.force(point.position, point.velocity, in_contact, pushing)


def _show_walls(
    model: ContinuousModel, walls: Mapping[int, Wall], forces: Mapping[int, ca.SX], point: ContactPoint
) -> None:
    """Declare the outputs that tell how deep the tip lies in each wall, and where there are two, the force on each."""
    for number, wall in walls.items():
        _show_depth(model, wall.gap(point.position), number, point.name)
    if len(walls) > 1:
        for number, force in forces.items():
            text = f"Force of the tip on the {'first wall' if number == 1 else ordinal(number)}"
            texts = along(text, point.position.numel())
            model.output(f"F_wall{suffix(number)}", force, unit="N", description=texts)


def _show_depth(model: ContinuousModel, gap: ca.SX, number: int, point: str) -> None:
    """Declare the outputs that tell how deep a point lies in a wall."""
    end, wall = suffix(number), ordinal(number)
    model.output(
        f"gap{end}",
        gap,
        unit="m",
        display_unit=LENGTH,
        description=f"Signed depth of the {point} in the {wall}, n.x - wall_offset{end}",
        scalar=True,
    )
    model.output(
        f"penetration{end}",
        ca.fmax(gap, 0),
        unit="m",
        display_unit=LENGTH,
        description=f"Depth of the {point} in the {wall}, 0 outside",
        scalar=True,
    )
