"""FMU files of controllers that are not ours, from the sources beside this file and from other people's tools."""

import logging
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

from adaptimp_fmu.toolchain import fmi_headers, host_platform
from orchestration import System
from tests.untested import needs

HERE = Path(__file__).parent
HAND_WRITTEN, SLAVE = "CartesianImpedance", "ImpedanceSlave"
MAPPING = {
    "q": "JointAngle",
    "dq": "JointRate",
    "F_hat": "ContactForce",
    "x_v": "Reference",
    "dx_v": "ReferenceRate",
    "ddx_v": "ReferenceAcceleration",
    "tau_cmd": "Torque",
    "M": "TargetMass",
    "B": "Damping",
    "K": "Stiffness",
    "l": "LinkLength",
    "p_start[1]": "LinkMass[1]",
    "p_start[2]": "LinkMass[2]",
    "gravity": "Gravity",
}
"""What the hand-written one calls our variables."""
OUTPUTS = {"tau_cmd": 2, "x_t": 2, "dx_t": 2, "e": 2, "p_hat": 6}  # of a controller, with their elements
STRICT = ("-std=c11", "-O2", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-fvisibility=hidden")
Edit = Callable[[str], str]
PYTHON_BINARIES = {("linux", "x86_64"), ("win32", "AMD64")}


def compilers() -> list[str]:
    """Compilers of this machine; our own toolchain, zig, is not among them."""
    return [name for name in ("gcc", "clang") if shutil.which(name)]


def without_compiler() -> str | None:
    """Why nothing can be compiled here, None if it can."""
    return None if compilers() else needs("neither gcc nor clang is installed", "gcc")


def without_pythonfmu() -> str | None:
    """Why an export of PythonFMU cannot be made or run here, None if it can."""
    return None if find_spec("pythonfmu") else "PythonFMU has binaries for Linux and Windows on x86-64 only"


def compiled(source: str, folder: Path, compiler: str, *flags: str) -> Path:
    """The library of a controller's C source, compiled as its author would."""
    host = host_platform()
    library = folder / f"{HAND_WRITTEN}{host.extension}"
    includes = ("-I", str(fmi_headers()), "-DFMI2_FUNCTION_PREFIX=")
    command = [compiler, "-x", "c", "-", "-shared", "-fPIC", *(flags or STRICT), *includes, "-o", str(library), "-lm"]
    subprocess.run(command, input=source, check=True, capture_output=True, text=True)
    return library


def hand_written(
    folder: Path,
    source: Edit = lambda text: text,
    description: Edit = lambda text: text,
    compiler: str | None = None,
) -> Path:
    """The FMU of ``impedance.c`` and ``impedance.xml``, with what is changed in them."""
    host = host_platform()
    code = source((HERE / "impedance.c").read_text(encoding="utf-8"))
    library = compiled(code, folder, compiler or compilers()[0])
    path = folder / f"{HAND_WRITTEN}.fmu"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", description((HERE / "impedance.xml").read_text(encoding="utf-8")))
        archive.write(library, f"binaries/{host.name}/{library.name}")
    return path


def python_slave(folder: Path) -> Path:
    """The FMU of ``impedance_slave.py``; PythonFMU's exporter changes its interpreter's path, so it gets its own."""
    command = [sys.executable, "-m", "pythonfmu", "build", "-f", str(HERE / "impedance_slave.py"), "-d", str(folder)]
    subprocess.run(command, check=True, capture_output=True, text=True)
    return folder / f"{SLAVE}.fmu"


def container(system: System, path: Path, *, sequential: bool) -> Path:
    """One controller made by fmu_manipulation_toolbox of a system's trajectory and controller.

    It has the controller's inputs but for the virtual trajectory, and the system's start values.

    Parameters
    ----------
    sequential
        Whether the FMUs in it step one after the other, on the values of this step; else each sees what
        the other showed before the step.
    """
    from fmu_manipulation_toolbox.assembly import AssemblyNode

    logging.getLogger("fmu_manipulation_toolbox").setLevel(logging.CRITICAL)  # an open output is no news
    automatic = {"auto_link": False, "auto_input": False, "auto_output": False}
    node = AssemblyNode(path.name, step_size=system.run_step(), sequential=sequential, **automatic)
    for name in ("trajectory", "controller"):
        component = system.component(name)
        node.add_fmu(f"{name}.fmu", str(component.description.path))
        for variable, value in component.start.items():
            node.add_start_value(f"{name}.fmu", variable, repr(value))
    for c in system.connections:
        if c.target == "controller" and c.source == "trajectory":
            node.add_link("trajectory.fmu", c.output, "controller.fmu", c.input)
        elif c.target == "controller":
            node.add_input(c.input, "controller.fmu", c.input)
    for base, size in OUTPUTS.items():
        for name in (f"{base}[{i + 1}]" for i in range(size)):
            node.add_output("controller.fmu", name, name)
    node.make_fmu(path.parent)
    return path
