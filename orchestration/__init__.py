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
    from orchestration.algorithm import Algorithm, Correction, StepControl, Tolerance
    from orchestration.energy import Ledger, PowerBond, ledger
    from orchestration.errors import (
        ArchiveError,
        InitializationError,
        OrchestrationError,
        RunInterrupted,
        SimulationError,
        SystemDescriptionError,
    )
    from orchestration.layout import Crossings
    from orchestration.master import UnconnectedInputWarning, prepare, simulate, stream
    from orchestration.options import Options
    from orchestration.result import Result
    from orchestration.simulation import Simulation
    from orchestration.snapshot import Snapshot
    from orchestration.stability import Verdict
    from orchestration.system import Component, Connection, System

_HOME = {
    "Algorithm": "algorithm",
    "ArchiveError": "errors",
    "Component": "system",
    "Connection": "system",
    "Correction": "algorithm",
    "Crossings": "layout",
    "InitializationError": "errors",
    "Ledger": "energy",
    "Options": "options",
    "OrchestrationError": "errors",
    "PowerBond": "energy",
    "Result": "result",
    "RunInterrupted": "errors",
    "Simulation": "simulation",
    "SimulationError": "errors",
    "Snapshot": "snapshot",
    "StepControl": "algorithm",
    "System": "system",
    "SystemDescriptionError": "errors",
    "Tolerance": "algorithm",
    "UnconnectedInputWarning": "master",
    "Verdict": "stability",
    "ledger": "energy",
    "prepare": "master",
    "simulate": "master",
    "stream": "master",
}

__all__ = [
    "Algorithm",
    "ArchiveError",
    "Component",
    "Connection",
    "Correction",
    "Crossings",
    "InitializationError",
    "Ledger",
    "Options",
    "OrchestrationError",
    "PowerBond",
    "Result",
    "RunInterrupted",
    "Simulation",
    "SimulationError",
    "Snapshot",
    "StepControl",
    "System",
    "SystemDescriptionError",
    "Tolerance",
    "UnconnectedInputWarning",
    "Verdict",
    "ledger",
    "prepare",
    "simulate",
    "stream",
]


def __getattr__(name: str) -> Any:
    """Import on first use: the command line's help needs none of numba and fmpy."""
    if name not in _HOME:
        msg = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(msg)
    value = getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value
