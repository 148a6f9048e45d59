"""C programs that the master's speed is compared with; they are compiled with the flags of the FMUs.

The bare functions come from the FMUs' own ``sources/``: each FMU is compiled with ``bare_unit.c``
in place of its runtime.
"""

import ctypes
import subprocess
import sys
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from zipfile import ZipFile

import numpy as np

from adaptimp_fmu.errors import ToolchainError
from adaptimp_fmu.toolchain import FLAGS, host_platform
from orchestration.master.kernel.flat_system import Plan

HERE = Path(__file__).parent
COMPONENTS = ("trajectory", "sensor", "controller", "actuator", "plant")  # the order in bare.c
_UNIT = """#define NAME(x) {name}_##x
#define CASADI_CODEGEN_PREFIX
#define CODEGEN_PREFIX {name}_
#include "{name}/model.c"
"""
_I64, _F64, _I32, _POINTER = ctypes.c_int64, ctypes.c_double, ctypes.c_int32, ctypes.c_void_p


class _PlanStruct(ctypes.Structure):
    """``Plan`` of loop.c."""

    _fields_ = (
        ("operations", _POINTER),
        ("n_operations", _I64),
        ("reals", _POINTER),
        ("discretes", _POINTER),
        ("recorded_reals", _POINTER),
        ("recorded_discretes", _POINTER),
        ("n_recorded_reals", _I64),
        ("n_recorded_discretes", _I64),
        ("n_columns", _I64),
    )


class BareUnits:
    """The generated functions of the five FMUs, called by a C loop without FMI.

    Parameters
    ----------
    fmus
        The FMU of each of `COMPONENTS`.
    saturation
        Whether the controller has the inputs ``saturated``.
    folder
        A scratch folder.
    """

    def __init__(self, fmus: Mapping[str, Path], saturation: bool, folder: Path) -> None:
        for name in COMPONENTS:
            member = folder / name
            member.mkdir()
            with ZipFile(fmus[name]) as archive:
                for entry in archive.namelist():
                    folder_of, _, file = entry.partition("/")
                    if folder_of == "sources" and (file == "model.c" or file.endswith(".h")):
                        (member / file).write_bytes(archive.read(entry))
            (member / "runtime.c").write_bytes((HERE / "bare_unit.c").read_bytes())
            (folder / f"{name}.c").write_text(_UNIT.format(name=name), encoding="utf-8")
        sources = [HERE / "bare.c", *(folder / f"{name}.c" for name in COMPONENTS)]
        self._library = compile_c(sources, folder / "bare", f"-DCONTROLLER_SEES_SATURATION={saturation:d}")
        self._library.bare_outputs.restype = ctypes.POINTER(_F64)

    def start(self, values: Mapping[str, np.ndarray], t0: float) -> None:
        """Go to the start; `values` are all variables of each FMU, by value reference."""
        for i, name in enumerate(COMPONENTS):
            self._library.bare_start(_I64(i), _address(values[name]), _F64(t0))

    def run(self, times: np.ndarray, h: float, first: int, last: int) -> None:
        """Make the steps first to last - 1."""
        self._library.bare_run(_address(times), _F64(h), _I64(first), _I64(last))

    def copy(self, n: int) -> None:
        """Make the copies of a step from outputs to inputs n times."""
        self._library.bare_copies(_I64(n))

    def replay(self, name: str, times: np.ndarray, h: float, inputs: np.ndarray, step: bool) -> None:
        """Copy the given rows of inputs to one FMU; with `step`, step it after each."""
        index, count = _I64(COMPONENTS.index(name)), _I64(len(inputs))
        self._library.bare_replay(index, _address(times), _F64(h), count, _address(inputs), _I32(step))

    def outputs(self, name: str, count: int) -> np.ndarray:
        """The outputs an FMU shows now, shape (count,)."""
        pointer = self._library.bare_outputs(_I64(COMPONENTS.index(name)))
        return np.ctypeslib.as_array(pointer, (count,)).copy()


class CLoop:
    """The loop of the fixed-step algorithms in C.

    Parameters
    ----------
    plan
        Addresses and buffers; must outlive this object.
    operations
        Those of a step; must outlive it, too.
    n_columns
        Width of a row of records.
    """

    def __init__(self, plan: Plan, operations: np.ndarray, n_columns: int) -> None:
        self._library = _loop_library()
        self._arrays = plan
        self._plan = _PlanStruct(
            *(_address(operations), len(operations)),
            *(_address(plan.reals), _address(plan.discretes)),
            *(_address(plan.recorded_reals), _address(plan.recorded_discretes)),
            *(len(plan.recorded_reals), len(plan.recorded_discretes), n_columns),
        )

    def run(self, grid: tuple[np.ndarray, float], span: tuple[int, int], rows: np.ndarray, every: int) -> int:
        """Make the steps span[0] to span[1] - 1 at times and with a step in s; returns the fmi2Status.

        A row is filled after each step k for which k + 1 is a multiple of `every`.
        """
        plan, (times, h) = ctypes.byref(self._plan), grid
        return self._library.fmi_run(
            plan, _address(times), _F64(h), _I64(span[0]), _I64(span[1]), _address(rows), _I64(every)
        )

    def copy(self, n: int, rows: np.ndarray, links: bool, records: bool) -> None:
        """Make the copies of a step n times: those of the links, and of the records into rows."""
        self._library.fmi_copies(ctypes.byref(self._plan), _I64(n), _address(rows), _I32(links), _I32(records))

    def replay(
        self, i: int, grid: tuple[np.ndarray, float], inputs: tuple[np.ndarray, np.ndarray], calls: Sequence[bool]
    ) -> int:
        """Make the calls (set, step, get) of component i with the given rows of Real and Boolean inputs."""
        times, h = grid
        return self._library.fmi_replay(
            _address(self._arrays.table[i]),
            *(_address(times), _F64(h), _I64(len(times)), *map(_address, inputs)),
            *(_I32(call) for call in calls),
        )


@cache
def _loop_library() -> ctypes.CDLL:
    """loop.c, compiled once per process; it stays loaded when its file is gone."""
    with TemporaryDirectory(prefix="benchmark-", ignore_cleanup_errors=True) as folder:
        return compile_c([HERE / "loop.c"], Path(folder) / "loop")


def _address(array: np.ndarray) -> Any:
    return ctypes.c_void_p(array.ctypes.data)


def compile_c(sources: Sequence[Path], output: Path, *flags: str) -> ctypes.CDLL:
    """Compile C files into one library, as the toolchain does with an FMU, and load it."""
    target = host_platform()
    library = output.with_suffix(target.extension)
    command = [
        *(sys.executable, "-m", "ziglang", "cc", "-shared", "-target", target.target),
        *(*FLAGS, *target.flags, *flags, *map(str, sources), "-o", str(library)),
    ]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        msg = f"{output.name} does not compile:\n{run.stderr.strip()}"
        raise ToolchainError(msg)
    return ctypes.CDLL(str(library))
