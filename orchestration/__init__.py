"""Couple FMUs to a system, step the system, and judge the result.

An FMU is a file with a model, in the format of the Functional Mock-up Interface (FMI). A `System` says
which FMUs are coupled and how. `simulate` steps the system from one communication point to the next and
returns a `Result`: one row of outputs for each communication point.

Example::

    from orchestration import System, simulate

    system = System.read("fig2.ssp").set({"controller.K[1]": 4000.0})
    result = simulate(system, stop_time=2.0, step=1e-4)
    result["plant.x[1]"]
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from orchestration.analysis.doctor.diagnose import diagnose
    from orchestration.analysis.doctor.diagnosis import Diagnosis
    from orchestration.analysis.doctor.finding import Finding
    from orchestration.analysis.energy import Ledger, PowerBond, ledger
    from orchestration.analysis.stability.verdict import Verdict
    from orchestration.campaigns.design.factor import Factor
    from orchestration.campaigns.measuring.measure import Measure
    from orchestration.campaigns.pictures.plot_table import plot_table
    from orchestration.campaigns.sensitivity import sensitivity
    from orchestration.campaigns.study import Study
    from orchestration.errors import (
        ArchiveError,
        ContainerError,
        FormulaError,
        InitializationError,
        OrchestrationError,
        RunInterrupted,
        SignalError,
        SimulationError,
        StudyError,
        StudyInterrupted,
        SystemDescriptionError,
        UnknownNameError,
    )
    from orchestration.fmi.fmu import Fmu
    from orchestration.fmi.isolation import Isolation
    from orchestration.master.algorithm import Algorithm, Correction, StepControl, Tolerance
    from orchestration.master.fmu_messages import FmuWarning
    from orchestration.master.form import FormalityWarning
    from orchestration.master.judge import StabilityWarning
    from orchestration.master.options import Crossings, Options
    from orchestration.master.pacing import Pace
    from orchestration.master.simulate import UnconnectedInputWarning, prepare, simulate, stream
    from orchestration.master.simulation import Simulation
    from orchestration.master.snapshot import Snapshot
    from orchestration.master.stiffness import StiffnessWarning
    from orchestration.master.time_series import TimeSeries
    from orchestration.master.walls import DifferentWallsWarning
    from orchestration.paper.page.report import write_report
    from orchestration.paper.ready import scenario
    from orchestration.results.comparison import ColumnDifference, Comparison, compare
    from orchestration.results.prediction import Prediction
    from orchestration.results.result import Result
    from orchestration.sandbox.guard import ProcessChangedWarning
    from orchestration.system.system import Component, Connection, System

_HOME = {
    "Algorithm": "master.algorithm",
    "ArchiveError": "errors",
    "ColumnDifference": "results.comparison",
    "Comparison": "results.comparison",
    "Component": "system.system",
    "Connection": "system.system",
    "ContainerError": "errors",
    "Correction": "master.algorithm",
    "Crossings": "master.options",
    "Diagnosis": "analysis.doctor.diagnosis",
    "DifferentWallsWarning": "master.walls",
    "Factor": "campaigns.design.factor",
    "Finding": "analysis.doctor.finding",
    "Fmu": "fmi.fmu",
    "FmuWarning": "master.fmu_messages",
    "FormalityWarning": "master.form",
    "FormulaError": "errors",
    "InitializationError": "errors",
    "Isolation": "fmi.isolation",
    "Ledger": "analysis.energy",
    "Measure": "campaigns.measuring.measure",
    "Options": "master.options",
    "OrchestrationError": "errors",
    "Pace": "master.pacing",
    "PowerBond": "analysis.energy",
    "Prediction": "results.prediction",
    "ProcessChangedWarning": "sandbox.guard",
    "Result": "results.result",
    "RunInterrupted": "errors",
    "SignalError": "errors",
    "Simulation": "master.simulation",
    "SimulationError": "errors",
    "Snapshot": "master.snapshot",
    "StabilityWarning": "master.judge",
    "StepControl": "master.algorithm",
    "StiffnessWarning": "master.stiffness",
    "Study": "campaigns.study",
    "StudyError": "errors",
    "StudyInterrupted": "errors",
    "System": "system.system",
    "SystemDescriptionError": "errors",
    "TimeSeries": "master.time_series",
    "Tolerance": "master.algorithm",
    "UnconnectedInputWarning": "master.simulate",
    "Verdict": "analysis.stability.verdict",
    "UnknownNameError": "errors",
    "compare": "results.comparison",
    "diagnose": "analysis.doctor.diagnose",
    "ledger": "analysis.energy",
    "plot_table": "campaigns.pictures.plot_table",
    "prepare": "master.simulate",
    "scenario": "paper.ready",
    "sensitivity": "campaigns.sensitivity",
    "simulate": "master.simulate",
    "stream": "master.simulate",
    "write_report": "paper.page.report",
}

__all__ = [
    "Algorithm",
    "ArchiveError",
    "ColumnDifference",
    "Comparison",
    "Component",
    "Connection",
    "ContainerError",
    "Correction",
    "Crossings",
    "Diagnosis",
    "DifferentWallsWarning",
    "Factor",
    "Finding",
    "Fmu",
    "FmuWarning",
    "FormalityWarning",
    "FormulaError",
    "InitializationError",
    "Isolation",
    "Ledger",
    "Measure",
    "Options",
    "OrchestrationError",
    "Pace",
    "PowerBond",
    "Prediction",
    "ProcessChangedWarning",
    "Result",
    "RunInterrupted",
    "SignalError",
    "Simulation",
    "SimulationError",
    "Snapshot",
    "StabilityWarning",
    "StepControl",
    "StiffnessWarning",
    "Study",
    "StudyError",
    "StudyInterrupted",
    "System",
    "SystemDescriptionError",
    "TimeSeries",
    "Tolerance",
    "UnconnectedInputWarning",
    "UnknownNameError",
    "Verdict",
    "compare",
    "diagnose",
    "ledger",
    "plot_table",
    "prepare",
    "scenario",
    "sensitivity",
    "simulate",
    "stream",
    "write_report",
]


def __dir__() -> list[str]:
    """The public names."""
    return sorted(__all__)


def __getattr__(name: str) -> Any:
    """Import a public name when it is used first, so that ``import orchestration`` loads neither numba nor fmpy."""
    if name not in _HOME:
        msg = f"module {__name__!r} has no attribute {name!r}"
        raise AttributeError(msg)
    value = getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value
