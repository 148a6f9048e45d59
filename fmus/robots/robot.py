"""What an FMU needs of a robot: an arm with numbers, and the parameters of an FMU that describe it."""

from collections.abc import Sequence
from typing import Protocol

import casadi as ca

from adaptimp_fmu import Drawing, Icon, Model
from fmus.mechanics.arm import ArmModel, ArmParameter
from fmus.mechanics.joints import Joints
from fmus.mechanics.task import Task
from fmus.start import MotionStart


class Robot(Protocol):
    """A robot whose plant and controllers can be declared."""

    @property
    def n(self) -> int:
        """Number of joints."""
        ...

    @property
    def joints(self) -> Joints:
        """Names, units and limits of the joints."""
        ...

    @property
    def task(self) -> Task:
        """Task coordinates of its tip."""
        ...

    @property
    def parameters(self) -> Sequence[ArmParameter]:
        """What the elements of p are, r in number."""
        ...

    @property
    def start(self) -> MotionStart:
        """Motion at the start."""
        ...

    @property
    def dt_max(self) -> float:
        """Longest sub-step of its plant at the start, s."""
        ...

    @property
    def p_start(self) -> Sequence[float]:
        """Parameters p at the start, shape (r,)."""
        ...

    @property
    def uncertain(self) -> Sequence[bool]:
        """Which elements of p adaptive controllers adapt by default, shape (r,)."""
        ...

    @property
    def title(self) -> str:
        """What its plant is, such as ``Planar arm with point masses``."""
        ...

    @property
    def modules(self) -> Sequence[str]:
        """Names of the modules whose docstrings hold its equations."""
        ...

    def place_of_wall(self, number: int) -> tuple[Sequence[float], float]:
        """Start values of a wall: its unit normal, shape (positions,), and the distance of its surface, m."""
        ...

    def icon(self, *, corner: bool = False) -> Icon:
        """Icon of its plant, which may touch two walls."""
        ...

    def drawing(self, walls: int = 1) -> Drawing:
        """Draw its frames and signs, with one wall or two."""
        ...

    def declare_known(self, model: Model) -> ArmModel:
        """Declare what a controller knows of it: all numbers but p."""
        ...

    def declare_true(self, model: Model) -> tuple[ArmModel, ca.SX]:
        """Declare all numbers of a plant; returns the arm and the symbols of p, shape (r,)."""
        ...
