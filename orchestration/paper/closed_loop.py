"""Tries a controller in a closed loop: the loop must run, the tip follow its reference, torques stay within limits.

The loop's own controller makes the same run for comparison. Both runs last until the arm has touched its wall. Each is
made in a child process of its own. The process of the own controller may keep machine code in the cache; that of the
other controller gets a copy.

`in_loop` makes this the trial of `orchestration.check.check`; `paper_loop` is the loop that the command
``adaptimp check`` uses.
"""

import pickle
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from adaptimp_fmu.files.cache_folder import cache_folder
from adaptimp_fmu.files.temporary_folder import temporary_folder
from orchestration.check import Candidate, Trial
from orchestration.check.dynamic.supervision import most_memory, reaching_out
from orchestration.check.findings import Finding, error, note, shown, warning
from orchestration.check.rules import LOOP
from orchestration.errors import OrchestrationError
from orchestration.fmi.codes import BOOLEAN
from orchestration.fmi.description import read_description
from orchestration.paper.built_fmus import fmus
from orchestration.paper.numbers import TORQUE_LIMITS
from orchestration.paper.ride import DURATION, JOB, Ride
from orchestration.paper.scenarios import VARIANTS
from orchestration.sandbox.process import Ending, work
from orchestration.system.system import System

TIMEOUT = 120.0  # s; the first run of a machine compiles the loop
STEP = 1e-4  # s, of the loop
PLANE = 2  # coordinates of a position in the plane
PLANAR_POSE = 3  # joints that move a position and an angle in the plane
SPATIAL, PUMA = 6, "Puma560"  # joints, and coordinates, of the arm in space; the end of its FMUs' names
SAME_START = 1e-6  # rad
NO_LIMIT = 1e4  # N.m, far above what arms with three joints or six need here
MOST_MORE = 1.5  # of what the tip misses with the loop's own controller; without the measured force it is 1.3 there
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
    reals
        Makes the same system of FMUs with Reals in the place of Booleans, for a controller that has such Reals.
    arm
        Name of the arm, where other arms have as many joints. A controller whose inputs q start at other values than
        those of the loop's own controller is taken for one of another arm, and not tried.
    """

    system: System
    limits: Sequence[float]
    reals: Callable[[], System] | None = None
    arm: str = ""


def in_loop(loop_for: Callable[[int, int], Loop | None]) -> Trial:
    """A trial for `orchestration.check.check`: a controller drives a loop; an FMU in another role does nothing.

    Parameters
    ----------
    loop_for
        The loop by the number of joints and that of task coordinates; None where there is none for them.
    """

    def trial(candidate: Candidate) -> tuple[list[Finding], list[str]]:
        if candidate.role.name != "controller":
            return [], []
        if candidate.failed:
            return [], ["The closed loop was not tried: there are errors."]
        loop = loop_for(candidate.count, candidate.formed)
        if loop is None:
            return [], ["The closed loop was not tried."]
        if loop.arm and not _starts_there(candidate, loop):
            return [], [f"The closed loop of the {loop.arm} was not tried: the controller is for another arm."]
        return try_loop(candidate.path, loop, candidate.mapping)

    return trial


def paper_loop(joints: int, coordinates: int) -> Loop | None:
    """The loop for an arm of so many joints and task coordinates, without noise and limits; None for others.

    For two or three joints it is the loop of Fig. 2 with the damping of Figs. 5 to 7, with which adaptive controllers
    are strictly positive real. An arm of three joints may have its tip's angle as a task coordinate. For six joints
    and a task in space it is the loop of the PUMA 560 with the payload of its plant.
    """
    if (joints, coordinates) == (2, 2):
        return Loop(_planar(), TORQUE_LIMITS, lambda: _planar(reals=True))
    if joints == PLANAR_POSE:
        end, arm = "Pose" if coordinates > PLANE else "", "3R"
        limits, name = (NO_LIMIT,) * 3, "pose" if end else "redundant"
        models = (f"VirtualTrajectory{end}", f"ForceSensor{end}", f"HoganImpedance{arm}{end}", f"Actuator{arm}")
        return Loop(_connected(name, *models, f"Plant{arm}{end}"), limits)
    if (joints, coordinates) == (SPATIAL, SPATIAL):
        roles = ("VirtualTrajectory", "ForceSensor", "HoganImpedance", "Actuator", "Plant")
        return Loop(_connected("puma", *(f"{role}{PUMA}" for role in roles)), (NO_LIMIT,) * SPATIAL, arm="PUMA 560")
    return None


def _connected(name: str, *models: str) -> System:
    """The system of a trajectory, a sensor, a controller, an actuator and a plant."""
    files = fmus(models)
    components = ("trajectory", "sensor", "controller", "actuator", "plant")
    return System.connected_by_name(
        name, {component: files[model] for component, model in zip(components, models, strict=True)}, step=STEP
    )


def _starts_there(candidate: Candidate, loop: Loop) -> bool:
    """Whether the inputs q of a controller start as those of the loop's own, or have no start values of their own."""
    own, theirs = loop.system.component("controller").description, read_description(candidate.path)
    for variable in own.of_causality("input"):
        if variable.name.partition("[")[0] == "q":
            other = theirs.variables.get(candidate.mapping.get(variable.name, variable.name))
            if other is not None and other.start and abs(float(other.start) - float(variable.start or 0)) > SAME_START:
                return False
    return True


def _planar(*, reals: bool = False) -> System:
    """The loop with the arm of two joints."""
    chosen = VARIANTS["ideal"]
    return chosen.system(fmus(chosen.models.values(), reals=reals)).with_sample_time(STEP)


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
        others = loop.reals() if loop.reals is not None and _has_reals_for_booleans(path) else loop.system
        candidate = others.replace("controller", path, known)
    except OrchestrationError as refused:
        return [*ignored, error(LOOP, f"The controller does not fit into the loop: {refused}")], []
    with temporary_folder() as folder:
        own = _ride(loop.system, folder / "own", timeout, cache_folder())
        code = next((Path(line["machine_code"]) for line in own.lines if "machine_code" in line), None)
        if code is not None and code.is_dir():
            shutil.copytree(code, folder / "cache" / code.parent.name / code.name)
        ending = _ride(candidate, folder / "other", timeout, folder / "cache")
    findings = [*ignored, *reaching_out(ending)]
    if ending.printed:
        findings.append(warning("9", f'In the loop the binary writes to standard output: "{shown(ending.printed)}".'))
    if ending.how:
        when = f" {ending.function}" if ending.function else ""
        findings.append(error(LOOP, f"The process of the controller {ending.how}{shown(when)}."))
    findings += [error(LOOP, f"The loop does not run: {line['failed']}") for line in ending.lines if "failed" in line]
    usual, ride = _reported(own), _reported(ending)
    if usual is None:
        return findings, ["The closed loop was not judged: the loop's own controller could not be run."]
    if ride is None:
        return findings, []
    return [*findings, *judge(ride, loop, usual)], list(_side_by_side(ride, usual))


def _has_reals_for_booleans(path: Path) -> bool:
    """Whether an input of an FMU is a Real that stands for a Boolean."""
    return any(variable.stands_for == BOOLEAN for variable in read_description(path).of_causality("input"))


def _ride(system: System, folder: Path, timeout: float, cache: Path) -> Ending:
    """Run a system in a child process, which may change files below a folder of caches."""
    folder.mkdir()
    cache.mkdir(parents=True, exist_ok=True)
    (folder / "system").write_bytes(pickle.dumps(system))
    plan = {"system": str(folder / "system")}
    return work(JOB, plan, folder, timeout=timeout, memory=most_memory(), writable=[cache], cache=cache)


def _reported(ending: Ending) -> Ride | None:
    """The ride of a child process; None if it came to no end."""
    return next((Ride.of(line["ride"]) for line in ending.lines if "ride" in line), None)


def judge(ride: Ride, loop: Loop, usual: Ride) -> list[Finding]:
    """Findings about the controller that drove a loop, beside the ride of the loop's own controller."""
    findings = []
    said = f"The tip misses the virtual trajectory by {ride.miss:.3g} m within {DURATION:g} s"
    if not ride.miss < DIVERGED:
        findings.append(error(LOOP, f"{said}, more than {DIVERGED:g} m: the loop diverges."))
    elif not ride.miss < LOST:
        findings.append(warning(LOOP, f"{said}, more than {LOST:g} m."))
    elif not ride.miss < MOST_MORE * usual.miss:
        free = ride.miss_in_free_motion < MOST_MORE * usual.miss_in_free_motion
        where = "at the wall, not before: look at what the controller makes of F_hat" if free else "in free motion, too"
        findings.append(warning(LOOP, f"{said}, {usual.miss:.3g} m with the loop's own controller; {where}."))
    for i, (torque, limit) in enumerate(zip(ride.torques, loop.limits, strict=False), start=1):
        if not torque <= limit:
            findings.append(warning(LOOP, f"tau_cmd[{i}] reaches {torque:.4g} N.m, beyond the limit {limit:g} N.m."))
    return findings


def _side_by_side(ride: Ride, usual: Ride) -> Iterator[str]:
    """Yield sentences that show what both controllers did."""
    head = f"Closed loop of {DURATION:g} s"
    before, usually = ride.miss_in_free_motion, usual.miss_in_free_motion
    yield f"{head}: max |x - x_v| = {ride.miss:.3e} m (yours), {usual.miss:.3e} m (shipped)."
    yield f"{head}, before the wall is touched: {before:.3e} m (yours), {usually:.3e} m (shipped)."
    yield f"{head}: max |F_ext| = {ride.force:.4g} N (yours), {usual.force:.4g} N (shipped)."
    between = " and " if len(usual.torques) <= PLANE else ", "
    yours, shipped = (between.join(f"{torque:.4g}" for torque in one.torques) for one in (ride, usual))
    yield f"{head}: max |tau_cmd| = {yours} N.m (yours), {shipped} N.m (shipped)."
