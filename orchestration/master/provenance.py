"""What a result was made from: enough to make it again, and nothing that differs from place to place."""

import json
import math
import platform
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from orchestration.errors import ArchiveError
from orchestration.sandbox.archive import file_hash
from orchestration.system.system import Component, System

FORMAT = "1"  # of what `provenance` returns
SEED = "seed"
PACKAGES = ("adaptimp", "fmpy", "numpy", "numba")


def provenance(
    system: System,
    *,
    algorithm: str,
    step: float,
    start_time: float,
    stop_time: float,
    order: Sequence[str] | None,
) -> dict[str, str]:
    """How a run was made, for the metadata of its result.

    Same run, same texts: there are no dates, no folders and no names of users or machines. The
    entries ``components``, ``start``, ``seeds``, ``connections``, ``order`` and ``versions`` are JSON.

    Parameters
    ----------
    algorithm
        How the components were stepped.
    step, start_time, stop_time
        s.
    order
        Component names in the order of stepping; the order of the system if None.

    Returns
    -------
    dict
        ``format``, ``system``, ``components`` (name, file, model, identifier, GUID and SHA-256 of each
        FMU), ``start`` (values that differ from the FMU's own, by component), ``seeds`` (by
        ``component.seed``, the FMU's own included), ``connections``, ``order``, ``algorithm``,
        ``step``, ``start_time``, ``stop_time``, ``versions``.

    Raises
    ------
    ArchiveError
        If an FMU cannot be read.
    SystemDescriptionError
        Unless the order names each component once.
    """
    ordered = system if order is None else system.ordered(order)
    return {
        "format": FORMAT,
        "system": system.name,
        "components": _json([_fmu(component) for component in system.components]),
        "start": _json({c.name: _numbers(c.start) for c in system.components if c.start}),
        "seeds": _json(_numbers(_seeds(system))),
        "connections": _json([str(connection) for connection in system.connections]),
        "order": _json([component.name for component in ordered.components]),
        "algorithm": algorithm,
        "step": repr(float(step)),
        "start_time": repr(float(start_time)),
        "stop_time": repr(float(stop_time)),
        "versions": _json(_versions()),
    }


def _fmu(component: Component) -> dict[str, str]:
    description = component.description
    try:
        digest = file_hash(description.path)
    except OSError as error:
        msg = f"{component.name}: {description.path} cannot be read: {error.strerror or error}."
        raise ArchiveError(msg) from error
    return {
        "name": component.name,
        "file": description.path.name,
        "model": description.model_name,
        "identifier": description.identifier,
        "guid": description.guid,
        "sha256": digest,
    }


def _seeds(system: System) -> dict[str, float | None]:
    """Seeds as they are in force, by ``component.seed``."""
    return {
        f"{component.name}.{SEED}": component.start.get(SEED, component.description.variables[SEED].start)
        for component in system.components
        if SEED in component.description.variables and component.description.variables[SEED].causality == "parameter"
    }


def _versions() -> dict[str, str]:
    return {
        **{package: _version(package) for package in PACKAGES},
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
    }


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"  # run from a checkout


def _numbers(values: Mapping[str, float | None]) -> dict[str, float | str | None]:
    """Sorted; JSON has no infinity."""
    return {
        name: value if value is None else float(value) if math.isfinite(value) else str(float(value))
        for name, value in sorted(values.items())
    }


def _json(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
