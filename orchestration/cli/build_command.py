"""Defines the command ``adaptimp build``: its options and the end of its help."""

from pathlib import Path
from typing import Annotated

import typer

from orchestration.cli.program import closing

ROBOT = "A robot of your own"
EPILOG = closing(
    "adaptimp build mine.py -o built --verbose",
    "adaptimp build --robot arm.urdf --tip tool -o arm",
)


def build(
    files: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="FILE.py",
            help="Python files that declare models, or names of shipped models and their variants.",
            show_default="every model",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            metavar="FOLDER",
            help="Folder for the .fmu files.",
            show_default="build/fmus; build/reals with --reals; build/robot with --robot",
        ),
    ] = None,
    platform: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="Platform of the binaries, repeatable; 'all' for every one.",
            show_default="this machine",
        ),
    ] = None,
    reals: Annotated[
        bool,
        typer.Option(
            "--reals",
            help="Make Booleans Reals of 0 and 1, and Integers Reals of whole numbers, for tools that know Reals only;"
            " the files have the same names.",
        ),
    ] = False,
    robot: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.urdf",
            help="Build plant, sensor, actuators, trajectory and controllers of this arm of six joints or more, and a"
            " package that couples them.",
            rich_help_panel=ROBOT,
        ),
    ] = None,
    tip: Annotated[
        str | None,
        typer.Option(metavar="LINK", help="Link at the end of the arm: the tool.", rich_help_panel=ROBOT),
    ] = None,
    base: Annotated[
        str | None,
        typer.Option(
            metavar="LINK",
            help="Link that does not move.",
            show_default="the root of the file",
            rich_help_panel=ROBOT,
        ),
    ] = None,
    hold: Annotated[
        list[str] | None,
        typer.Option(
            metavar="JOINT=Q",
            help="A joint that is held, and where, rad or m, such as a finger of a gripper; repeatable.",
            rich_help_panel=ROBOT,
        ),
    ] = None,
    start: Annotated[
        str | None,
        typer.Option(
            metavar="Q1,Q2,...",
            help="Joint coordinates at the start, rad or m, from the base on. The tip begins there on the top of an"
            " ellipse that reaches into a table.",
            show_default="a posture is chosen",
            rich_help_panel=ROBOT,
        ),
    ] = None,
    payload: Annotated[
        float,
        typer.Option(metavar="KG", help="Mass at the tip that the controllers do not know, kg.", rich_help_panel=ROBOT),
    ] = 0.0,
    rotor: Annotated[
        list[str] | None,
        typer.Option(
            metavar="JOINT=KG.M2",
            help="Inertia of a motor's rotor as seen at its joint, which a URDF lacks; repeatable. A number without a"
            " joint is for all of them.",
            show_default="none",
            rich_help_panel=ROBOT,
        ),
    ] = None,
) -> None:
    """Build the FMUs of the catalog, of your own models, or of a robot; binaries that exist come from the cache."""
    if robot is not None:
        from orchestration.cli.robot_build import RobotRequest, build_robot, require_no_models

        require_no_models(files or [])
        request = RobotRequest(robot, tip, base, tuple(hold or ()), start, payload, tuple(rotor or ()))
        build_robot(request, out or Path("build/robot"), platform or [], reals=reals)
        return
    from orchestration.cli.commands import build_fmus, require_no_robot

    require_no_robot(
        {"--tip": tip, "--base": base, "--hold": hold, "--start": start, "--payload": payload, "--rotor": rotor}
    )
    build_fmus(files or [], out or Path("build/reals" if reals else "build/fmus"), platform or [], reals=reals)
