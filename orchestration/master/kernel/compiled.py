"""Decorators that compile the functions of the loops, and keep machine code that is never older than its source.

    compiled               called from Python: compiled once for each kind of arguments, and kept
    compiled_for_callers   called from compiled functions only: a part of their machine code
    compiled_in_place      the same, for a large function that is called in one place
    compiled_with_caller   called from both; from Python it is not compiled, and an FMU is called through ctypes

Machine code is kept in a folder named by the hash of all sources, see `orchestration.fmi.machine_code`. With
NUMBA_DISABLE_JIT=1 nothing is compiled, and everything runs as plain Python.

The functions neither allocate memory nor refer to Python objects, so numba is told not to count references. Parts
have no entry for Python. Both together save a third of the time of compilation.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit
from numba.extending import register_jitable

from orchestration.fmi.kept_code import keep_machine_code
from orchestration.fmi.machine_code import code_folder
from orchestration.fmi.native_calls import SOURCES

Function = TypeVar("Function", bound=Callable[..., Any])

_OPTIONS = {"nogil": True, "error_model": "numpy", "_nrt": False}
_PART = {**_OPTIONS, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
_CALLED_FROM_PYTHON: list[Any] = []
FOLDER = code_folder([*Path(__file__).parent.glob("*.py"), Path(__file__), *SOURCES])


def compiled(function: Function) -> Function:
    """Compile a function that Python calls; its machine code is kept."""
    kept = keep_machine_code(njit(**_OPTIONS)(function), function, FOLDER)
    _CALLED_FROM_PYTHON.append(kept)
    return kept


def compilations() -> int:
    """Return how often this process has compiled a function that Python calls, instead of loading its machine code."""
    return sum(sum(f.stats.cache_misses.values()) for f in _CALLED_FROM_PYTHON if hasattr(f, "stats"))


def compiled_for_callers(function: Function) -> Function:
    """Compile a function as a part of compiled functions that call it."""
    return cast("Function", njit(**_PART)(function))


def compiled_in_place(function: Function) -> Function:
    """Compile a function in the place where a compiled function calls it, and nowhere else."""
    return cast("Function", njit(inline="always", **_PART)(function))


def compiled_with_caller(function: Function) -> Function:
    """Let compiled functions compile a function as a part of their own; Python calls it as it is."""
    return cast("Function", register_jitable(**_PART)(function))
