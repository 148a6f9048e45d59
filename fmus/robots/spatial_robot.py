"""An arm in space in an FMU: its parameters, which plants and controllers declare, and its start values.

The geometry of the arm is fixed in the FMU, as numbers of its equations. Masses, inertias, friction and rotors are
parameters p, and so is the payload: a rigid body that is fixed to the tip. A plant has the payload's mass, centre of
mass and moments of inertia. A controller has the ten parameters in which the torque is linear, and does not know them.

At the start the tip is on the ellipse of the virtual trajectory and moves with it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from adaptimp_fmu import ANY, NOT_NEGATIVE, POSITIVE, Drawing, Icon, Model
from fmus import icons, start
from fmus.drawings.spatial_arm import Wall as DrawnWall
from fmus.drawings.spatial_arm import spatial_arm as drawn_arm
from fmus.elements import ANGLE, RATE, along
from fmus.mechanics.arm import ArmModel, ArmParameter
from fmus.mechanics.chain import Chain
from fmus.mechanics.joints import Joints
from fmus.mechanics.orientation import rotation
from fmus.mechanics.recursions import TEN
from fmus.mechanics.rigid_body import LOWER, ROUNDING, Body, Placement, RobotError
from fmus.mechanics.spatial_arm import PER_JOINT, SPACE, SpatialArm
from fmus.mechanics.spatial_model import TASK, SpatialArmModel, spatial_parameters
from fmus.mechanics.task import Task
from fmus.robots.spatial_page import PRESS, Rest, first_runs, frames, parameter_grid
from fmus.robots.substep import longest_substep
from fmus.start import MotionStart

GRAVITY = (0.0, 0.0, -9.81)
"""Acceleration of a falling body in the axes of the base, m/s2: the arm stands upright."""
DIGITS = 10
"""Decimals of start values that are computed, and digits of p, so that all machines declare the same."""
NEWTON_STEPS = 100
AXES = ("axis 1", "axis 2", "axis 3")
NO_PAYLOAD = Body("payload", 0.0)


@dataclass(frozen=True)
class SpatialRobot:
    """An arm in space with start values; see `fmus.robots.robot.Robot`.

    Attributes
    ----------
    chain
        Joints, bodies and frames.
    near
        Joint coordinates from which those of the start are sought, rad or m, shape (n,).
    path
        Virtual trajectory of the tip.
    payload
        What the plant's tip holds at the start, in the frame of the tip; controllers assume nothing there.
    sources
        Names of further modules whose docstrings tell where the numbers come from.
    origin
        Where the numbers come from, in a sentence for the FMUs' pages.

    Raises
    ------
    RobotError
        If the arm has fewer than six joints, does not reach the beginning of the ellipse from `near`, or has joints
        whose friction cannot be integrated.
    """

    chain: Chain
    near: tuple[float, ...]
    path: start.SpatialPath
    payload: Body = NO_PAYLOAD
    sources: tuple[str, ...] = ()
    origin: str = ""

    def __post_init__(self) -> None:
        """Refuse arms that cannot follow their trajectory from its beginning on."""
        _ = self.start, self.dt_max

    @cached_property
    def arm(self) -> SpatialArm:
        """Equations of the arm."""
        return SpatialArm(self.chain)

    @property
    def n(self) -> int:
        """Number of joints."""
        return self.chain.n

    @property
    def joints(self) -> Joints:
        """Names, units and limits of the joints."""
        return Joints.of(self.chain)

    @property
    def task(self) -> Task:
        """Task coordinates: position and orientation of the tip."""
        return TASK

    @property
    def parameters(self) -> Sequence[ArmParameter]:
        """What the elements of p are, shape (13 n + 10,)."""
        return spatial_parameters(self.chain)

    @property
    def start(self) -> MotionStart:
        """Motion at the start: the tip at the beginning of the ellipse, moving with it."""
        return self._start

    @cached_property
    def _start(self) -> MotionStart:
        """The motion at the start, computed once."""
        path, rate = self.path, 2 * math.pi / start.PERIOD
        axes = rotation_matrix(path.plane)
        x_v = np.array([*(np.array(path.center) + path.semi_axis[0] * axes[:, 0]), 0.0, 0.0, 0.0])
        dx_v = np.array([*(rate * path.semi_axis[1] * axes[:, 1]), 0.0, 0.0, 0.0])
        ddx_v = np.array([*(-(rate**2) * path.semi_axis[0] * axes[:, 0]), 0.0, 0.0, 0.0])
        q = self._posture(x_v)
        dq = np.linalg.lstsq(np.array(self._place(q)[1]), dx_v, rcond=None)[0]
        p = [*self.chain.p, *self.payload.parameters]
        held = self._model.loaded(ca.SX(ca.DM(p)))
        H, bias = self.arm.inertia(q, held), self.arm.bias(q, dq, held, GRAVITY, start.COULOMB_VELOCITY)
        ddq = np.linalg.solve(np.array(ca.evalf(H)), -np.array(ca.evalf(bias))).ravel()
        return MotionStart(
            **{
                name: tuple(map(float, np.round(value, DIGITS) + 0.0))
                for name, value in (
                    ("q", q), ("dq", dq), ("ddq", ddq), ("x_v", x_v), ("dx_v", dx_v), ("ddx_v", ddx_v),
                )
            }
        )  # fmt: skip

    @property
    def dt_max(self) -> float:
        """Longest sub-step of its plant at the start, s: one at which the friction of the joints is stable."""
        return longest_substep(self.arm, np.array(self.start.q), self.chain.p)

    @property
    def p_start(self) -> Sequence[float]:
        """Parameters p at the start, shape (13 n + 10,): the arm's, and no payload."""
        return [*(float(f"{value:.{DIGITS}g}") for value in self.chain.p), *([0.0] * TEN)]

    @property
    def uncertain(self) -> Sequence[bool]:
        """Whether an element of p is adapted by default, shape (13 n + 10,): the payload's ten."""
        return [i >= PER_JOINT * self.n for i in range(PER_JOINT * self.n + TEN)]

    @property
    def title(self) -> str:
        """What its plant is."""
        return f"{self.chain.name}, an arm of {self.n} joints in space,"

    @property
    def modules(self) -> Sequence[str]:
        """Names of the modules whose docstrings hold its equations."""
        return [
            "fmus.mechanics.spatial_model",
            "fmus.mechanics.spatial_arm",
            "fmus.mechanics.orientation",
            __name__,
            *self.sources,
        ]

    def place_of_wall(self, number: int) -> tuple[Sequence[float], float]:
        """Start values of a wall: that of the path; a second one is beside it, along the ellipse's second axis."""
        if number == 1:
            return self.path.wall_normal, self.path.wall_offset
        axis = rotation_matrix(self.path.plane)[:, 1]
        place = float(np.dot(axis, self.path.center)) + self.path.semi_axis[1] / 2
        return tuple(map(float, np.round(axis, DIGITS) + 0.0)), round(place, DIGITS)

    def icon(self, *, corner: bool = False) -> Icon:
        """Icon of its plant."""
        return icons.arm(self.n, corner=corner)

    def drawing(self, walls: int = 1) -> Drawing:
        """Draw its frames and signs."""
        del walls  # a second wall would hide the arm
        return drawn_arm(self.arm, self.start.q, DrawnWall(self.path.wall_normal, self.path.wall_offset))

    def declare_known(self, model: Model) -> ArmModel:
        """Declare gravity, the velocity of friction, and the orientation from which angles count."""
        model.guide = replace(model.guide, grids=[parameter_grid(self.parameters, self.origin)])
        gravity = model.parameter(
            "gravity", GRAVITY, unit="m/s2", description=along("Acceleration of a falling body", SPACE)
        )
        of_slides = "" if all(self.joints.turns) else "; in m/s for joints that slide"
        velocity = model.parameter(
            "coulomb_velocity",
            start.COULOMB_VELOCITY,
            unit="rad/s",
            display_unit=RATE,
            limits=POSITIVE,
            description=f"Joint rate over which Coulomb friction changes sign (tanh){of_slides}",
        )
        return SpatialArmModel(self.arm, gravity, velocity, rotation(declare_reference(model, self.path)))

    def declare_true(self, model: Model) -> tuple[ArmModel, ca.SX]:
        """Declare the numbers of a plant and of its payload; returns the arm and p, shape (13 n + 10,)."""
        known, start_of_p = self.parameters[: PER_JOINT * self.n], self.p_start[: PER_JOINT * self.n]
        p = model.parameter(
            "p",
            start_of_p,
            # The rounding of a file may leave a moment of inertia below 0 by a millionth.
            limits=[
                ANY if parameter.signed or value < 0 else NOT_NEGATIVE
                for parameter, value in zip(known, start_of_p, strict=True)
            ],
            unit=[parameter.unit for parameter in known],
            description=[f"{parameter.text[0].upper()}{parameter.text[1:]}" for parameter in known],
        )
        payload = self._declare_payload(model)
        model.guide = replace(model.guide, examples=first_runs(model.name, self._rest()), numbers=[frames(self.chain)])
        return self.declare_known(model), ca.vertcat(p, payload)

    def _declare_payload(self, model: Model) -> ca.SX:
        """Declare what the tip holds; returns its ten parameters in the frame of the tip."""
        m = model.parameter(
            "payload_mass", self.payload.mass, unit="kg", limits=NOT_NEGATIVE, description="Mass of the payload"
        )
        c = model.parameter(
            "payload_center",
            self.payload.center,
            unit="m",
            description=[f"Centre of mass of the payload along {axis} of the tip" for axis in AXES],
        )
        six = model.parameter(
            "payload_inertia",
            self.payload.inertia,
            unit="kg.m2",
            description=[f"Moment of inertia {i + 1}{j + 1} of the payload about its centre" for i, j in LOWER],
        )
        about_origin = [six[k] + m * ((ca.dot(c, c) if i == j else 0) - c[i] * c[j]) for k, (i, j) in enumerate(LOWER)]
        _require_moments(model, six)
        return ca.vertcat(m, m * c, *about_origin)

    def _rest(self) -> Rest:
        """Torques and inertias at the start with the payload, for examples."""
        q, path = self.start.q, self.path
        held = ca.DM(ca.evalf(self._model.loaded(ca.SX(ca.DM([*self.chain.p, *self.payload.parameters])))))
        J, H = np.array(self.arm.jacobian(q)), np.array(self.arm.inertia(q, held))
        holding = np.array(self.arm.gravity_torque(q, held, GRAVITY)).ravel()
        pressing = J[:SPACE].T @ np.array(path.wall_normal) * PRESS
        touching = float(np.dot(path.wall_normal, np.array(self.arm.tip_frame(q)[1]).ravel()))
        return Rest(self.joints, holding, pressing, np.diag(H), touching)

    @cached_property
    def _model(self) -> SpatialArmModel:
        """The arm with its start values in the place of symbols."""
        reference = ca.SX(ca.DM(rotation_matrix(self.path.reference)))
        return SpatialArmModel(self.arm, ca.SX(ca.DM(GRAVITY)), ca.SX(start.COULOMB_VELOCITY), reference)

    @cached_property
    def _place(self) -> ca.Function:
        """A function of q, shape (n,): x, shape (6, 1), and its Jacobian, shape (6, n)."""
        q = ca.SX.sym("q", self.n)
        return ca.Function("place", [q], [self._model.forward_kinematics(q), self._model.jacobian(q)])

    def _posture(self, x: np.ndarray) -> np.ndarray:
        """Joint coordinates near `near` that put the tip at x, by Newton's method of least change."""
        if len(self.near) != self.n:
            msg = f"Robot {self.chain.name}: {len(self.near)} joint coordinates are given for {self.n} joints."
            raise RobotError(msg)
        q, error = np.array(self.near, float), np.full(TASK.size, np.inf)
        for _ in range(NEWTON_STEPS):
            place, J = (np.array(value) for value in self._place(q))
            error = x - place.ravel()
            if not np.all(np.isfinite(error)) or np.abs(error).max() < 1e-14:
                break
            q = q + np.linalg.lstsq(J, error, rcond=None)[0]
        if not np.abs(error).max() < 1e-9:
            msg = (
                f"Robot {self.chain.name}: the tip does not reach the beginning of the ellipse, position "
                f"{np.round(x[:SPACE], 4).tolist()} m, from the joint coordinates {list(self.near)}; choose others, or "
                "another ellipse."
            )
            raise RobotError(msg)
        return q


def rotation_matrix(rpy: Sequence[float]) -> np.ndarray:
    """The matrix R3(yaw) R2(pitch) R1(roll), shape (3, 3), of angles rad, shape (3,)."""
    return Placement.from_rpy((0.0, 0.0, 0.0), rpy).R


def declare_reference(model: Model, path: start.SpatialPath) -> ca.SX:
    """Declare the orientation of the tip from which its angles count: roll, pitch and yaw, rad, shape (3,)."""
    return model.parameter(
        "reference_rpy",
        path.reference,
        unit="rad",
        display_unit=ANGLE,
        description=[f"{turn} of the tip's reference orientation" for turn in ("Roll", "Pitch", "Yaw")],
    )


def _require_moments(model: Model, six: ca.SX) -> None:
    """Demand moments of inertia that a body can have: the matrix (tr I / 2) - I is positive semidefinite."""
    I = {place: six[k] for k, place in enumerate(LOWER)}
    sentence = "payload_inertia must be that of a body: no principal moment is negative or exceeds the other two's sum"
    trace = (I[0, 0] + I[1, 1] + I[2, 2]) / 2
    S = ca.vertcat(
        ca.horzcat(trace - I[0, 0], -I[0, 1], -I[0, 2]),
        ca.horzcat(-I[0, 1], trace - I[1, 1], -I[1, 2]),
        ca.horzcat(-I[0, 2], -I[1, 2], trace - I[2, 2]),
    )
    pairs = ((0, 1), (0, 2), (1, 2))
    orders = [
        [S[i, i] for i in range(SPACE)],
        [S[i, i] * S[j, j] - S[i, j] ** 2 for i, j in pairs],
        [ca.det(S)],
    ]
    for order, minors in enumerate(orders, 1):
        for minor in minors:
            model.require(0.5 - (minor < -ROUNDING * trace**order), sentence)
