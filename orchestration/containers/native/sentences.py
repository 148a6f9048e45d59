"""Says why a run of a native library failed, in the words in which `orchestration.simulate` says it."""

from collections.abc import Mapping, Sequence

from orchestration.containers.native.library import AT_A_VALUE, AT_THE_START, Failure, Outcome
from orchestration.errors import OrchestrationError, printable
from orchestration.master.time_grid import fixed_grid
from orchestration.system.system import System

_CALLS = {AT_THE_START: "fmi2ExitInitializationMode"}


def failure_sentence(outcome: Outcome, paths: Sequence[str], types: Sequence[str], time: float) -> str:
    """Return the sentence of a run that failed.

    Parameters
    ----------
    outcome
        How the run has ended.
    paths, types
        Names of the values that were set, in their order, and the types of the variables.
    time
        Time of the last communication point, s.
    """
    said = _said(outcome.failure)
    component = (outcome.failure.component or b"").decode("utf-8", "replace")
    if outcome.where == AT_A_VALUE:
        number = int(outcome.variable)
        component, call = paths[number].partition(".")[0], f"fmi2Set{types[number]}"
        return f'{component}: {call} returned fmi2Error; its last message: "{call}: {said}".'
    where = "" if outcome.where in _CALLS else f" at t = {time:.9g} s (step {outcome.steps})"
    call = _CALLS.get(outcome.where, "fmi2DoStep")
    return f'{component}: {call} returned fmi2Error{where}; its last message: "{said}".'


def refusal(system: System, values: Mapping[str, float], step: float, span: tuple[float, float]) -> str:
    """Return what is wrong with values of a run, or with its step, before a component is asked; empty if nothing is."""
    try:
        fixed_grid(system.set(values), span, step, stale=False)
    except OrchestrationError as error:
        return str(error)
    return ""


def _said(failure: Failure) -> str:
    """The sentence of a component with its arguments, as the component would log it."""
    found = [
        argument.text.decode("utf-8", "replace") if argument.kind == b"s" else argument.number
        for argument in failure.arguments[: failure.n]
    ]
    return printable((failure.sentence or b"").decode("utf-8", "replace") % tuple(found))
