"""Turn a declared model into the CasADi functions that the C runtime calls.

Expressions of parameters alone are moved into ``calibrate``, which runs when parameters change, and
those of a continuous model's states alone into ``prepare``, whose values serve derivative, outputs and
event indicators. Common subexpressions are shared within each function.
"""

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu.columns import evolutions, inputs, parameters, stack, states
from adaptimp_fmu.continuous_model import ContinuousModel
from adaptimp_fmu.equations import require_supported
from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.model import Model
from adaptimp_fmu.sampled_model import SampledModel
from adaptimp_fmu.sensitivity import sensitivity_functions
from adaptimp_fmu.variables import Role


@dataclass(frozen=True)
class Lowered:
    """A model, written as functions of plain numbers.

    Attributes
    ----------
    functions
        In the order of the seam, see ``runtime/model.h``.
    n_constants
        Number of constants that ``calibrate`` derives from the parameters.
    n_shared
        Number of values that ``prepare`` derives from the states of a continuous model.
    """

    functions: tuple[ca.Function, ...]
    n_constants: int
    n_shared: int


@dataclass(frozen=True)
class Routine:
    """A function before lowering: name, arguments besides p, c and s, results, and whether it takes s."""

    name: str
    arguments: dict[str, ca.SX]
    results: dict[str, ca.SX]
    prepared: bool = False


def lower(model: Model) -> Lowered:
    """Lower a model.

    Raises
    ------
    DefinitionError
        If the name is not a C identifier, there are no outputs, a state has no evolution, a divisor or a seed is
        not a suitable parameter, a value holds the constant NaN, depends on a symbol that the model does not declare,
        or uses a function that the runtime does not have.
    """
    _require_complete(model)
    p, x = parameters(model), states(model)
    routines = _routines(model)
    flat = stack([stack(list(r.results.values())) for r in routines])
    flat, constants, derived = _extract(flat, p)
    functions = [_calibration(model, p, derived)]
    shared = ca.SX(0, 1)
    if isinstance(model, ContinuousModel):
        first = routines[0].results["x"].numel()
        rest, shared, prepared = _extract(ca.cse(flat[first:, 0]), stack([x, p, constants]))
        flat = stack([flat[:first, 0], rest])
        functions.append(_function("prepare", {"x": x, "p": p, "c": constants}, {"s": prepared}))
    offset = 0
    for routine in routines:
        results = {}
        for name, value in routine.results.items():
            results[name] = flat[offset : offset + value.numel(), 0]  # a bare slice of one element is a row
            offset += value.numel()
        arguments = {**routine.arguments, "p": p, "c": constants}
        if routine.prepared:
            arguments["s"] = shared
        functions.append(_function(routine.name, arguments, results))
    functions.extend(sensitivity_functions(model))
    return Lowered(tuple(functions), constants.numel(), shared.numel())


def _extract(flat: ca.SX, known: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Replace subexpressions of the known symbols alone by new symbols.

    The results are the remaining expression, the new symbols and their values, each as a column.
    """
    rest, symbols, values = ca.extract_parametric(flat, known)
    return rest, stack([ca.vec(s) for s in symbols]), stack([ca.vec(v) for v in values])


def _calibration(model: Model, p: ca.SX, derived: ca.SX) -> ca.Function:
    """Return the function of the parameters that gives the constants, the checks and the noise's ticks per draw."""
    checks = stack([check.value for check in model.static_checks])
    results = {"c": derived, "checks": checks, "ticks": _ticks_per_draw(model)}
    return _function("calibrate", {"p": p}, results)


def _routines(model: Model) -> Sequence[Routine]:
    t, u = model.time, inputs(model)
    x, next_values = states(model), evolutions(model)
    y = stack(model.output_values)
    evolution = stack(next_values)
    checks = stack([check.value for check in model.checks])
    initial = Routine("initial", {"t": t, "u": u}, {"x": stack([s.initial for s in model.states])})
    if isinstance(model, SampledModel):
        w = model.noise.symbol if model.noise else ca.SX(0, 1)
        arguments = {"t": t, "x": x, "u": u, "w": w}
        pairs = zip(model.states, next_values, strict=True)
        held = stack([state.symbol if state.slow else value for state, value in pairs])
        routines = [initial, Routine("tick", arguments, {"y": y, "next": held, "checks": checks})]
        if model.divisor_name:
            results = {"y": y, "next": evolution, "checks": checks}
            routines.append(Routine("tick_update", arguments, results))
        if model.noise:
            routines.append(Routine("noise", {"r": model.noise.uniforms}, {"w": model.noise.value}))
        return routines
    if not isinstance(model, ContinuousModel):
        msg = f"{model.name} is neither a ContinuousModel nor a SampledModel."
        raise DefinitionError(msg)
    modes = stack([event.mode for event in model.events])
    arguments = {"t": t, "x": x, "u": u, "m": modes}
    routines = [
        initial,
        Routine("derivative", arguments, {"dx": evolution}, prepared=True),
        Routine("output", arguments, {"y": y, "checks": checks}, prepared=True),
    ]
    if model.events:
        z = stack([event.indicator for event in model.events])
        routines.append(Routine("event_indicators", {"t": t, "x": x}, {"z": z}, prepared=True))
    return routines


def _ticks_per_draw(model: Model) -> ca.SX:
    return model.noise.ticks_per_draw if isinstance(model, SampledModel) and model.noise else ca.SX(0)


def _require_complete(model: Model) -> None:
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", model.name):
        name = re.sub(r"[^A-Za-z0-9_]", "_", f"_{model.name}" if model.name[:1].isdigit() else model.name) or "Model"
        msg = f"{model.name!r} is not a C identifier, so it cannot name an FMU; use a name such as {name}."
        raise DefinitionError(msg)
    if not model.output_values:
        msg = f"{model.name} has no outputs; declare one with model.output(...)."
        raise DefinitionError(msg)
    if isinstance(model, SampledModel):
        model.require_named_parameters()
    for what, value in _expressions(model):
        if _has_nan(value):
            msg = (
                f"{model.name}: {what} holds the constant NaN. Functions such as math.sin return NaN for a symbol;"
                " use those of CasADi, such as ca.sin."
            )
            raise DefinitionError(msg)
        _require_declared(model, what, value)
        require_supported(f"{model.name}: {what}", value)


def _require_declared(model: Model, what: str, value: ca.SX) -> None:
    """Refuse an expression with a symbol that is not of the model."""
    own = [model.time, *model.parameter_symbols, *model.input_symbols, *(state.symbol for state in model.states)]
    if isinstance(model, ContinuousModel):
        own += [event.mode for event in model.events]
    if isinstance(model, SampledModel) and model.noise:
        own.append(model.noise.symbol)
    known = {symbol.element_hash() for vector in own for symbol in ca.vertsplit(vector)}
    for symbol in ca.symvar(value):
        if symbol.element_hash() not in known:
            msg = (
                f"{model.name}: {what} depends on the symbol {symbol}, which the model does not declare;"
                " declare it, as with model.parameter(...) or model.input(...)."
            )
            raise DefinitionError(msg)


def _expressions(model: Model) -> Iterator[tuple[str, ca.SX]]:
    """Everything that a model computes, with a name for messages."""
    names = [variable.name for variable in model.with_role(Role.OUTPUT)]
    values = [element for value in model.output_values for element in ca.vertsplit(value)]
    yield from ((f"output {name}", value) for name, value in zip(names, values, strict=True))
    for state in model.states:
        yield f"the first value of state {state.name}", state.initial
        yield f"the evolution of state {state.name}", ca.SX(0) if state.evolution is None else state.evolution
    for event in model.events if isinstance(model, ContinuousModel) else ():
        yield f"event {event.name}", event.indicator
    yield from ((f"the check {check.sentence!r}", check.value) for check in (*model.static_checks, *model.checks))


def _has_nan(value: ca.SX) -> bool:
    """Whether a constant in an expression is not a number."""
    function = ca.Function("constants", ca.symvar(value), [value])
    constants = (i for i in range(function.n_instructions()) if function.instruction_id(i) == ca.OP_CONST)
    return any(math.isnan(function.instruction_constant(i)) for i in constants)


def _function(name: str, arguments: dict[str, ca.SX], results: dict[str, ca.SX]) -> ca.Function:
    """A CasADi function with its common subexpressions shared."""
    shared = ca.cse(stack(list(results.values())))
    ends = [0]
    for value in results.values():
        ends.append(ends[-1] + value.numel())
    parts = ca.vertsplit(shared, ends)
    try:
        return ca.Function(name, list(arguments.values()), list(parts), list(arguments), list(results))
    except RuntimeError as error:
        msg = f"Function {name} depends on a symbol that is not declared: {error}"
        raise DefinitionError(msg) from error
