"""What all controllers share: inputs, outputs, a model of the arm, and the reference trajectory of eq. (11).

A controller's outputs are those of a tick: e = x - x_t, the torque, p_hat and x_t are shown before
the states advance to the next tick.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import NOT_NEGATIVE, POSITIVE, Drawing, SampledModel
from fmus import start
from fmus.control.full_tirt import LARGEST_NORM, FullImpedance, companion, row_norm
from fmus.control.gains import declare_gain, require_definite
from fmus.control.impedance import ArmModel, Measured
from fmus.control.tirt import Impedance
from fmus.drawings.arm import arm as drawn_arm
from fmus.drawings.characteristics import impedance as drawn_impedance
from fmus.elements import ACCELERATION, ANGLE, LENGTH, RATE, along, of_axes, of_joints, of_links
from fmus.mechanics.algebra import factors_spd
from fmus.mechanics.arm import Arm
from fmus.mechanics.planar_arm import PlanarArm
from fmus.project import group_signals

# The smallest det(J J') / (l1 + ... + ln)^4 at which the arm is not taken for singular: with two
# equal links, sin(q2) = 4e-6.
SINGULARITY = 1e-12

EQUATIONS = (
    "fmus.control.controller",
    "fmus.control.impedance",
    "fmus.control.tirt",
    "fmus.mechanics.planar_arm",
    "fmus",
)
"""Modules with the equations that every controller shares, for its documentation."""


@dataclass(frozen=True)
class Controller:
    """A controller that is being declared: its model, and the symbols that every control law uses.

    Attributes
    ----------
    ddq
        Measured joint acceleration, rad/s2, shape (n,).
    virtual
        x_v, dx_v, ddx_v, shape (2,) each.
    p_start
        Parameters of the arm that the controller starts from, shape (3 n,).
    x, dx
        Tip position and velocity by the arm's kinematics, shape (2,).
    x_t, dx_t
        State of the TIRT, shape (2,).
    """

    model: SampledModel
    arm: Arm
    measured: Measured
    ddq: ca.SX
    virtual: tuple[ca.SX, ca.SX, ca.SX]
    impedance: Impedance | FullImpedance
    l: ca.SX
    gravity: ca.SX
    coulomb_velocity: ca.SX
    p_start: ca.SX
    x: ca.SX
    dx: ca.SX
    x_t: ca.SX
    dx_t: ca.SX

    @property
    def e(self) -> ca.SX:
        """Regression error x - x_t, m, shape (2,)."""
        return self.x - self.x_t

    def arm_model(self, p: ca.SX) -> ArmModel:
        """The arm with parameters p, shape (3 n,)."""
        return ArmModel(self.arm, p, self.l, self.gravity, self.coulomb_velocity)

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
            Name of the variable whose first n elements are the masses in H.
        advice
            What the user is to do, for the message.
        """
        sentence = (
            f"{name} is singular because of the masses {masses}[1] to {masses}[{self.arm.n}], and the control law needs"
            f" its inverse; {advice}. Size of a pivot of {name}, kg.m2"
        )
        _, pivots = factors_spd(H)
        for pivot in pivots:
            self.model.require(ca.fabs(pivot), sentence)

    def finish(self, tau_cmd: ca.SX, p_hat: ca.SX) -> SampledModel:
        """Declare the common outputs and the terminals, let the TIRT advance, and return the model."""
        model = self.model
        model.output("tau_cmd", tau_cmd, unit="N.m", description=of_joints("Commanded torque", self.arm.n))
        size = self.arm.task_size
        text = "Target-impedance reference trajectory, eq. (11),"
        model.output("x_t", self.x_t, unit="m", description=along(text, size))
        model.output("dx_t", self.dx_t, unit="m/s", description=along("Rate of x_t", size))
        model.output("e", self.e, unit="m", display_unit=LENGTH, description=along("Regression error x - x_t", size))
        model.output(
            "p_hat",
            p_hat,
            unit=parameter_units(self.arm.n),
            description=parameter_descriptions(self.arm.n, "Estimated"),
        )
        x_t, dx_t = self.impedance.advance(self.x_t, self.dx_t, self.virtual, self.measured.F_hat, model.period)
        model.update(self.x_t, x_t)
        model.update(self.dx_t, dx_t)
        group_signals(model)
        return model


def declare_controller(name: str, description: str, n: int = 2, *, full: bool = False) -> Controller:
    """Declare a controller of an arm with n joints: the common inputs, parameters and TIRT.

    With `full` the gains are symmetric positive definite matrices; else they are diagonal.
    """
    model = SampledModel(name, f"{description}, with full matrices" if full else description)
    arm: Arm = PlanarArm(n)
    begin = start.ARMS[n]
    q = model.input("q", begin.q, unit="rad", display_unit=ANGLE, description=of_joints("Angle", n))
    dq = model.input("dq", begin.dq, unit="rad/s", display_unit=RATE, description=of_joints("Rate", n))
    ddq = model.input(
        "ddq", begin.ddq, unit="rad/s2", display_unit=ACCELERATION, description=of_joints("Acceleration", n)
    )
    size = arm.task_size
    F_hat = model.input(
        "F_hat", [0.0] * size, unit="N", description=along("Measured force of the tip on the wall", size)
    )
    x_v = model.input("x_v", start.X_V, unit="m", description=along("Virtual position of the tip", size))
    dx_v = model.input("dx_v", start.DX_V, unit="m/s", description=along("Virtual velocity of the tip", size))
    ddx_v = model.input("ddx_v", start.DDX_V, unit="m/s2", description=along("Virtual acceleration of the tip", size))
    impedance = _impedance(model, full=full)
    l = model.parameter("l", begin.link_lengths, unit="m", limits=POSITIVE, description=of_links("Length", n))
    gravity = model.parameter("gravity", 0.0, unit="m/s2", description="Gravitational acceleration along -x2")
    coulomb_velocity = model.parameter(
        "coulomb_velocity",
        start.COULOMB_VELOCITY,
        unit="rad/s",
        display_unit=RATE,
        limits=POSITIVE,
        description="Joint rate over which Coulomb friction changes sign (tanh)",
    )
    p_start = model.parameter(
        "p_start",
        [*begin.masses, *([0.0] * 2 * arm.n)],
        unit=parameter_units(arm.n),
        limits=NOT_NEGATIVE,
        description=parameter_descriptions(arm.n, "Assumed"),
    )
    _require_regular(model, arm, q, l)
    return Controller(
        model=model,
        arm=arm,
        measured=Measured(q, dq, F_hat),
        ddq=ddq,
        virtual=(x_v, dx_v, ddx_v),
        impedance=impedance,
        l=l,
        gravity=gravity,
        coulomb_velocity=coulomb_velocity,
        p_start=p_start,
        x=arm.forward_kinematics(q, l),
        dx=ca.mtimes(arm.jacobian(q, l), dq),
        x_t=model.state("x_t", x_v),
        dx_t=model.state("dx_t", dx_v),
    )


def drawings(n: int) -> list[Drawing]:
    """Draw what the variables of every controller mean: the target impedance, and the frames of the arm."""
    return [drawn_impedance(), drawn_arm(n)]


def parameter_units(n: int) -> Sequence[str]:
    """Units of p = (m, viscous, coulomb)."""
    return ["kg"] * n + ["N.m.s/rad"] * n + ["N.m"] * n


def parameter_descriptions(n: int, attribute: str) -> Sequence[str]:
    """Descriptions of the elements of p, beginning with `attribute`."""
    parts = ("mass at the end of link", "viscous friction of joint", "Coulomb friction of joint")
    return [f"{attribute} {part} {i + 1}" for part in parts for i in range(n)]


def _impedance(model: SampledModel, *, full: bool) -> Impedance | FullImpedance:
    """Declare the target impedance, eq. (3)."""
    declarations = {
        "M": ((2.0, 2.0), "kg", "Target inertia"),
        "B": ((340.0, 340.0), "N.s/m", "Target damping"),
        "K": ((4000.0, 4000.0), "N/m", "Target stiffness"),
    }
    M, B, K = (
        declare_gain(model, name, values, full=full, unit=unit, limits=POSITIVE, description=of_axes(text, full=full))
        for name, (values, unit, text) in declarations.items()
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


def _require_regular(model: SampledModel, arm: Arm, q: ca.SX, l: ca.SX) -> None:
    """Demand that the arm is not singular."""
    J = arm.jacobian(q, l)
    reach = ca.sum1(l)
    manipulability = ca.det(ca.mtimes(J, J.T)) / reach**4
    model.require(
        manipulability - SINGULARITY,
        "The arm is singular: q is stretched or folded, det(J J') / (sum of l)^4 must exceed 1e-12",
    )
