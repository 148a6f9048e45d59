"""Equations of an arm in space with its gravity given, in position, roll, pitch and yaw, as control laws ask for them.

The task coordinates are x = (p, phi) of `fmus.mechanics.orientation`, six in number. A force F of the arm on the
environment is (f, E' m) in these coordinates, so that J_a' F are the joint torques of the wrench (f, m).

The arm holds a payload: a rigid body that is fixed to the tip. Its ten parameters, in the frame of the tip, follow
those of the chain in p, of shape (13 n + 10,). They act as if they were added to those of the last body.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import Formula, Formulas
from fmus.mechanics.algebra import gram_determinant
from fmus.mechanics.arm import ArmParameter, Demand
from fmus.mechanics.chain import Chain
from fmus.mechanics.orientation import analytic_jacobian, angles, generalized_force, nearest, pitch_cosine
from fmus.mechanics.recursions import TEN, Inertia
from fmus.mechanics.rigid_body import SYMBOLS, RobotError
from fmus.mechanics.spatial_arm import PER_JOINT, SpatialArm
from fmus.mechanics.task import Task

FORMULAS = Formulas(
    "Payload",
    [
        Formula(
            r"\pi = (m, \; m c, \; I), \quad I = I_c + m\,(c^{T} c\,1 - c\,c^{T})",
            "The payload is a body fixed to the tip, with the mass m, the centre of mass c and the moments of inertia"
            " about c. Torques are linear in its ten parameters, in the frame of the tip. Controllers know these as the"
            " last ten elements of their parameters.",
        )
    ],
)
TASK = Task(positions=3, angles=3)
PITCH = 0.01
"""The smallest cos(pitch) at which the angles are used: a pitch of 89.4 deg, where roll and yaw turn 100 times as fast
as the tip."""
SINGULARITY = 1e-12
"""The smallest det(J J'), positions divided by the reach of the arm, at which the arm is not taken for singular."""


@dataclass(frozen=True)
class SpatialArmModel:
    """Equations of a spatial arm whose gravity is given; see `fmus.mechanics.arm.ArmModel`.

    Attributes
    ----------
    arm
        Equations in the axes of the base.
    gravity
        Acceleration of a falling body in the axes of the base, m/s2, shape (3,).
    coulomb_velocity
        Joint rate over which Coulomb friction changes sign, rad/s.
    reference
        Orientation R_0 of the tip at which roll, pitch and yaw are 0, shape (3, 3).
    wanted
        Angles, rad, shape (3,), from which roll and yaw of x are at most a half turn away; by default 0.

    Raises
    ------
    RobotError
        If the arm has fewer than six joints, so that its tip cannot follow six coordinates.
    """

    arm: SpatialArm
    gravity: ca.SX
    coulomb_velocity: ca.SX
    reference: ca.SX
    wanted: ca.SX | None = None

    def __post_init__(self) -> None:
        """Refuse arms whose Jacobian never has full rank."""
        if self.n < TASK.size:
            msg = (
                f"Robot {self.arm.chain.name}: position and orientation of the tip are {TASK.size} task coordinates, "
                f"but the arm has {self.n} joints; use an arm of at least {TASK.size} joints, or hold fewer joints."
            )
            raise RobotError(msg)

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.arm.n

    @property
    def task(self) -> Task:
        """Task coordinates: three of the position and three angles."""
        return TASK

    @property
    def parameters(self) -> Sequence[ArmParameter]:
        """What the elements of p are, shape (13 n + 10,)."""
        return spatial_parameters(self.arm.chain)

    def forward_kinematics(self, q: ca.SX) -> ca.SX:
        """Task coordinates x = (p, phi), m and rad, shape (6,)."""
        R, position = self._tip(q)
        phi = angles(R) if self.wanted is None else nearest(angles(R), self.wanted)
        return ca.vertcat(position, phi)

    def jacobian(self, q: ca.SX) -> ca.SX:
        """Analytic Jacobian J_a, shape (6, n): dx = J_a dq."""
        return analytic_jacobian(self.arm.jacobian(q), self._tip(q)[0])

    def jacobian_rate(self, q: ca.SX, dq: ca.SX) -> ca.SX:
        """Time derivative of the analytic Jacobian, shape (6, n)."""
        J = self.jacobian(q)
        return ca.reshape(ca.jtimes(ca.vec(J), q, dq), *J.shape)

    def wrench_force(self, q: ca.SX, wrench: ca.SX) -> ca.SX:
        """F = (f, E' m) of a wrench (f, m) at the tip in the axes of the base, N and N.m, shape (6,)."""
        return generalized_force(wrench, angles(self._tip(q)[0]))

    def wrench_torque(self, q: ca.SX, wrench: ca.SX) -> ca.SX:
        """Torques of the joints, N.m, shape (n,), that hold a wrench at the tip: by the geometric Jacobian."""
        return ca.mtimes(self.arm.jacobian(q).T, wrench)

    def wrench_gain(self, q: ca.SX) -> ca.SX:
        """Largest |F| / |wrench|, shape (1,): the largest singular value of E, sqrt(1 + |sin(pitch)|)."""
        return ca.sqrt(1 + ca.fabs(self._tip(q)[0][2, 0]))

    def inertia(self, q: ca.SX, p: ca.SX) -> ca.SX:
        """Inertia matrix H, kg m2, shape (n, n)."""
        return self.arm.inertia(q, self.loaded(p))

    def bias(self, q: ca.SX, dq: ca.SX, p: ca.SX) -> ca.SX:
        """Torque C dq + g + f, N.m, shape (n,)."""
        return self.arm.bias(q, dq, self.loaded(p), self.gravity, self.coulomb_velocity)

    def inverse_dynamics(self, q: ca.SX, dq: ca.SX, v: ca.SX, a: ca.SX, p: ca.SX) -> ca.SX:
        """Torque H a + C v + g + f, N.m, shape (n,)."""
        return self.arm.inverse_dynamics(q, dq, v, a, self.loaded(p), self.gravity, self.coulomb_velocity)

    def regressor(self, q: ca.SX, dq: ca.SX, v: ca.SX, a: ca.SX) -> ca.SX:
        """Regressor Y, shape (n, 13 n + 10)."""
        Y = self.arm.regressor(q, dq, v, a, self.gravity, self.coulomb_velocity)
        payload = ca.SX.sym("payload", TEN)
        of_payload = ca.jacobian(self._at_the_last_joint(payload), payload)
        return ca.horzcat(Y, ca.mtimes(Y[:, TEN * (self.n - 1) : TEN * self.n], of_payload))

    def loaded(self, p: ca.SX) -> ca.SX:
        """Parameters of the chain with the payload in its last body, shape (13 n,)."""
        last, end = TEN * (self.n - 1), TEN * self.n
        body = p[last:end] + self._at_the_last_joint(p[PER_JOINT * self.n :])
        return ca.vertcat(p[:last], body, p[end : PER_JOINT * self.n])

    def demands(self, q: ca.SX) -> Sequence[Demand]:
        """Demands that the angles are not singular, and that the arm is not."""
        pitch = f"The tip pitches too far from its reference orientation: cos(pitch) must exceed {PITCH:g}"
        reach = f"The arm is singular: det(J J'), with positions in reaches of the arm, must exceed {SINGULARITY:g}"
        J = self.arm.jacobian(q)
        scaled = ca.vertcat(J[:3, :] / self.arm.chain.reach, J[3:, :])
        return [
            Demand(pitch_cosine(self._tip(q)[0]) - PITCH, pitch),
            Demand(gram_determinant(scaled) - SINGULARITY, reach),
        ]

    def _at_the_last_joint(self, payload: ca.SX) -> ca.SX:
        """The ten parameters of a body in the frame of the tip, in the frame of the last joint."""
        tip = self.arm.chain.tip
        return Inertia.of(payload).placed(ca.SX(ca.sparsify(ca.DM(tip.R))), ca.SX(ca.sparsify(ca.DM(tip.p)))).ten

    def _tip(self, q: ca.SX) -> tuple[ca.SX, ca.SX]:
        """The rotation of the tip from its reference orientation, shape (3, 3), and its position, m, shape (3,)."""
        R, position = self.arm.tip_frame(q)
        return R @ self.reference.T, position


def spatial_parameters(chain: Chain) -> Sequence[ArmParameter]:
    """What the elements of p are, shape (13 n + 10,): those of `Chain.p`, and after them the payload's."""
    found = [one for joint in chain.joints for one in _of_body(f"body {joint.body.name}", "its frame")]
    kinds = (
        ("N.m.s/rad", "N.s/m", "viscous friction"),
        ("N.m", "N", "Coulomb friction"),
        ("kg.m2", "kg", "rotor inertia"),
    )
    for turning, sliding, text in kinds:
        for joint in chain.joints:
            unit = turning if joint.turns else sliding
            found.append(ArmParameter(unit, f"{text} of {joint.label}", place=(joint.label, text)))
    return [*found, *_of_body("payload", "the tip")]


def _of_body(whose: str, frame: str) -> Sequence[ArmParameter]:
    """What the ten parameters of a body in a frame are."""
    texts = {
        "m": "mass",
        "mc": f"first moment along axis {{}} of {frame}",
        "I": f"moment of inertia {{}} about the origin of {frame}",
    }
    found = []
    for symbol in SYMBOLS:
        letters = symbol.rstrip("123")
        unit = {"m": "kg", "mc": "kg.m", "I": "kg.m2"}[letters]
        text = texts[letters].format(symbol.removeprefix(letters))
        signed = symbol not in ("m", "I11", "I22", "I33")
        found.append(ArmParameter(unit, f"{whose}: {text}", signed, (whose, symbol)))
    return found
