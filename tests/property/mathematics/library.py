"""Compiles the runtime's mathematics: as a library for Python, and as a program that prints hashes."""

import ctypes
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

SOURCE = Path(__file__).with_name("functions.c")
RUNTIME = Path(__file__).parents[3] / "adaptimp_fmu" / "runtime"
STRICT = ("-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror")
ZIG = (sys.executable, "-m", "ziglang", "cc", "-fno-sanitize=all")
HASHED = 20_000
"""Arguments of each function behind a hash."""


class Mathematics:
    """The functions of ``mathematics.h``, for arrays.

    Parameters
    ----------
    folder
        A folder for the library.
    sources
        Folder with ``mathematics.h``.
    """

    def __init__(self, folder: Path, sources: Path = RUNTIME) -> None:
        path = folder / "mathematics.so"
        compile_functions(path, (*ZIG, "-O1"), "-shared", "-fPIC", sources=sources)
        self._library = ctypes.CDLL(str(path))
        self._library.function_name.restype = ctypes.c_char_p
        self._numbers: dict[str, int] = {}
        while name := self._library.function_name(len(self._numbers)):
            self._numbers[name.decode()] = len(self._numbers)

    @property
    def names(self) -> list[str]:
        """The names of the functions."""
        return list(self._numbers)

    def __call__(self, name: str, x: np.ndarray, y: np.ndarray | None = None) -> np.ndarray:
        """The values of a function at arguments of shape (n,)."""
        first = np.ascontiguousarray(x, dtype=float)
        second = np.ascontiguousarray(np.zeros_like(first) if y is None else y, dtype=float)
        result = np.empty_like(first)
        addresses = [ctypes.c_void_p(array.ctypes.data) for array in (first, second, result)]
        self._library.evaluate(self._numbers[name], *addresses, len(first))
        return result


def compile_functions(output: Path, compiler: Sequence[str], *flags: str, sources: Path = RUNTIME) -> None:
    """Compile functions.c.

    Raises
    ------
    RuntimeError
        With the compiler's messages.
    """
    command = [*compiler, *STRICT, *flags, "-I", str(sources), str(SOURCE), "-o", str(output)]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        raise RuntimeError(f"{' '.join(command)}:\n{run.stderr}")


def hashes(program: Path, launcher: Sequence[str] = (), environment: Mapping[str, str] | None = None) -> dict[str, str]:
    """What the program says of each function."""
    run = subprocess.run([*launcher, str(program)], capture_output=True, text=True, check=True, env=environment)
    return dict(line.split() for line in run.stdout.splitlines())
