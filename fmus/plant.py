"""Plant: a robot arm, eq. (1), whose tip touches a compliant wall.

    H(q) ddq + C(q, dq) dq + g(q) + f(dq) = tau - J' F_ext

States are q and dq. Contact begins and ends at located events, so the integrator never steps
across the corner of the contact force. Equations: `fmus.mechanics.planar_arm`, `fmus.environment.contact`.
"""

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, ContinuousModel
from fmus import icons, start
from fmus.environment.contact import Wall
from fmus.environment.half_space import declare_half_space
from fmus.mechanics.algebra import solve_spd
from fmus.mechanics.arm import Arm
from fmus.mechanics.planar_arm import PlanarArm
from fmus.project import group_signals, publish


def plant(n: int = 2, name: str = "Plant") -> ContinuousModel:
    """Declare the model of an arm of n joints, by default the paper's, with the wall."""
    model = ContinuousModel(name, "Planar arm with point masses against a compliant wall")
    publish(
        model,
        icons.arm(n),
        __name__,
        "fmus.mechanics.planar_arm",
        "fmus.environment.contact",
        "fmus.environment.half_space",
        "fmus",
    )
    arm: Arm = PlanarArm(n)
    begin = start.ARMS[n]
    tau = model.input("tau", [0.0] * arm.n, unit="N.m", description="Joint torque")
    q_start = model.parameter("q_start", begin.q, unit="rad", description="Joint angle at the start")
    dq_start = model.parameter("dq_start", begin.dq, unit="rad/s", description="Joint rate at the start")
    m = model.parameter("m", begin.masses, unit="kg", limits=POSITIVE, description="Point mass at the end of a link")
    l = model.parameter("l", begin.link_lengths, unit="m", limits=POSITIVE, description="Length of a link")
    viscous = model.parameter(
        "viscous",
        [0.0] * arm.n,
        unit="N.m.s/rad",
        limits=NOT_NEGATIVE,
        description="Coefficient of viscous joint friction",
    )
    coulomb = model.parameter(
        "coulomb",
        [0.0] * arm.n,
        unit="N.m",
        limits=NOT_NEGATIVE,
        description="Coulomb joint friction torque",
    )
    coulomb_velocity = model.parameter(
        "coulomb_velocity",
        start.COULOMB_VELOCITY,
        unit="rad/s",
        limits=POSITIVE,
        description="Joint rate over which Coulomb friction changes sign (tanh)",
    )
    gravity = model.parameter("gravity", 0.0, unit="m/s2", description="Gravitational acceleration along -x2")
    wall = _wall(model)

    q, dq = model.state("q", q_start), model.state("dq", dq_start)
    x = arm.forward_kinematics(q, l)
    J = arm.jacobian(q, l)
    dx = ca.mtimes(J, dq)
    in_contact = model.event("contact", wall.gap(x))
    pushing = model.event("pushing", wall.damping_factor(dx))
    F_ext = wall.force(x, dx, in_contact, pushing)
    bias = (
        ca.mtimes(arm.coriolis(q, dq, m, l), dq)
        + arm.gravity_torque(q, m, l, gravity)
        + _friction(arm, dq, viscous, coulomb, coulomb_velocity)
    )
    ddq = solve_spd(arm.inertia(q, m, l), tau - bias - ca.mtimes(J.T, F_ext))
    model.derivative(q, dq)
    model.derivative(dq, ddq)

    model.output("q", q, unit="rad", description="Joint angle, relative to the previous link")
    model.output("dq", dq, unit="rad/s", description="Joint rate")
    model.output("ddq", ddq, unit="rad/s2", description="Joint acceleration; at a communication point its left limit")
    model.output("x", x, unit="m", description="Tip position")
    model.output("dx", dx, unit="m/s", description="Tip velocity")
    model.output("F_ext", F_ext, unit="N", description="Force of the tip on the wall")
    gap = wall.gap(x)
    model.output(
        "gap",
        gap,
        unit="m",
        description="Signed depth of the tip in the wall, n.x - wall_offset",
        scalar=True,
    )
    model.output(
        "penetration",
        ca.fmax(gap, 0),
        unit="m",
        description="Depth of the tip in the wall, 0 outside",
        scalar=True,
    )
    group_signals(model)
    return model


def _friction(arm: Arm, dq: ca.SX, viscous: ca.SX, coulomb: ca.SX, coulomb_velocity: ca.SX) -> ca.SX:
    """The arm's friction torque, N.m; without Coulomb friction a joint's tanh is that of 0, which costs nothing."""
    none = ca.SX.zeros(arm.n, 1)
    rubbing = ca.if_else(coulomb > 0, dq, 0)
    return arm.friction_torque(dq, viscous, none, coulomb_velocity) + arm.friction_torque(
        rubbing, none, coulomb, coulomb_velocity
    )


def _wall(model: ContinuousModel) -> Wall:
    """Declare the wall's parameters."""
    half_space = declare_half_space(model)
    K_f = model.parameter("K_f", 1e5, unit="N/m", limits=NOT_NEGATIVE, description="Stiffness of the wall")
    D_f = model.parameter(
        "D_f",
        0.0,
        unit="s/m",
        limits=NOT_NEGATIVE,
        description="Hunt-Crossley damping: relative gain of the normal force per penetration rate",
    )
    mu = model.parameter("mu", 0.0, limits=NOT_NEGATIVE, description="Coefficient of friction along the wall")
    friction_velocity = model.parameter(
        "friction_velocity",
        1e-2,
        unit="m/s",
        limits=POSITIVE,
        description="Sliding speed over which friction along the wall changes sign (tanh)",
    )
    return Wall(half_space.normal, half_space.offset, K_f, D_f, mu, friction_velocity)
