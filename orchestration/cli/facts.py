"""Gathers what is in an FMU, a system or a file of results, as plain values that JSON knows."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from orchestration.cli.signals import signal_record
from orchestration.fmi.codes import CAPABILITIES, STRING
from orchestration.fmi.description import read_description
from orchestration.fmi.document import Declared, Document, DocumentError, parsed, read_bytes
from orchestration.fmi.library import host_folders
from orchestration.fmi.related_files import related_files
from orchestration.results.extremes import extremes_of_file
from orchestration.sandbox.archive import entry_names
from orchestration.system.component import Component
from orchestration.system.system import System

EXPERIMENT = {"start": "startTime", "stop": "stopTime", "step": "stepSize", "tolerance": "tolerance"}


def fmu_facts(path: Path) -> dict[str, Any]:
    """What an FMU declares.

    Raises
    ------
    ArchiveError
        If the file is not an FMI 2.0 co-simulation FMU, or is unsafe to open.
    """
    description = read_description(path)
    document = Document(parsed(read_bytes(path)))
    places = [name.split("/") for name in entry_names(path)]
    platforms = sorted({parts[1] for parts in places if parts[0] == "binaries" and len(parts) > 2 and parts[2]})
    return {
        "kind": "fmu",
        "name": description.model_name,
        "file": str(path),
        "description": document.root.get("description", ""),
        "tool": document.root.get("generationTool", ""),
        "guid": description.guid,
        "platforms": platforms,
        "runs_here": any(folder in platforms for folder in host_folders()[0]),
        "capabilities": [name for name in CAPABILITIES if description.can(name)],
        "experiment": {ours: document.experiment(theirs) for ours, theirs in EXPERIMENT.items()},
        **_references(path),
        "variables": [_variable(variable) for variable in document.variables],
    }


def system_facts(system: System, variants: Sequence[str] = ()) -> dict[str, Any]:
    """What a system is made of, and which variants its package has."""
    return {
        "kind": "system",
        "name": system.name,
        "variants": list(variants),
        "experiment": {"start": system.start_time, "stop": system.stop_time, "step": system.step},
        "components": [_component(component) for component in system.components],
        "connections": [str(connection) for connection in system.connections],
        "unconnected_inputs": system.unconnected_inputs(),
        "start_values": [
            {"name": f"{component.name}.{name}", "value": value, "unit": component.variable(name).unit}
            for component in system.components
            for name, value in component.start.items()
        ],
        "assumptions": dict(system.assumptions),
        "notices": list(system.notices),
    }


def result_facts(path: Path) -> dict[str, Any]:
    """What a file of results holds.

    Raises
    ------
    OrchestrationError
        If the file cannot be read, or does not hold a result.
    """
    found = extremes_of_file(path)
    return {
        "kind": "result",
        "file": str(path),
        "status": found.status,
        "message": found.message,
        "rows": found.rows,
        "start_time": found.span[0] if found.span else None,
        "stop_time": found.span[1] if found.span else None,
        "metadata": dict(found.metadata),
        "signals": signal_record(found),
    }


def _references(path: Path) -> dict[str, Any]:
    """What an FMU carries beside its definition; a damaged manifest is a notice, because no tool needs it."""
    try:
        found = related_files(path)
    except DocumentError as error:
        return {"references": [], "notices": [str(error)]}
    references = [
        {"file": one.source, "role": one.role, "description": one.description, "labels": list(one.labels)}
        for one in found
    ]
    return {"references": references, "notices": []}


def _variable(declared: Declared) -> dict[str, Any]:
    return {
        "name": declared.name,
        "causality": declared.causality,
        "variability": declared.variability,
        "type": declared.type,
        "unit": declared.unit,
        "start": declared.start if declared.type == STRING else declared.number,
        "min": declared.limits[0],
        "max": declared.limits[1],
        "description": declared.description,
    }


def _component(component: Component) -> dict[str, Any]:
    description = component.description
    return {
        "name": component.name,
        "model": description.model_name,
        "file": description.path.name,
        "sample_time": component.sample_time,
        "inputs": len(description.of_causality("input")),
        "outputs": len(description.of_causality("output")),
        "parameters": len(description.of_causality("parameter")),
    }
