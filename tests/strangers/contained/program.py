"""Compiles the C program of a system into a library of this machine, and runs it through ctypes."""

import ctypes
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from adaptimp_fmu.toolchain import fmi_headers, host_platform
from orchestration import System
from orchestration.containers.c.program import c_sources, compiled_files
from orchestration.containers.contained.foreign.compiler import write_below
from orchestration.containers.plan import Plan, plan_of

ZIG = (sys.executable, "-m", "ziglang", "cc")
QUICKEST = ("gcc",) if shutil.which("gcc") else ZIG
"""Compiler for tests in which any compiler will do; zig takes seconds."""
FLAGS = ("-std=c11", "-O1", "-ffp-contract=off", "-fno-math-errno", "-shared", "-fPIC")
_SHIM = """
#include <stdlib.h>
#include "step.h"
{ID}_System *make(void) {{ return calloc(1, sizeof({ID}_System)); }}
void discard({ID}_System *s) {{ {FREE} free(s); }}
void reset({ID}_System *s) {{ {ID}_reset(s); }}
int set({ID}_System *s, unsigned v, double x, Failure *f) {{ return {ID}_set(s, v, x, f); }}
double get({ID}_System *s, unsigned v) {{ return {ID}_get(s, v); }}
int initialize({ID}_System *s, double t, Failure *f) {{ return {ID}_initialize(s, t, f); }}
int step({ID}_System *s, unsigned long long n, Failure *f) {{ return {ID}_step(s, n, f); }}
{MORE}
"""


class _Argument(ctypes.Structure):
    _fields_ = [("kind", ctypes.c_char), ("number", ctypes.c_double), ("text", ctypes.c_char_p)]


class _Failure(ctypes.Structure):
    _fields_ = [
        ("component", ctypes.c_char_p),
        ("sentence", ctypes.c_char_p),
        ("n", ctypes.c_int),
        ("arguments", _Argument * 6),
    ]

    def __str__(self) -> str:
        sentence = self.sentence.decode()
        used = len(re.findall("%[^%]", sentence.replace("%%", "")))  # printf leaves out the arguments behind
        values = [a.text.decode() if a.kind == b"s" else a.number for a in self.arguments[:used]]
        name = "" if self.component is None else f"{self.component.decode()}: "
        return name + sentence % tuple(values)


class FailedError(Exception):
    """A function of the program returned 0; the text is the failure's."""


class Program:
    """A compiled program and one state of its system.

    Parameters
    ----------
    more
        More C functions for the library, which can use ``step.h``.
    compiler, flags
        Command of the compiler, and more flags.
    """

    def __init__(
        self,
        system: System,
        folder: Path,
        *,
        algorithm: str = "gauss-seidel",
        more: str = "",
        compiler: Sequence[str] = QUICKEST,
        flags: Sequence[str] = (),
    ) -> None:
        self.plan: Plan = plan_of(system, algorithm)
        write_below(folder, c_sources(self.plan))
        owned = [m for m in self.plan.members if not m.fmu.plain]
        free = " ".join(f"{m.fmu.name}_free(&s->{m.field});" for m in owned)
        shim = _SHIM.format(ID=self.plan.identifier, FREE=free, MORE=more)
        (folder / "shim.c").write_text(shim, encoding="utf-8")
        output = folder / f"program{host_platform().extension}"
        headers = ("-I", str(fmi_headers())) if any(fmu.fmi_headers for fmu in self.plan.fmus) else ()
        own = ["-fno-sanitize=all"] if compiler == ZIG else []
        files = [*compiled_files(self.plan), "shim.c"]
        command = [*compiler, *FLAGS, *own, *flags, *headers, *files, "-o", str(output), "-lm"]
        subprocess.run(command, cwd=folder, check=True)
        self.library = ctypes.CDLL(str(output))
        self.library.make.restype = ctypes.c_void_p
        self.library.get.restype = ctypes.c_double
        self.library.get.argtypes = (ctypes.c_void_p, ctypes.c_uint)
        self.library.set.argtypes = (ctypes.c_void_p, ctypes.c_uint, ctypes.c_double, ctypes.c_void_p)
        self.library.initialize.argtypes = (ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p)
        self.library.step.argtypes = (ctypes.c_void_p, ctypes.c_ulonglong, ctypes.c_void_p)
        for function in (self.library.reset, self.library.discard):
            function.argtypes, function.restype = (ctypes.c_void_p,), None
        self.numbers = {v.path: i for i, v in enumerate(self.plan.variables)}
        self.state: int = self.library.make()
        self.reset()

    @property
    def state_pointer(self) -> ctypes.c_void_p:
        """The state, for functions of `more`."""
        return ctypes.c_void_p(self.state)

    def close(self) -> None:
        """Free the instances of FMUs, and the state."""
        self.library.discard(self.state)

    def reset(self) -> None:
        """Every value at its start."""
        self.library.reset(self.state)

    def set(self, values: Mapping[str, float]) -> None:
        """Set parameters and inputs by name."""
        for name, value in values.items():
            self._require(self.library.set, self.numbers[name], value)

    def initialize(self, start_time: float = 0.0) -> None:
        """Initialize the system."""
        self._require(self.library.initialize, start_time)

    def step(self, n: int = 1) -> None:
        """Make n inner steps."""
        self._require(self.library.step, n)

    def outputs(self) -> np.ndarray:
        """All outputs in the program's order."""
        return np.array([self.get(name) for name in self.output_names])

    def get(self, name: str) -> float:
        """A variable by name."""
        return self.library.get(self.state, self.numbers[name])

    @property
    def output_names(self) -> list[str]:
        """Names of all outputs."""
        return [v.path for v in self.plan.variables if v.role == "OUTPUT"]

    def run(self, steps: int, n: int = 1) -> dict[str, np.ndarray]:
        """Rows of all outputs at every n-th step, row 0 included, by name."""
        self.initialize()
        rows = [self.outputs()]
        for _ in range(steps // n):
            self.step(n)
            rows.append(self.outputs())
        return dict(zip(self.output_names, np.transpose(rows), strict=True))

    def _require(self, function: Callable[..., int], *arguments: float) -> None:
        failure = _Failure()
        if function(self.state, *arguments, ctypes.byref(failure)) != 1:
            raise FailedError(str(failure))
