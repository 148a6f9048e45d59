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
    from orchestration.analysis.energy import Ledger, PowerBond, ledger
    from orchestration.analysis.stability.verdict import Verdict
    from orchestration.errors import (
        ArchiveError,
        InitializationError,
        OrchestrationError,
        RunInterrupted,
        SimulationError,
        SystemDescriptionError,
        UnknownNameError,
    )
    from orchestration.master.algorithm import Algorithm, Correction, StepControl, Tolerance
    from orchestration.master.options import Options
    from orchestration.master.simulate import UnconnectedInputWarning, prepare, simulate, stream
    from orchestration.master.simulation import Simulation
    from orchestration.master.snapshot import Snapshot
    from orchestration.master.step_arrays import Crossings
    from orchestration.results.comparison import ColumnDifference, Comparison, compare
    from orchestration.results.result import Result
    from orchestration.system.system import Component, Connection, System

_HOME = {
    "Algorithm": "master.algorithm",
    "ArchiveError": "errors",
    "ColumnDifference": "results.comparison",
    "Comparison": "results.comparison",
    "Component": "system.system",
    "Connection": "system.system",
    "Correction": "master.algorithm",
    "Crossings": "master.step_arrays",
    "InitializationError": "errors",
    "Ledger": "analysis.energy",
    "Options": "master.options",
    "OrchestrationError": "errors",
    "PowerBond": "analysis.energy",
    "Result": "results.result",
    "RunInterrupted": "errors",
    "Simulation": "master.simulation",
    "SimulationError": "errors",
    "Snapshot": "master.snapshot",
    "StepControl": "master.algorithm",
    "System": "system.system",
    "SystemDescriptionError": "errors",
    "Tolerance": "master.algorithm",
    "UnconnectedInputWarning": "master.simulate",
    "Verdict": "analysis.stability.verdict",
    "UnknownNameError": "errors",
    "compare": "results.comparison",
    "ledger": "analysis.energy",
    "prepare": "master.simulate",
    "simulate": "master.simulate",
    "stream": "master.simulate",
}

__all__ = [
    "Algorithm",
    "ArchiveError",
    "ColumnDifference",
    "Comparison",
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
    "UnknownNameError",
    "Verdict",
    "compare",
    "ledger",
    "prepare",
    "simulate",
    "stream",
]


def __dir__() -> list[str]:
    """The public names."""
    return sorted(__all__)


def __getattr__(name: str) -> Any:
    """Import on first use: the command line's help needs none of numba and fmpy."""
    if name not in _HOME:
        msg = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(msg)
    value = getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value
