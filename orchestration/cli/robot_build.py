"""Builds the FMUs of an arm from its URDF file, and a package that couples them: ``adaptimp build --robot``."""

import math
import re
import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from adaptimp_fmu.files.parts import imported
from orchestration.cli.commands import build_models, chosen_platforms
from orchestration.cli.output import output, watched
from orchestration.cli.places import require_folder, written
from orchestration.errors import SystemDescriptionError
from orchestration.system.system import System

if TYPE_CHECKING:
    from adaptimp_fmu import Model
    from fmus.robots.spatial_robot import SpatialRobot

COMPONENTS = {
    "trajectory": ("VirtualTrajectory",),
    "sensor": ("ForceSensor",),
    "controller": ("SlotineLiAdaptiveImpedance", "HoganImpedance"),
    "actuator": ("Actuator",),
    "plant": ("Plant",),
}
"""Components of the package in the order of stepping, each with its models, the first choice first."""
STEP = 1e-4  # s: the sampling period of all units, of which a step must not be longer
STOP_TIME = 2.0  # s: one turn


@dataclass(frozen=True)
class RobotRequest:
    """An arm for which FMUs are built.

    Attributes
    ----------
    file
        URDF file.
    tip, base
        Links at the ends of the arm; without a base it is the root of the file.
    hold
        Texts JOINT=Q: joints that are held, and where, rad or m.
    start
        Joint coordinates at the start with commas, rad or m; None lets them be chosen.
    payload
        Mass at the tip, kg.
    rotor
        Texts JOINT=INERTIA or INERTIA: inertia of the rotors as seen at the joints, kg m2 or kg.
    """

    file: Path
    tip: str | None
    base: str | None = None
    hold: Sequence[str] = ()
    start: str | None = None
    payload: float = 0.0
    rotor: Sequence[str] = ()

    def robot(self) -> "SpatialRobot":
        """Read the arm, and find its posture and its ellipse.

        Raises
        ------
        SystemDescriptionError
            If an option cannot be understood, or the file describes no arm that can be used.
        """
        urdf_robot, urdf = imported("fmus.robots.urdf_robot"), imported("fmus.robots.urdf")
        held = {name: _number(f"--hold {name}={text}", text) for name, text in map(_HOLD, self.hold)}
        start = None if self.start is None else _numbers(f"--start {self.start}", self.start)
        if not (math.isfinite(self.payload) and self.payload >= 0):
            msg = f"--payload {self.payload:g}: the mass at the tip must be finite and at least 0 kg."
            raise SystemDescriptionError(msg)
        try:
            if self.tip is None:
                last = urdf.last_links(self.file)
                found = f"links that carry no other one: {', '.join(last)}" if last else "the file has no such link"
                msg = f"--robot {self.file} needs --tip, the link at the end of the arm; {found}."
                raise SystemDescriptionError(msg)
            return urdf_robot.robot_of_urdf(
                self.file,
                self.tip,
                base=self.base,
                locked=held,
                start=start,
                payload=self.payload,
                rotor=_rotors(self.rotor),
            )
        except imported("fmus.robots.table_path").NoPathError as error:
            give = "Give other joint coordinates" if self.start else "Give joint coordinates for the start"
            msg = f"--robot {self.file}: {error}. {give}: --start Q1,Q2,... in rad or m."
            raise SystemDescriptionError(msg) from error
        except imported("fmus.mechanics.rigid_body").RobotError as error:
            msg = f"--robot: {_in_options(str(error))}"
            raise SystemDescriptionError(msg) from error


def require_no_models(files: Sequence[Path]) -> None:
    """Refuse names of models beside a robot.

    Raises
    ------
    SystemDescriptionError
        If there are some.
    """
    if files:
        msg = f"--robot builds the models of an arm, and {files[0]} is another one; build them in two commands."
        raise SystemDescriptionError(msg)


def build_robot(request: RobotRequest, out: Path, platforms: Sequence[str], *, reals: bool = False) -> None:
    """Build the FMUs of an arm and the package of its contact task into a folder, and say how to run it.

    Controllers that the arm cannot have are named with the reason.

    Raises
    ------
    SystemDescriptionError
        If the arm cannot be read, or no task fits; the message says where and why.
    OrchestrationError
        If an FMU cannot be built or written.
    """
    chosen = chosen_platforms(platforms)
    with watched() as line:
        line.begin(f"reading {request.file} and choosing a posture")
        robot = request.robot()
        line.end()
    suffix = _suffix(request, robot)
    models, refused = _models(robot, suffix)
    require_folder(out)
    output.say("\n".join(_facts(robot)))
    with watched() as line:
        files = build_models(models, out, chosen, line, reals=reals)
    for reason in refused:
        output.say(f"left out: {reason}")
    package = out / f"{suffix}.ssp"
    existed = package.exists()
    system = System.connected_by_name(suffix, _components(files, suffix), step=STEP, stop_time=STOP_TIME)
    system.write(package)
    output.say(f"{written(package, existed=existed)}: {STOP_TIME:g} s with {system['controller'].path.stem}")
    output.say("Next:")
    for command in _next(package, files, system["controller"].path):
        output.say(f"  {shlex.join(command)}")


def _suffix(request: RobotRequest, robot: "SpatialRobot") -> str:
    """What the names of the models end with.

    Raises
    ------
    SystemDescriptionError
        If the name of the robot gives none, or shipped models have these names.
    """
    from fmus.catalog import MODELS, UNITS_OF_ARM, VARIANTS

    try:
        suffix = imported("fmus.robots.urdf_robot").suffix_of(robot.chain.name)
    except imported("fmus.mechanics.rigid_body").RobotError as error:
        msg = f"--robot {request.file}: {error}"
        raise SystemDescriptionError(msg) from error
    shipped = {name.lower(): name for name in (*MODELS, *VARIANTS)}
    for unit in UNITS_OF_ARM:
        same = shipped.get(f"{unit}{suffix}".lower())
        if same is not None:
            msg = (
                f"--robot {request.file}: the robot {robot.chain.name} would give a model the name of {same}, which is"
                ' shipped; give it another one: <robot name="...">.'
            )
            raise SystemDescriptionError(msg)
    return suffix


def _models(robot: "SpatialRobot", suffix: str) -> "tuple[list[Model], list[str]]":
    """The models of an arm, and the reasons for those that it cannot have."""
    from adaptimp_fmu import DefinitionError
    from fmus.catalog import UNITS_OF_ARM, unit_of_arm

    models, refused = [], []
    for unit in UNITS_OF_ARM:
        try:
            models.append(unit_of_arm(unit, robot, suffix))
        except DefinitionError as error:
            refused.append(str(error))
    return models, refused


def _components(files: Mapping[str, Path], suffix: str) -> dict[str, Path]:
    """The FMUs of the package by the names of the components."""
    return {
        component: next(files[f"{unit}{suffix}"] for unit in units if f"{unit}{suffix}" in files)
        for component, units in COMPONENTS.items()
    }


def _facts(robot: "SpatialRobot") -> list[str]:
    """What was read and chosen, in words."""
    chain, path = robot.chain, robot.path
    kinds = [
        f"{joint.name} {round(q, 3) + 0.0:.3f} {'rad' if joint.turns else 'm'}"
        for joint, q in zip(chain.joints, robot.start.q, strict=True)
    ]
    center, axes = (", ".join(f"{value:g}" for value in values) for values in (path.center, path.semi_axis))
    held = f", {robot.payload.mass:g} kg at the tip" if robot.payload.mass else ""
    return [
        f"{chain.name}: {chain.n} joints from {chain.base_name} to {chain.tip_name}{held}",
        f"start: {', '.join(kinds)}",
        f"ellipse: center ({center}) m, semi-axes {axes} m; table at a height of {-path.wall_offset:g} m",
    ]


def _next(package: Path, files: Mapping[str, Path], controller: Path) -> list[list[str]]:
    """Commands that run the package, and again with another controller."""
    run = ["adaptimp", "run", str(package)]
    others = [path for name, path in files.items() if "Impedance" in name and path != controller]
    picture = [*run, "--plot", str(package.with_suffix(".png"))]
    return [picture, *([*run, "--controller", str(path)] for path in others[:1])]


def _in_options(sentence: str) -> str:
    """A sentence that names arguments of Python, such as ``locked={'finger': 0.0}``, with options in their place."""
    return re.sub(
        r"(locked|rotor)=\{'(.+?)': ([^}]+)\}", lambda found: f"{_OPTIONS[found[1]]} {found[2]}={found[3]}", sentence
    )


def _rotors(texts: Sequence[str]) -> Mapping[str, float] | float:
    """Inertias of rotors by their joints, or one for all."""
    if len(texts) == 1 and "=" not in texts[0]:
        return _number(f"--rotor {texts[0]}", texts[0], _OF_ROTOR)
    return {name: _number(f"--rotor {name}={text}", text, _OF_ROTOR) for name, text in map(_ROTOR, texts)}


def _joint_and_number(option: str, needed: str) -> Callable[[str], tuple[str, str]]:
    """A function that splits a text JOINT=NUMBER; the name of a joint may have blanks, as URDF allows, and ``=``."""

    def split(text: str) -> tuple[str, str]:
        name, _, number = text.rpartition("=")
        if not name.strip():
            msg = f"{option} {text}: {needed}."
            raise SystemDescriptionError(msg)
        return name, number

    return split


_OPTIONS = {"locked": "--hold", "rotor": "--rotor"}
_OF_JOINT, _OF_ROTOR = "rad or m", "kg m2 or kg"
_ROTOR = _joint_and_number("--rotor", f"JOINT=INERTIA is needed, or one inertia for all joints, in {_OF_ROTOR}")
_HOLD = _joint_and_number("--hold", f"a joint and where it is held are needed: JOINT=Q, in {_OF_JOINT}")


def _numbers(option: str, text: str) -> list[float]:
    """Finite numbers of an option, with commas between them."""
    if len(text.split()) > 1 and "," not in text:
        msg = f"{option}: the numbers need commas between them: {','.join(text.split())}."
        raise SystemDescriptionError(msg)
    return [_number(option, part) for part in text.split(",")]


def _number(option: str, text: str, unit: str = _OF_JOINT) -> float:
    """A finite number of an option."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        what = repr(text.strip()) if text.strip() else "an empty place"
        msg = f"{option}: {what} is not a finite number; give numbers in {unit}."
        raise SystemDescriptionError(msg)
    return value
