"""The description of a module of WebAssembly, in JSON: its variables by name, and what it was made of."""

import hashlib
import json
import math
from typing import Any

from orchestration.containers.plan import FIXED, INPUT, OUTPUT, TUNABLE, Member, Plan, ProgramVariable

ABI = 1
"""Version of what a module exports and of what its description holds; `templates/system.mjs` knows the same number."""
ROLES = {FIXED: "parameter", TUNABLE: "parameter", INPUT: "input", OUTPUT: "output"}
RUN = "address of a run"
EXPORTS = {
    "memory": "linear memory; it may grow at each call of create, allocate and record, and views of it end then",
    "identity": "() -> address of a text: the identity in this description",
    "create": f"() -> {RUN} with all values at their starts; 0 if there is no memory",
    "destroy": "(run) frees its memory",
    "reset": "(run) puts all values back to their starts",
    "set": "(run, index, value) -> 1, or 0 if the value is refused",
    "get": "(run, index) -> value as a float64; Booleans are 0 and 1",
    "initialize": "(run, start time in s) -> 1, or 0 after a failure",
    "step": "(run, n) -> 1, or 0 after a failure; makes n steps",
    "time": "(run) -> time, s",
    "allocate": "(bytes) -> address of a block that is aligned for float64; 0 if there is no memory",
    "release": "(address of a block, or 0) frees it",
    "record": (
        "(run, n, every, indices, number of indices, columns) -> 1, or 0 after a failure; makes n steps. indices is"
        " the address of uint32, columns that of (1 + number of indices) * (floor(n / every) + 1) float64: column by"
        " column, the time first. Row 0 is the state before the steps, and a row follows after each `every` steps"
    ),
    "complete_rows": "(run) -> complete rows of the last recording",
    "failed_component": "(run) -> address of the name of the component that the last failure is about; 0 if none",
    "failed_sentence": "(run) -> address of a sentence with conversions of printf",
    "failed_count": "(run) -> number of arguments of the sentence",
    "failed_text": "(run, i) -> address of an argument that is a text, else 0",
    "failed_number": "(run, i) -> an argument that is a number, as a float64",
}
"""What a module exports, by name."""
WITH_LIBRARY = {"_initialize": "() must be called first"}
"""What a module with a C library exports besides."""
WITH_STEP = {
    "set_step": "(run, step in s) -> 1, or 0 if the run is initialized or the step is not positive; until then the step"
    " is that of this description"
}
"""What a module exports besides whose runs may have other steps."""


def description(plan: Plan, identity: str, file: str, module: bytes, *, variable_step: bool = False) -> bytes:
    """Return the content of a module's description; the same system gives the same bytes.

    Parameters
    ----------
    identity
        Hash of the sources, which the module tells, too.
    file, module
        File name and content of the module.
    variable_step
        Whether runs may have other steps than the plan.
    """
    system = plan.system
    exports = (WITH_LIBRARY if plan.foreign else {}) | EXPORTS | (WITH_STEP if variable_step else {})
    facts = {
        "abi": ABI,
        "name": plan.identifier,
        "system": system.name,
        "identity": identity,
        "module": {"file": file, "bytes": len(module), "sha256": hashlib.sha256(module).hexdigest()},
        "algorithm": plan.algorithm,
        "step": plan.step,
        "startTime": system.start_time,
        "stopTime": system.stop_time,
        "components": [_component(member) for member in plan.members],
        "connections": [str(connection) for connection in system.connections],
        "variables": [_variable(index, variable) for index, variable in enumerate(plan.variables)],
        "exports": exports,
    }
    return (json.dumps(facts, indent=1, ensure_ascii=False, allow_nan=False) + "\n").encode("utf-8", "replace")


def _component(member: Member) -> dict[str, Any]:
    """A component and its FMU."""
    fmu = member.fmu
    return {
        "name": member.name,
        "model": fmu.description.model_name,
        "fmu": fmu.path.name,
        "guid": fmu.description.guid,
        "sha256": fmu.sha256,
    }


def _variable(index: int, variable: ProgramVariable) -> dict[str, Any]:
    """A variable that can be set or read; an output has no start value."""
    facts = {
        "name": variable.path,
        "index": index,
        "role": ROLES[variable.role],
        "type": variable.variable.type,
        "unit": variable.variable.unit,
        "variability": variable.declared.variability,
        "start": None if variable.role == OUTPUT else variable.start,
        "min": _bound(variable.minimum),
        "max": _bound(variable.maximum),
        "description": variable.declared.description,
    }
    return facts


def _bound(limit: float) -> float | None:
    return limit if math.isfinite(limit) else None
