"""What the plant of an arm in space has beside its arm and its walls.

- A point of its own touches the walls (`fmus.environment.contact_point`). Where the law of contact says tip, it is this
  point, and the depths `gap` and `penetration` are those of this point.
- The joints have stops (`fmus.mechanics.joint_stops`). Their torques tau_stop are added to the torques tau.
- A sensor sits between the arm and its payload. The wrench there is F_wrist (`fmus.mechanics.spatial_payload`).

Wrenches are a force and a moment about the tip, in the axes of the base, of the arm on what it touches or carries.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import ContinuousModel
from fmus.elements import of_joints, of_wrench
from fmus.environment.contact_point import ContactPoint, declare_contact_point
from fmus.mechanics.joint_stops import declare_joint_stops
from fmus.mechanics.spatial_arm import PER_JOINT
from fmus.mechanics.spatial_model import SpatialArmModel
from fmus.mechanics.spatial_payload import TipMotion, wrench_on_payload

MODULES = (
    __name__,
    "fmus.environment.contact_point",
    "fmus.mechanics.joint_stops",
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
    q, dq
        Joint coordinates and rates, shape (n,).
    point
        Point that touches the walls.
    tau_stop
        Torques of the stops on the joints, N.m, shape (n,); forces, N, of slides.
    """

    arm: SpatialArmModel
    q: ca.SX
    dq: ca.SX
    point: ContactPoint
    tau_stop: ca.SX

    @classmethod
    def declare(
        cls, model: ContinuousModel, arm: SpatialArmModel, motion: tuple[ca.SX, ca.SX], begin: tuple[ca.SX, Sequence]
    ) -> "SpatialPlant":
        """Declare the parameters, and an event for the stops of each joint.

        Parameters
        ----------
        motion
            Joint coordinates and rates q and dq, shape (n,).
        begin
            Joint coordinates at the start: the parameter `q_start` and its start values, shape (n,).
        """
        q, dq = motion
        point = declare_contact_point(model, arm, q, dq)
        stops = declare_joint_stops(model, arm.arm, *begin)
        depth = stops.depth(q)
        pressed = ca.vertcat(*(model.event(f"stop{i + 1}", depth[i]) for i in range(arm.n)))
        return cls(arm, q, dq, point, stops.torque(q, dq, pressed))

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
        motion = TipMotion.of(self.arm.arm, self.q, self.dq, ddq)
        payload = wrench_on_payload(p[PER_JOINT * self.arm.n :], motion, self.arm.gravity)
        texts = of_wrench("Force of the arm on all beyond the wrist", self.arm.task, "Moment on all beyond the wrist")
        model.output("F_wrist", F_ext + payload, unit=self.arm.task.each("N", "N.m"), description=texts)
        units = ["N.m" if joint.turns else "N" for joint in self.arm.arm.chain.joints]
        texts = of_joints("Torque of the stops", self.arm.n)
        model.output("tau_stop", self.tau_stop, unit=units, description=texts)
