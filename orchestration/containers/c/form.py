"""Writes a system as a folder of C, which any C11 compiler builds: the program, an example, a Makefile and a page."""

import importlib.resources
from pathlib import Path

from adaptimp_fmu.files.whole_file import write_whole
from orchestration.containers.c.program import FOLDER, c_sources, compiled_files, counts
from orchestration.containers.c_text import environment
from orchestration.containers.contained.foreign.adapter import ARENA
from orchestration.containers.plan import GAUSS_SEIDEL, OUTPUT, Plan, plan_of
from orchestration.errors import ContainerError
from orchestration.fmi.given import a_path
from orchestration.master.algorithm import Algorithm
from orchestration.system.system import System

MARK, MARKED = "step.h", "as one program. Generated"
"""File, and words in it, that tell a folder with an earlier program, which may be replaced."""


def write_c(system: System, folder: str | Path, algorithm: str | Algorithm = GAUSS_SEIDEL) -> Path:
    """Write a system as a folder of C files.

    Parameters
    ----------
    system
        System with a step.
    folder
        Folder that does not exist, is empty, or has an earlier program, whose files are replaced.
    algorithm
        ``gauss-seidel`` or ``jacobi``.

    Returns
    -------
    Path
        The folder.

    Raises
    ------
    ContainerError
        If the system cannot be one program, or the folder has other files.
    """
    place = a_path("The folder of a C program", folder)
    files = c_form(plan_of(system, algorithm))
    if place.exists() and not place.is_dir():
        msg = f"{place} is a file; a folder for the C program is needed."
        raise ContainerError(msg)
    if place.is_dir() and any(place.iterdir()) and not _is_program(place):
        msg = f"{place} has files that are not of a C program; choose an empty folder, or another name."
        raise ContainerError(msg)
    try:
        for name, text in files.items():
            write_whole(place / name, text.encode("utf-8", "surrogateescape"))
    except OSError as error:
        msg = f"{place}: the C program cannot be written: {error.strerror}; choose another place."
        raise ContainerError(msg) from error
    return place


def _is_program(folder: Path) -> bool:
    """Whether a folder has an earlier program; its mark is the first file that is written."""
    mark = folder / MARK
    return mark.is_file() and MARKED in mark.read_text(encoding="utf-8", errors="replace")[:1000]


def c_form(plan: Plan) -> dict[str, str]:
    """Return all files of a folder, as texts by name."""
    templates = environment()
    stop_time = plan.system.stop_time
    span = plan.step * 1000 if stop_time is None else stop_time - plan.system.start_time
    given = {
        "plan": plan,
        "id": plan.identifier,
        "system": plan.system.name,
        "folder": FOLDER,
        "sources": compiled_files(plan),
        "headers": any(fmu.fmi_headers for fmu in plan.fmus),
        "needed": sorted({function for fmu in plan.fmus for function in fmu.needed}),
        "arena": ARENA,
        "counts": counts(plan),
        "stop_steps": max(0, round(span / plan.step)),
        "start_time": plan.system.start_time,
        "changed": [v for v in plan.variables if v.role != OUTPUT and v.start != v.variable.start],
    }
    files = c_sources(plan)
    for name in ("main.c", "Makefile", "README.md"):
        files[name] = templates.get_template(f"{name}.j2").render(given)
    folder = importlib.resources.files("orchestration.containers") / "templates"
    files["hash.h"] = (folder / "hash.h").read_text(encoding="utf-8")
    return files
