"""Refuses a run whose rows do not fit into the memory of the machine, before anything is allocated."""

import os

from orchestration.errors import SystemDescriptionError

_UNITS = ("bytes", "kB", "MB", "GB", "TB", "PB", "EB")


def machine_memory() -> float:
    """Memory of the machine in bytes; infinite where the system does not say."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):  # Windows
        return float("inf")


def require_memory(name: str, n_steps: float, n_rows: float, n_columns: int) -> None:
    """Refuse what cannot fit: 8 bytes for each communication point, and for each number of each row.

    Parameters
    ----------
    name
        Name of the system, for the message.
    n_rows
        Number of rows that stay in memory.
    n_columns
        Number of recorded outputs.

    Raises
    ------
    SystemDescriptionError
        Naming steps, rows and both sizes.
    """
    needed, present = 8.0 * (n_steps + n_rows * (n_columns + 1)), machine_memory()
    if needed > present:
        rows = f" with {n_rows:.3g} rows of {n_columns} outputs" if n_columns else ""
        msg = (
            f"System {name}: {n_steps:.3g} steps{rows} need {_size(needed)} of memory, the machine has"
            f" {_size(present)}; use a larger step, or record fewer outputs or rows."
        )
        raise SystemDescriptionError(msg)


def require_matrix(name: str, n: int) -> None:
    """Refuse Newton's method on so many inputs that their Jacobian, 8 bytes for each pair, cannot fit.

    Parameters
    ----------
    name
        Name of the system, for the message.
    n
        Number of corrected inputs.

    Raises
    ------
    SystemDescriptionError
        Naming the number and both sizes.
    """
    needed, present = 8.0 * n * (n + 1), machine_memory()
    if needed > present:
        msg = (
            f"System {name}: the Jacobian of {n} corrected inputs needs {_size(needed)} of memory, the machine has"
            f" {_size(present)}; use the algorithm iterative."
        )
        raise SystemDescriptionError(msg)


def _size(n_bytes: float) -> str:
    """A number of bytes with a prefix."""
    power = 0
    while n_bytes >= 1000 and power < len(_UNITS) - 1:
        n_bytes, power = n_bytes / 1000, power + 1
    return f"{n_bytes:.3g} {_UNITS[power]}"
