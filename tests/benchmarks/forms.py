"""A system as one program in the forms that a benchmark calls: the C form as a library in this process, and an FMU."""

import ctypes
from pathlib import Path

import numpy as np

from orchestration.containers.c_program import c_sources, compiled_files
from orchestration.containers.fmu import write_fmu
from orchestration.containers.plan import plan_of
from orchestration.fmi.description import read_description
from orchestration.system.system import Component, System
from tests.benchmarks.native import HERE, compile_c
from tests.benchmarks.rig import Rig, require


def whole_system(system: System, folder: Path) -> System:
    """A system of one component, an FMU that is the whole system; its file is written into a folder."""
    fmu = write_fmu(system, folder / f"{system.name}.fmu")
    component = Component("whole", read_description(fmu))
    return System(f"{system.name}-whole", (component,), step=system.run_step(), stop_time=system.stop_time)


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
        self._library.container_state_size.restype = ctypes.c_int64

    @property
    def state_size(self) -> int:
        """Bytes of the system's state."""
        return self._library.container_state_size()

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
