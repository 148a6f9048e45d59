"""Plant: a robot arm, eq. (1), whose tip touches a compliant wall, or two walls that make a corner.

    H(q) ddq + C(q, dq) dq + g(q) + f(dq) = tau - J' F_ext

States are q and dq. Contact begins and ends at located events, so the integrator never steps
across the corner of the contact force. Equations: `fmus.mechanics.planar_arm`, `fmus.environment.contact`.

F_ext is the sum of the forces on all walls. Each wall has contact events of its own. Where two walls are, the names of
the second wall's variables are those of the first wall with a 2 at the end.

The variant PlantWristPayload says what a sensor at the wrist measures, F_wrist, if a part of the last mass sits beyond
the sensor (`fmus.mechanics.payload`).
"""

from functools import reduce
from operator import add

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, ContinuousModel, Formula, Formulas
from fmus import icons, start
from fmus.drawings.arm import arm as drawn_arm
from fmus.drawings.loop import PLANT
from fmus.elements import ACCELERATION, ANGLE, LENGTH, RATE, along, of_joints, of_links
from fmus.environment.contact import Wall
from fmus.environment.half_space import declare_half_space, ordinal, suffix
from fmus.mechanics.algebra import solve_spd
from fmus.mechanics.arm import Arm
from fmus.mechanics.payload import declare_payload, force_on_payload
from fmus.mechanics.planar_arm import PlanarArm
from fmus.project import group_signals, publish

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


def plant(n: int = 2, name: str = "Plant", walls: int = 1, *, wrist: bool = False) -> ContinuousModel:
    """Declare the model of an arm of n joints, by default the paper's, with one wall or with two.

    With `wrist` a part of the last mass may sit beyond a sensor at the wrist.

    Examples
    --------
    >>> from adaptimp_fmu import build
    >>> from fmus.plant import plant
    >>> build(plant(3, "Arm3")).name  # an arm of three joints
    'Arm3.fmu'
    """
    place = {1: "against a compliant wall", 2: "in a corner of two compliant walls"}[walls]
    model = ContinuousModel(name, f"Planar arm with point masses {place}")
    publish(
        model,
        icons.arm(n, corner=walls > 1),
        PLANT,
        [drawn_arm(n, walls)],
        __name__,
        "fmus.mechanics.planar_arm",
        "fmus.environment.contact",
        "fmus.environment.half_space",
        *(["fmus.mechanics.payload"] if wrist else []),
        "fmus",
    )
    arm: Arm = PlanarArm(n)
    begin = start.ARMS[n]
    tau = model.input("tau", [0.0] * arm.n, unit="N.m", description=of_joints("Torque", arm.n))
    q_start = model.parameter(
        "q_start", begin.q, unit="rad", display_unit=ANGLE, description=of_joints("Angle at the start", arm.n)
    )
    dq_start = model.parameter(
        "dq_start", begin.dq, unit="rad/s", display_unit=RATE, description=of_joints("Rate at the start", arm.n)
    )
    m = model.parameter(
        "m", begin.masses, unit="kg", limits=POSITIVE, description=of_links("Point mass at the end", arm.n)
    )
    l = model.parameter("l", begin.link_lengths, unit="m", limits=POSITIVE, description=of_links("Length", arm.n))
    viscous = model.parameter(
        "viscous",
        [0.0] * arm.n,
        unit="N.m.s/rad",
        limits=NOT_NEGATIVE,
        description=of_joints("Coefficient of viscous friction", arm.n),
    )
    coulomb = model.parameter(
        "coulomb",
        [0.0] * arm.n,
        unit="N.m",
        limits=NOT_NEGATIVE,
        description=of_joints("Coulomb friction torque", arm.n),
    )
    coulomb_velocity = model.parameter(
        "coulomb_velocity",
        start.COULOMB_VELOCITY,
        unit="rad/s",
        display_unit=RATE,
        limits=POSITIVE,
        description="Joint rate over which Coulomb friction changes sign (tanh)",
    )
    gravity = model.parameter("gravity", 0.0, unit="m/s2", description="Gravitational acceleration along -x2")
    payload = declare_payload(model, m[n - 1]) if wrist else None
    touched = {number: _wall(model, number) for number in range(1, walls + 1)}

    q, dq = model.state("q", q_start), model.state("dq", dq_start)
    x = arm.forward_kinematics(q, l)
    J = arm.jacobian(q, l)
    dx = ca.mtimes(J, dq)
    forces = {number: _force(model, wall, x, dx, number) for number, wall in touched.items()}
    F_ext = reduce(add, forces.values())
    bias = (
        ca.mtimes(arm.coriolis(q, dq, m, l), dq)
        + arm.gravity_torque(q, m, l, gravity)
        + _friction(arm, dq, viscous, coulomb, coulomb_velocity)
    )
    ddq = solve_spd(arm.inertia(q, m, l), tau - bias - ca.mtimes(J.T, F_ext))
    model.derivative(q, dq)
    model.derivative(dq, ddq)

    _show_motion(model, arm, (q, dq, ddq), (x, dx))
    model.output("F_ext", F_ext, unit="N", description=along("Force of the tip on the wall"))
    if payload is not None:
        ddx = ca.mtimes(J, ddq) + ca.mtimes(arm.jacobian_rate(q, dq, l), dq)
        F_wrist = force_on_payload(payload, F_ext, ddx, gravity)
        model.output(
            "F_wrist", F_wrist, unit="N", description=along("Force of the arm on what is beyond the wrist sensor")
        )
    for number, wall in touched.items():
        _show_depth(model, wall.gap(x), number)
    if walls > 1:
        for number, force in forces.items():
            text = f"Force of the tip on the {'first wall' if number == 1 else ordinal(number)}"
            model.output(f"F_wall{suffix(number)}", force, unit="N", description=along(text))
    group_signals(model)
    return model


def _show_motion(
    model: ContinuousModel, arm: Arm, joints: tuple[ca.SX, ca.SX, ca.SX], tip: tuple[ca.SX, ca.SX]
) -> None:
    """Declare the outputs that tell how the arm moves: q, dq, ddq of the joints, and x, dx of the tip."""
    for name, value, unit, shown, what in (
        ("q", joints[0], "rad", ANGLE, "Angle"),
        ("dq", joints[1], "rad/s", RATE, "Rate"),
        ("ddq", joints[2], "rad/s2", ACCELERATION, "Acceleration"),
    ):
        said = of_joints(what, arm.n)
        if name == "q":
            said = [said[0] + ", from x1", *(f"{text}, from the previous link" for text in said[1:])]
        if name == "ddq":
            said = [f"{text}; at a communication point its left limit" for text in said]
        model.output(name, value, unit=unit, display_unit=shown, description=said)
    model.output("x", tip[0], unit="m", description=along("Position of the tip"))
    model.output("dx", tip[1], unit="m/s", description=along("Velocity of the tip"))


def _force(model: ContinuousModel, wall: Wall, x: ca.SX, dx: ca.SX, number: int) -> ca.SX:
    """Declare the contact events of a wall; returns the force of the tip on the wall, N, shape (2,)."""
    in_contact = model.event(f"contact{suffix(number)}", wall.gap(x))
    pushing = model.event(f"pushing{suffix(number)}", wall.damping_factor(dx))
    return wall.force(x, dx, in_contact, pushing)


def _show_depth(model: ContinuousModel, gap: ca.SX, number: int) -> None:
    """Declare the outputs that tell how deep the tip lies in a wall."""
    end, wall = suffix(number), ordinal(number)
    model.output(
        f"gap{end}",
        gap,
        unit="m",
        display_unit=LENGTH,
        description=f"Signed depth of the tip in the {wall}, n.x - wall_offset{end}",
        scalar=True,
    )
    model.output(
        f"penetration{end}",
        ca.fmax(gap, 0),
        unit="m",
        display_unit=LENGTH,
        description=f"Depth of the tip in the {wall}, 0 outside",
        scalar=True,
    )


def _friction(arm: Arm, dq: ca.SX, viscous: ca.SX, coulomb: ca.SX, coulomb_velocity: ca.SX) -> ca.SX:
    """The arm's friction torque, N.m; without Coulomb friction a joint's tanh is that of 0, which costs nothing."""
    none = ca.SX.zeros(arm.n, 1)
    rubbing = ca.if_else(coulomb > 0, dq, 0)
    return arm.friction_torque(dq, viscous, none, coulomb_velocity) + arm.friction_torque(
        rubbing, none, coulomb, coulomb_velocity
    )


def _wall(model: ContinuousModel, number: int) -> Wall:
    """Declare the parameters of a wall; those of a second wall end with a 2."""
    end, wall = suffix(number), ordinal(number)
    half_space = declare_half_space(model, number)
    K_f = model.parameter(f"K_f{end}", 1e5, unit="N/m", limits=NOT_NEGATIVE, description=f"Stiffness of the {wall}")
    D_f = model.parameter(
        f"D_f{end}",
        0.0,
        unit="s/m",
        limits=NOT_NEGATIVE,
        description="Hunt-Crossley damping: relative gain of the normal force per penetration rate",
    )
    mu = model.parameter(f"mu{end}", 0.0, limits=NOT_NEGATIVE, description=f"Coefficient of friction along the {wall}")
    friction_velocity = model.parameter(
        f"friction_velocity{end}",
        1e-2,
        unit="m/s",
        limits=POSITIVE,
        description=f"Sliding speed over which friction along the {wall} changes sign (tanh)",
    )
    return Wall(half_space.normal, half_space.offset, K_f, D_f, mu, friction_velocity)
