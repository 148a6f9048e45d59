"""A system as one program in the forms that a benchmark calls: an FMU, a library, a module."""

import ctypes
import json
import subprocess
from pathlib import Path

import numpy as np

from orchestration.containers.c.program import c_sources, compiled_files
from orchestration.containers.fmu.write import write_fmu
from orchestration.containers.plan import plan_of
from orchestration.fmi.description import read_description
from orchestration.system.system import Component, System
from tests.benchmarks.native import HERE, compile_c
from tests.benchmarks.rig import PIECE, Rig, require


def whole_system(system: System, folder: Path) -> System:
    """A system of one component, an FMU that is the whole system; its file is written into a folder."""
    fmu = write_fmu(system, folder / f"{system.name}.fmu")
    component = Component("whole", read_description(fmu))
    return System(f"{system.name}-whole", (component,), step=system.run_step(), stop_time=system.stop_time)


def time_module(module: Path, n: int) -> np.ndarray:
    """Wall times of the pieces of n steps of a module of WebAssembly, s; a new process of node warms up before."""
    command = ["node", str(HERE / "wasm_speed.mjs"), str(module), str(n), "1", str(PIECE)]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    return np.array(json.loads(run.stdout)["seconds"][0])


class CProgram:
    """The C form of a system, compiled as FMUs are.

    Parameters
    ----------
    folder
        A folder that does not exist yet.
    """

    def __init__(self, system: System, folder: Path) -> None:
        program = plan_of(system)
        for name, text in c_sources(program).items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text, encoding="utf-8")
        sources = [HERE / "container_loop.c", *(folder / name for name in compiled_files(program))]
        given = (f"-I{folder}", f"-DSYSTEM={program.identifier}")
        self._library = compile_c(sources, folder / "container", *given)

    def time(self, n: int, rig: Rig) -> np.ndarray:
        """Measure n steps in the pieces of a rig, each made in one call."""

        def run(first: int, last: int) -> None:
            _require(self._library.container_run(ctypes.c_int64(last - first)), first)

        self._start()
        return rig.pieces(n, run)

    def time_rows(self, n: int, rig: Rig) -> np.ndarray:
        """Measure n steps in the pieces of a rig, each step alone; all outputs are recorded as the rig records them."""

        def run(first: int, last: int) -> None:
            rows = ctypes.c_void_p(rig.rows[first + 1 :].ctypes.data)
            _require(self._library.container_rows(ctypes.c_int64(last - first), rows), first)

        rig.restore()  # writes row 0
        self._start()
        return rig.pieces(n, run)

    def _start(self) -> None:
        require(bool(self._library.container_start()), "The C form cannot be initialized.")


def _require(done: int, step: int) -> None:
    require(bool(done), f"The C form failed behind step {step}.")
