"""One module per tool: `TOOL`, and ``run(job)``, which imports the tool and returns a `Record`.

They import nothing of ours but `protocol` (and `peers`, where the development environment has the tool),
since a process of an environment of its own has neither casadi nor numba.
"""

from importlib import import_module
from typing import Any

KEYS = (
    "fmpy_validate",
    "fmpy_simulate",
    "fmpy_ssp",
    "ecospy",
    "ecos_cli",
    "libcosim",
    "fmuloader",
    "casadi",
    "fmutool",
    "fmucontainer",
    "fmucontainer_ssp",
    "cofmupy",
    "sofirpy",
    "pathsim",
    "syssimx",
)
"""In the order of the columns."""


def module(key: str) -> Any:
    """A tool's module by key; an unknown key is an error that lists the known ones."""
    if key not in KEYS:
        msg = f"There is no tool {key}; there are {', '.join(KEYS)}."
        raise ValueError(msg)
    return import_module(f"{__name__}.{key}")
