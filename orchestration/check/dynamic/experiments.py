"""Experiments on rules 8 to 16: each is a function that calls an FMU's binary and yields findings and measurements.

The experiments run in a child process, in the order of this file. If an experiment of `BASE` finds an error, the
experiments after it are not tried.
"""

from collections.abc import Callable, Mapping

from orchestration.check.dynamic import call_experiments as calls
from orchestration.check.dynamic import state_experiments as states
from orchestration.check.dynamic.bitwise_runs import (
    STEPS,
    Yield,
    find_out_whether_it_moves,
    fresh_rows,
    infinite,
    keep,
    moves,
    trace,
)
from orchestration.check.dynamic.derivatives import derivatives
from orchestration.check.dynamic.instance import Binary, Instance, RefusedError
from orchestration.check.findings import error, listed, note, shown, warning
from orchestration.fmi.codes import DIFFERENTIATES, SAVES_STATE, SERIALIZES_STATE

LIVES = 50
MANY_LIVES = f"{LIVES} lives"
VARIABLE_STEP, ONLY_ONCE = "canHandleVariableCommunicationStepSize", "canBeInstantiatedOnlyOncePerProcess"
USUAL_STEPS = (1e-2, 0.1, 1.0, 1e-4, 1 / 60)  # s, tried where neither the description nor a thousandth of a run helps
SAME_CALLS = (
    "Two fresh instances give different outputs for the same calls: random numbers without a seed, or memory that"
    " instances share. Nothing can be replayed, so states were not compared."
)
KEPT_INPUTS = "Inputs were kept at their start values: a step with inputs 1 % off them fails."
Experiment = Callable[[Binary], Yield]


def loading(binary: Binary) -> Yield:
    """Try rules 8 and 10: the library exports the functions of FMI and names its version and platform."""
    lacking = binary.lacks()
    if lacking and not binary.plan["exports_known"]:
        yield error("8", f"The library does not export {listed(lacking)}.")
    for function, expected in (("fmi2GetVersion", b"2.0"), ("fmi2GetTypesPlatform", b"default")):
        answer = binary.ask(function)
        if answer != expected:
            yield warning("10", f"{function} answers {shown(answer)}, not {expected.decode()}.")


def instantiation(binary: Binary) -> Yield:
    """Try rule 9: the FMU accepts the GUID of its description."""
    with Instance(binary):
        yield from ()


def initialization(binary: Binary) -> Yield:
    """Try rule 11: outputs are finite after initialization with the start values."""
    with Instance(binary) as instance:
        instance.initialize()
        yield from infinite(binary, instance.outputs(), "after initialization with the start values")


def stepping(binary: Binary) -> Yield:
    """Try rule 11: the FMU makes steps on the start values of its inputs, and outputs stay finite."""
    yield from _step_length(binary)
    with Instance(binary) as instance:
        instance.initialize()
        for _ in range(STEPS):
            instance.step()
            wrong = list(infinite(binary, instance.outputs(), f"at t = {instance.time:.9g} s"))
            yield from wrong
            if wrong:
                return


def _step_length(binary: Binary) -> Yield:
    """Find a step that the FMU takes, if its description proposes none."""
    guessed, refusal = binary.plan["step"], ""
    if binary.plan["step_proposed"] or binary.plan["once"]:
        return
    for step in (guessed, *USUAL_STEPS):
        with Instance(binary) as instance:
            instance.initialize()
            try:
                instance.step(step)
            except RefusedError as refused:
                refusal = refusal or str(refused)
                continue
        if step != guessed:
            binary.plan["step"] = step
            said = f"The description proposes no step, and a step of {guessed:g} s is refused"
            yield note("11", f"{said}; steps of {step:g} s were tried.")
        return
    tried = ", ".join(f"{step:g}" for step in (guessed, *USUAL_STEPS))
    yield error("11", f"The description proposes no step, and steps of {tried} s are refused: {refusal}")


def repetition(binary: Binary) -> Yield:
    """Try rule 13: the same calls give the same outputs, which later comparisons need."""
    moved = moves(binary)
    if fresh_rows(binary, moved) != trace(binary, moved):
        yield warning("13", SAME_CALLS)
        binary.plan["random"] = True
    if not moved:
        yield KEPT_INPUTS


def moving(binary: Binary) -> Yield:
    """Run a fresh instance and keep its outputs, for processes that can make one instance only."""
    find_out_whether_it_moves(binary)
    if not moves(binary):
        yield KEPT_INPUTS


def second_run(binary: Binary) -> Yield:
    """Try rule 13: the same calls give the same outputs in another process."""
    known = "rows" in binary.plan
    rows = trace(binary, moves(binary))
    if not known:
        keep(binary, rows)
    elif rows != fresh_rows(binary, moved=True):
        yield warning("13", SAME_CALLS)
        binary.plan["random"] = True


def termination(binary: Binary) -> Yield:
    """Try rule 10: fmi2Terminate works after steps."""
    with Instance(binary) as instance:
        instance.initialize()
        instance.step()
        instance.call("fmi2Terminate")
    yield from ()


def lives(binary: Binary) -> Yield:
    """Try rule 14: the FMU can be instantiated and freed many times, one after the other."""
    for _ in range(LIVES):
        with Instance(binary):
            pass
    yield from ()


BASE: Mapping[str, Experiment] = {
    "loading": loading,
    "instantiation": instantiation,
    "initialization": initialization,
    "stepping": stepping,
    "repetition": repetition,
}
FURTHER: Mapping[str, Experiment] = {
    "wrong GUID": calls.guid,
    "reset": states.reset,
    "rollback": states.rollback,
    "serialization": states.serialization,
    "early restoring": states.early_restoring,
    "torn state": states.torn_state,
    "split steps": states.splitting,
    "two instances": states.instances,
    "derivatives": derivatives,
    "unknown reference": calls.unknown_reference,
    "negative step": calls.backward_step,
    "step of NaN": calls.step_without_length,
    "setting an output": calls.set_output,
    "setting a fixed parameter": calls.set_fixed_parameter,
    "NaN as input": calls.input_not_a_number,
    "termination": termination,
    MANY_LIVES: lives,
}
_NEEDS = {
    "rollback": SAVES_STATE,
    "serialization": SERIALIZES_STATE,
    "early restoring": SERIALIZES_STATE,
    "torn state": SERIALIZES_STATE,
    "split steps": VARIABLE_STEP,
    "derivatives": DIFFERENTIATES,
}


_ONE_BY_ONE: Mapping[str, Experiment] = {"first run": moving, "second run": second_run}
_SEVERAL_INSTANCES = ("repetition", "early restoring", "split steps", "two instances", MANY_LIVES)


def chosen(capable: Callable[[str], bool]) -> list[str]:
    """Return the names of the experiments that an FMU's capabilities ask for, in their order."""
    further = [name for name in FURTHER if name not in _NEEDS or capable(_NEEDS[name])]
    if not capable(ONLY_ONCE):
        return [*BASE, *further]
    return [name for name in (*BASE, *_ONE_BY_ONE, *further) if name not in _SEVERAL_INSTANCES]


def experiment(name: str) -> Experiment:
    """Return the experiment of a name."""
    return {**BASE, **_ONE_BY_ONE, **FURTHER}[name]
