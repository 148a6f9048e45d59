"""A run of a closed loop in a child process, and what it showed of its controller."""

import pickle
import warnings
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np

from orchestration.errors import OrchestrationError
from orchestration.fmi.units import AS_IS, Linear
from orchestration.results.result import Result
from orchestration.sandbox.worker import Announce, Write
from orchestration.system.system import System

JOB = f"{__name__}:run"
DURATION = 1.2  # s; the tip of the paper's arm touches its wall from 0.92 s on, and leaves it before 1.1 s
FREE_UNTIL = 0.9  # s
IN_SPACE = 6  # task coordinates of an arm in space, the first three of which are positions
_RECORDED = ("plant.x", "plant.F_ext", "trajectory.x_v")


@dataclass(frozen=True)
class Ride:
    """What a run of a closed loop showed.

    Attributes
    ----------
    miss
        Largest distance of the tip from the virtual trajectory, m.
    miss_in_free_motion
        The same before the wall is touched, m.
    force
        Largest force of the wall on the tip, N.
    torques
        Largest torque of each joint, N.m.
    """

    miss: float
    miss_in_free_motion: float
    force: float
    torques: tuple[float, ...]

    @classmethod
    def of(cls, record: Mapping[str, Any]) -> Self:
        """The ride that a child process reported."""
        return cls(**{**record, "torques": tuple(record["torques"])})


def run(plan: Mapping[str, Any], write: Write, announce: Announce) -> None:
    """The job of the child process: run a system, and write what the run showed.

    The announcements say how far the run has come, and belong behind the words "ends the process".
    """
    from orchestration.master.kernel.compiled import FOLDER
    from orchestration.master.options import Options
    from orchestration.master.simulate import simulate

    if FOLDER is not None:
        write(machine_code=str(FOLDER))
    # The process that started this one has written the file, and no FMU is loaded yet.
    system: System = pickle.loads(Path(plan["system"]).read_bytes())  # noqa: S301  # nosec B301
    step = system.run_step()
    commands = [v.name for v in system.component("controller").description.of_causality("output")]
    commands = [name for name in commands if name.startswith("tau_cmd[")]
    axes = _positions(system)
    recorded = [f"{name}[{i}]" for name in _RECORDED for i in axes]
    columns = [*recorded, *(f"controller.{name}" for name in commands)]

    def progress(done: int, total: int) -> None:  # noqa: ARG001
        announce(f"after t = {done * step:.6g} s of the closed loop")

    announce("before the first step of the closed loop")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            result = simulate(system, stop_time=DURATION, options=Options(record=columns), progress=progress)
        except OrchestrationError as failed:
            write(failed=str(failed))
            return
    announce("after the closed loop")
    write(ride=asdict(_shown_by(result, system, commands)))


def _positions(system: System) -> range:
    """Numbers of the elements of plant.x that are positions: two in the plane, three in space."""
    outputs = system.component("plant").description.variables
    return range(1, 4 if f"x[{IN_SPACE}]" in outputs else 3)


def _shown_by(result: Result, system: System, commands: list[str]) -> Ride:
    """What a result shows."""
    axes = _positions(system)
    tip, target = (np.array([result.at_ticks(f"{n}[{i}]") for i in axes]) for n in ("plant.x", "trajectory.x_v"))
    misses = np.linalg.norm(tip - target, axis=0)
    force = np.linalg.norm([result[f"plant.F_ext[{i}]"] for i in axes], axis=0)
    torques = (float(abs(_in_our_unit(system, name)(result[f"controller.{name}"])).max()) for name in commands)
    touched = int(np.argmax(force > 0)) if force.any() else len(misses)
    free = max(1, min(touched, round(len(misses) * FREE_UNTIL / DURATION)))
    return Ride(float(misses.max()), float(misses[:free].max()), float(force.max()), tuple(torques))


def _in_our_unit(system: System, output: str) -> Linear:
    """The conversion of a command into the unit of the actuator, which is that of the limits."""
    ways = (c.scale for c in system.connections if (c.source, c.output) == ("controller", output))
    return next(ways, AS_IS)
