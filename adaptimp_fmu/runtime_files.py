"""The files of the C runtime that is part of every FMU, and its license."""

import importlib.resources

RUNTIME_LICENSE = "runtime_license.txt"
"""File in ``sources/`` with the license of the runtime, which is part of every FMU whoever owns the model."""


def runtime_sources() -> dict[str, str]:
    """Files of the runtime by name."""
    folder = importlib.resources.files("adaptimp_fmu") / "runtime"
    names = sorted(entry.name for entry in folder.iterdir() if entry.name.endswith((".c", ".h")))
    return {name: (folder / name).read_text(encoding="utf-8") for name in names}


def runtime_license() -> str:
    """Return the license of the runtime and of this toolchain as a text.

    Examples
    --------
    >>> from adaptimp_fmu import runtime_license
    >>> runtime_license().splitlines()[0]
    'MIT License'
    """
    path = importlib.resources.files("adaptimp_fmu") / "templates" / "license.txt"
    return path.read_text(encoding="utf-8")
