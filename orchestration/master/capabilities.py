"""Checks before a run whether a system allows an algorithm, steps of several lengths, and located crossings."""

from collections.abc import Iterable, Mapping

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import DIFFERENTIATES, REAL, SAVES_STATE, VARIES_STEP
from orchestration.master.algorithm import DIRECTIONAL, Algorithm
from orchestration.master.options import Crossings
from orchestration.system.system import Component, System


def check_crossings(system: System, crossings: Crossings) -> None:
    """Refuse crossings of variables that are not Real outputs.

    Raises
    ------
    SystemDescriptionError
        If a variable is not a Real output; the message names its type and causality.
    """
    for name in crossings.outputs:
        variable = system.resolve(name)[1]
        if variable.causality != "output" or variable.type != REAL:
            msg = f"{name} is a {variable.type} of causality {variable.causality}; crossings need a Real output."
            raise SystemDescriptionError(msg)


def check_capabilities(system: System, algorithm: Algorithm, crossings: Crossings, ratios: Mapping[str, int]) -> None:
    """Refuse a run that needs a capability which a component lacks, or whose choices exclude each other.

    Parameters
    ----------
    ratios
        Communication steps per step of a component, by name.

    Raises
    ------
    SystemDescriptionError
        If so; the message names the component that lacks a capability, or the choices that exclude each other.
    """
    for component in system.components:
        if crossings.outputs or algorithm.control is not None or (algorithm.rolls_back and component.continuous):
            what = "locating crossings" if crossings.outputs else f"algorithm {algorithm.name}"
            _require(component, SAVES_STATE, what)
        correction = algorithm.correction
        if correction is not None and correction.jacobian == DIRECTIONAL and component.continuous:
            _require(component, DIFFERENTIATES, "a Jacobian from directional derivatives")
    for name in ratios:
        system.component(name)
    if any(ratio > 1 for ratio in ratios.values()) and (algorithm.rolls_back or crossings.outputs):
        msg = f"Steps of several lengths do not go together with algorithm {algorithm.name} or crossings."
        raise SystemDescriptionError(msg)


def check_steps(system: System, algorithm: Algorithm, crossings: Crossings, *, unequal: bool) -> None:
    """Refuse a run whose steps differ in length if a component takes steps of one length only.

    Parameters
    ----------
    unequal
        Whether the given communication points differ in their distances.

    Raises
    ------
    SystemDescriptionError
        Naming the component, and what makes the steps differ.
    """
    reasons = {
        f"algorithm {algorithm.name}, which controls its step": algorithm.control is not None,
        f"locating crossings of {', '.join(crossings.outputs)}": bool(crossings.outputs),
        "a run with communication points that differ in their distances": unequal,
    }
    for what in (reason for reason, applies in reasons.items() if applies):
        for component in system.components:
            _require(component, VARIES_STEP, what)


def check_tolerances(system: System, algorithm: Algorithm) -> None:
    """Refuse absolute tolerances of units that no output has, which would do nothing.

    A script may share one algorithm among systems, so only who names an algorithm for one system asks for this.

    Raises
    ------
    SystemDescriptionError
        Naming the unit, and those of the outputs.
    """
    owner = algorithm.control or algorithm.correction
    outputs = [v for c in system.components for v in c.description.of_causality("output") if v.type == REAL]
    units = dict.fromkeys(variable.unit for variable in outputs)
    for unit in owner.tolerance.absolute if owner else ():
        if unit not in units:
            known = ", ".join(name or "none" for name in units)
            msg = f"The absolute tolerance in {unit} does nothing: the units of the outputs are {known}."
            raise SystemDescriptionError(msg)


def require_settable_in_run(system: System, names: Iterable[str]) -> None:
    """Refuse to set during a run what the FMU computes, and inputs that a source sets again in each step.

    Raises
    ------
    SystemDescriptionError
        Naming the causality, or the source.
    """
    sources = system.sources
    for name in names:
        causality = system.resolve(name)[1].causality
        if causality not in ("parameter", "input"):
            msg = f"{name} has causality {causality}; only parameters and inputs can be set during a run."
            raise SystemDescriptionError(msg)
        if name in sources:
            msg = f"{name} cannot be set, since its source {sources[name]} sets it in each step; disconnect it."
            raise SystemDescriptionError(msg)


def _require(component: Component, capability: str, what: str) -> None:
    """Refuse a component whose FMU does not declare a capability flag."""
    if not component.description.can(capability):
        name = component.description.path.name
        msg = f"{component.name}: {name} does not declare {capability}, which {what} needs."
        raise SystemDescriptionError(msg)
