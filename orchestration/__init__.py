"""Who steps the units: systems of FMUs, masters, results.

Example::

    from orchestration import System, simulate

    system = System.read("fig2.ssp").set({"controller.K[1]": 4000.0})
    result = simulate(system, stop_time=2.0, step=1e-4)
    result["plant.x[1]"]
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from orchestration.errors import (
        ArchiveError,
        InitializationError,
        OrchestrationError,
        SimulationError,
        SystemDescriptionError,
    )
    from orchestration.master import Options, UnconnectedInputWarning, simulate
    from orchestration.result import Result
    from orchestration.system import Component, Connection, System

_HOME = {
    "ArchiveError": "errors",
    "Component": "system",
    "Connection": "system",
    "InitializationError": "errors",
    "Options": "master",
    "OrchestrationError": "errors",
    "Result": "result",
    "SimulationError": "errors",
    "System": "system",
    "SystemDescriptionError": "errors",
    "UnconnectedInputWarning": "master",
    "simulate": "master",
}

__all__ = [
    "ArchiveError",
    "Component",
    "Connection",
    "InitializationError",
    "Options",
    "OrchestrationError",
    "Result",
    "SimulationError",
    "System",
    "SystemDescriptionError",
    "UnconnectedInputWarning",
    "simulate",
]


def __getattr__(name: str) -> Any:
    """Import on first use: the command line's help needs none of numba and fmpy."""
    if name not in _HOME:
        msg = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(msg)
    value = getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value
