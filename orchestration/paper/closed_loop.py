"""Tries a controller in a closed loop: the loop must run, the tip follow its reference, torques stay within limits.

`in_loop` makes this the trial of `orchestration.check.check`; `paper_loop` is the loop that the command
``adaptimp check`` uses.
"""

import pickle
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from adaptimp_fmu.files.temporary_folder import temporary_folder
from orchestration.check import Candidate, Trial
from orchestration.check.findings import Finding, error, note, shown, warning
from orchestration.errors import OrchestrationError
from orchestration.fmi.units import AS_IS, Linear
from orchestration.paper.built_fmus import fmus
from orchestration.paper.numbers import TORQUE_LIMITS
from orchestration.paper.scenarios import VARIANTS
from orchestration.sandbox.process import work
from orchestration.sandbox.worker import Announce, Write
from orchestration.system.system import System

LOOP = "loop"  # in the place of a rule's number
JOB = f"{__name__}:run"
DURATION = 0.2  # s, in which the tip of the paper's arm moves 0.6 m
TIMEOUT = 120.0  # s; the first run of a machine compiles the loop
STEP = 1e-4  # s, of the loop
REDUNDANT_LIMIT = 1e4  # N.m, far above what three joints of the redundant arm need
DIVERGED, LOST = 1.0, 0.1  # m by which the tip misses the virtual trajectory: half the arm's reach, and a lot


@dataclass(frozen=True)
class Loop:
    """A closed loop in which a controller is tried.

    Attributes
    ----------
    system
        With components trajectory, plant and controller; the tried controller is compared with this one.
    limits
        Largest torque of each joint, N.m.
    """

    system: System
    limits: Sequence[float]


@dataclass(frozen=True)
class Ride:
    """What a run of a closed loop showed.

    Attributes
    ----------
    miss
        Largest distance of the tip from the virtual trajectory, m.
    torques
        Largest torque of each joint, N.m.
    """

    miss: float
    torques: tuple[float, ...]


def in_loop(loop_for: Callable[[int], Loop | None]) -> Trial:
    """A trial for `orchestration.check.check`: a controller drives a loop; an FMU in another role does nothing.

    Parameters
    ----------
    loop_for
        The loop by the number of joints; None where there is none for that many.
    """

    def trial(candidate: Candidate) -> tuple[list[Finding], list[str]]:
        if candidate.role.name != "controller":
            return [], []
        if candidate.failed:
            return [], ["The closed loop was not tried: there are errors."]
        loop = loop_for(candidate.count)
        if loop is None:
            return [], ["The closed loop was not tried."]
        return try_loop(candidate.path, loop, candidate.mapping)

    return trial


def paper_loop(joints: int) -> Loop | None:
    """The paper's loop for an arm of two joints or three, without noise and limits; None for more joints.

    It is the loop of Fig. 2 with the damping of Figs. 5 to 7, with which adaptive controllers are strictly
    positive real.
    """
    if joints == 2:
        chosen = VARIANTS["ideal"]
        return Loop(chosen.system(fmus(chosen.models.values())).with_sample_time(STEP), TORQUE_LIMITS)
    if joints == 3:
        models = {
            "trajectory": "VirtualTrajectory",
            "sensor": "ForceSensor",
            "controller": "HoganImpedance3R",
            "actuator": "Actuator3R",
            "plant": "Plant3R",
        }
        files = fmus(models.values())
        named = {name: files[model] for name, model in models.items()}
        system = System.connected_by_name("redundant", named, step=STEP)
        return Loop(system, (REDUNDANT_LIMIT,) * 3)
    return None


def try_loop(
    path: Path, loop: Loop, mapping: Mapping[str, str], timeout: float = TIMEOUT
) -> tuple[list[Finding], list[str]]:
    """Run a loop with its own controller and with another one, in a child process; returns findings and facts."""
    bases = {name.partition("[")[0] for name in loop.system.component("controller").description.variables}
    known = {our: their for our, their in mapping.items() if our.partition("[")[0] in bases}
    ignored = [
        note(LOOP, f"Mapping {our}={their}: the loop's own controller has no {our}; it is ignored.")
        for our, their in mapping.items()
        if our not in known
    ]
    try:
        candidate = loop.system.replace("controller", path, known)
    except OrchestrationError as refused:
        return [*ignored, error(LOOP, f"The controller does not fit into the loop: {refused}")], []
    with temporary_folder() as folder:
        (folder / "systems").write_bytes(pickle.dumps([loop.system, candidate]))
        ending = work(JOB, {"systems": str(folder / "systems")}, folder, timeout=timeout)
    rides, findings = [], ignored
    for line in ending.lines:
        if "ride" in line:
            rides.append(Ride(float(line["ride"]["miss"]), tuple(line["ride"]["torques"])))
        if "failed" in line:
            findings.append(error(LOOP, f"The loop does not run: {line['failed']}"))
    if ending.how:
        findings.append(error(LOOP, f"The process of the closed loop {ending.how}."))
    if ending.printed:
        findings.append(warning("9", f'In the loop the binary writes to standard output: "{shown(ending.printed)}".'))
    if len(rides) < 2:
        return findings, []
    return [*findings, *judge(rides[1], loop)], [_sentence(*rides)]


def run(plan: Mapping[str, Any], write: Write, announce: Announce) -> None:  # noqa: ARG001 - nothing to announce
    """The job of the child process: run both systems, and write what each run showed."""
    from orchestration.master.options import Options
    from orchestration.master.simulate import simulate

    record = [f"{n}[{i}]" for n in ("plant.x", "trajectory.x_v") for i in (1, 2)]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        # The process that started this one has written the file, and no FMU is loaded yet.
        for system in pickle.loads(Path(plan["systems"]).read_bytes()):  # noqa: S301  # nosec B301
            commands = [v.name for v in system.component("controller").description.of_causality("output")]
            commands = [name for name in commands if name.startswith("tau_cmd[")]
            columns = [*record, *(f"controller.{name}" for name in commands)]
            try:
                result = simulate(system, stop_time=DURATION, options=Options(record=columns))
            except OrchestrationError as failed:
                write(failed=str(failed))
                return
            tip, target = ([result.at_ticks(f"{n}[{i}]") for i in (1, 2)] for n in ("plant.x", "trajectory.x_v"))
            miss = max(
                ((a - b) ** 2 + (c - d) ** 2) ** 0.5
                for a, b, c, d in zip(tip[0], target[0], tip[1], target[1], strict=True)
            )
            torques = [float(abs(_in_our_unit(system, name)(result[f"controller.{name}"])).max()) for name in commands]
            write(ride={"miss": float(miss), "torques": torques})


def _in_our_unit(system: System, output: str) -> Linear:
    """The conversion of a command into the unit of the actuator, which is that of the limits."""
    ways = (c.scale for c in system.connections if (c.source, c.output) == ("controller", output))
    return next(ways, AS_IS)


def judge(ride: Ride, loop: Loop) -> list[Finding]:
    """Findings about the controller that drove a loop."""
    findings = []
    if not ride.miss < LOST:
        said = f"The tip misses the virtual trajectory by {ride.miss:.3g} m within {DURATION:g} s"
        worse = error(LOOP, f"{said}, more than {DIVERGED:g} m: the loop diverges.")
        findings.append(warning(LOOP, f"{said}, more than {LOST:g} m.") if ride.miss < DIVERGED else worse)
    for i, (torque, limit) in enumerate(zip(ride.torques, loop.limits, strict=False), start=1):
        if not torque <= limit:
            findings.append(warning(LOOP, f"tau_cmd[{i}] reaches {torque:.4g} N.m, beyond the limit {limit:g} N.m."))
    return findings


def _sentence(own: Ride, other: Ride) -> str:
    largest = " and ".join(f"{torque:.4g}" for torque in other.torques)
    return (
        f"Closed loop of {DURATION:g} s: max |x - x_v| = {other.miss:.3e} m, {own.miss:.3e} m with the loop's own"
        f" controller; max |tau_cmd| = {largest} N.m."
    )
