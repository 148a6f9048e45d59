"""What the plant of an arm in space has beside its arm and its walls.

- A point of its own touches the walls (`fmus.environment.contact_point`). The depths `gap` and `penetration` are those
  of this point.
- The joints have stops (`fmus.environment.joint_stops`). Their torques tau_stop are added to the torques tau.
- A sensor sits between the arm and its payload. The wrench there is F_wrist (`fmus.mechanics.spatial_payload`).

Wrenches are a force and a moment about the tip, in the axes of the base, of the arm on what it touches or carries.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np

from adaptimp_fmu import ContinuousModel
from fmus.elements import of_wrench
from fmus.environment.contact_point import ContactPoint, declare_contact_point
from fmus.environment.joint_stops import declare_joint_stops
from fmus.mechanics.joints import Joints
from fmus.mechanics.spatial_arm import PER_JOINT
from fmus.mechanics.spatial_model import SpatialArmModel
from fmus.mechanics.spatial_payload import TipMotion, wrench_on_payload
from fmus.robots.robot import Robot

MODULES = (
    __name__,
    "fmus.environment.contact_point",
    "fmus.environment.joint_stops",
    "fmus.mechanics.spatial_payload",
)
"""Modules whose docstrings have the equations."""


@dataclass(frozen=True)
class SpatialPlant:
    """Contact point, stops and wrist of an arm in space.

    Attributes
    ----------
    arm
        Equations of the arm.
    joints
        What the joints are.
    motion
        Joint coordinates and rates q and dq, shape (n,).
    point
        Point that touches the walls.
    tau_stop
        Torques of the stops on the joints, N.m, shape (n,); forces, N, of slides.
    """

    arm: SpatialArmModel
    joints: Joints
    motion: tuple[ca.SX, ca.SX]
    point: ContactPoint
    tau_stop: ca.SX

    @classmethod
    def declare(
        cls,
        model: ContinuousModel,
        arm: SpatialArmModel,
        robot: Robot,
        motion: tuple[ca.SX, ca.SX],
        q_start: ca.SX,
    ) -> "SpatialPlant":
        """Declare the parameters, and an event for the stops of each joint.

        Parameters
        ----------
        motion
            Joint coordinates and rates q and dq, shape (n,).
        q_start
            Joint coordinates at the start, shape (n,).
        """
        q, dq = motion
        point = declare_contact_point(model, arm, q, dq)
        stops = declare_joint_stops(model, robot.joints, _inertia_against(arm, robot), q_start)
        depth = stops.depth(q)
        pressed = ca.vertcat(*(model.event(f"stop{i + 1}", depth[i]) for i in range(arm.n)))
        return cls(arm, robot.joints, (q, dq), point, stops.torque(q, dq, pressed))

    def show(self, model: ContinuousModel, F_ext: ca.SX, p: ca.SX, ddq: ca.SX) -> None:
        """Declare the outputs `F_wrist` and `tau_stop`.

        Parameters
        ----------
        F_ext
            Wrench of the contact, shape (6,).
        p
            Parameters of the arm and of its payload, shape (13 n + 10,).
        ddq
            Accelerations of the joints, shape (n,).
        """
        arm, joints = self.arm, self.joints
        payload = wrench_on_payload(p[PER_JOINT * arm.n :], TipMotion.of(arm.arm, *self.motion, ddq), arm.gravity)
        what = "of the arm on all beyond the wrist"
        texts = of_wrench(f"Force {what}", f"Moment {what}", arm.task)
        model.output("F_wrist", F_ext + payload, unit=arm.task.each("N", "N.m"), description=texts)
        texts = joints.texts("Torque of the stops", "Force of the stops")
        model.output("tau_stop", self.tau_stop, unit=joints.each("N.m", "N"), description=texts)


def _inertia_against(arm: SpatialArmModel, robot: Robot) -> np.ndarray:
    """Inertia against the motion of each joint while the others are free, kg m2 (kg), shape (n,), at the start."""
    H = np.array(ca.evalf(arm.inertia(ca.SX(ca.DM(robot.start.q)), ca.SX(ca.DM(robot.p_start)))))
    return 1 / np.diag(np.linalg.inv(H))
