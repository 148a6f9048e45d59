"""Provenance of a result: everything that is needed to repeat the run, and nothing about place, time or user."""

import json
import math
import platform
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from orchestration.errors import ArchiveError
from orchestration.sandbox.archive import file_hash
from orchestration.system.system import Component, System

FORMAT = "1"  # version of the dictionary that `provenance` returns
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
    """Describe how a run was made, for the metadata of its result.

    The same run gives the same texts: the texts hold neither dates nor folders nor names of users or
    machines. The entries ``components``, ``start``, ``seeds``, ``connections``, ``order`` and
    ``versions`` are JSON.

    Parameters
    ----------
    system
        System that was run.
    algorithm
        Name or ``repr`` of the co-simulation algorithm.
    step
        Communication step, s.
    start_time, stop_time
        First and last communication point, s.
    order
        Component names in the order of stepping. Default: the order of the system.

    Returns
    -------
    dict
        ``format``, ``system``, ``components`` (name, file, model, identifier, GUID and SHA-256 of each
        FMU), ``start`` (start values that the system sets, by component), ``seeds`` (all seeds in force,
        by ``component.seed``), ``connections``, ``order``, ``algorithm``, ``step``, ``start_time``,
        ``stop_time``, ``versions``.

    Raises
    ------
    ArchiveError
        If an FMU cannot be read.
    SystemDescriptionError
        If the order does not name each component once.
    """
    ordered = system if order is None else system.ordered(order)
    digests: dict[Path, str] = {}  # components may share an FMU
    return {
        "format": FORMAT,
        "system": system.name,
        "components": _json([_fmu(component, digests) for component in system.components]),
        **told_of_values(system),
        "connections": _json([str(connection) for connection in system.connections]),
        "order": _json([component.name for component in ordered.components]),
        "algorithm": algorithm,
        "step": repr(float(step)),
        "start_time": repr(float(start_time)),
        "stop_time": repr(float(stop_time)),
        "versions": _json(versions()),
    }


def told_of_values(system: System) -> dict[str, str]:
    """Describe the values with which a run starts: those that the system sets, and all seeds in force."""
    return {
        "start": _json({c.name: _numbers(c.start) for c in system.components if c.start}),
        "seeds": _json(_numbers(_seeds(system))),
    }


def _fmu(component: Component, digests: dict[Path, str]) -> dict[str, str]:
    """Describe the FMU of a component by its file, identifier, GUID and hash."""
    description = component.description
    if description.path not in digests:
        try:
            digests[description.path] = file_hash(description.path)
        except OSError as error:
            msg = f"{component.name}: {description.path.name} cannot be read: {error.strerror or error}."
            raise ArchiveError(msg) from error
    return {
        "name": component.name,
        "file": description.path.name,
        "model": description.model_name,
        "identifier": description.identifier,
        "guid": description.guid,
        "sha256": digests[description.path],
    }


def _seeds(system: System) -> dict[str, float | str | None]:
    """Return the seeds in force, by ``component.seed``: values of the system, else start values of the FMU."""
    return {
        f"{component.name}.{SEED}": component.start.get(SEED, component.description.variables[SEED].start)
        for component in system.components
        if SEED in component.description.variables and component.description.variables[SEED].causality == "parameter"
    }


def versions() -> dict[str, str]:
    """Return the versions of the packages that decide the numbers, of Python and of the platform."""
    return {
        **{package: _version(package) for package in PACKAGES},
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
    }


def _version(package: str) -> str:
    """Return the version of an installed package."""
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"  # the package is imported from a source folder


def _numbers(values: Mapping[str, float | str | None]) -> dict[str, float | str | None]:
    """Sort values by name, and write numbers that are not finite as text, because JSON lacks them."""
    return {name: _number(value) for name, value in sorted(values.items())}


def _number(value: float | str | None) -> float | str | None:
    if value is None or isinstance(value, str):
        return value
    return float(value) if math.isfinite(value) else str(float(value))


def _json(value: Any) -> str:
    """Write a value as JSON."""
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def told_afterwards(changes: Sequence[Sequence[float | str]], state: Any) -> dict[str, str]:
    """Metadata of a run that are known at its end only.

    Parameters
    ----------
    changes
        Time, s, variable and value of everything that was set during the run.
    state
        State of the loop that counts the effort of the algorithm; None if the algorithm makes each step once.
    """
    told = {"changes": json.dumps(changes)} if changes else {}
    if state is not None:
        told |= {"steps_made": state.steps_made, "steps_rejected": state.rejected, "sweeps": state.iterations}
    return {key: str(value) for key, value in told.items()}
