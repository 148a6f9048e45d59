"""From a declaration to the functions that the runtime calls.

Expressions of parameters alone are moved into ``calibrate``, which runs when parameters change;
common subexpressions are shared within each function.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.model import ContinuousModel, Model, SampledModel


@dataclass(frozen=True)
class Lowered:
    """A model as functions of plain numbers.

    Attributes
    ----------
    functions
        In the order of the seam, see ``runtime/model.h``.
    n_constants
        Number of constants that ``calibrate`` derives from the parameters.
    """

    functions: tuple[ca.Function, ...]
    n_constants: int


@dataclass(frozen=True)
class Routine:
    """A function before lowering: name, arguments besides p and c, and named results."""

    name: str
    arguments: dict[str, ca.SX]
    results: dict[str, ca.SX]


def stack(parts: Sequence[ca.SX]) -> ca.SX:
    """Concatenate column vectors; the empty list gives an empty column."""
    return ca.vertcat(*parts) if parts else ca.SX(0, 1)


def parameters(model: Model) -> ca.SX:
    """All parameters, shape (n_p,), in the order of their value references."""
    return stack(model.parameter_symbols)


def inputs(model: Model) -> ca.SX:
    """All inputs, shape (n_u,), in the order of their value references."""
    return stack(model.input_symbols)


def lower(model: Model) -> Lowered:
    """Lower a model.

    Raises
    ------
    DefinitionError
        If the name is no C identifier, there are no outputs, a state has no evolution, or a value
        depends on a symbol that the model does not declare.
    """
    _require_complete(model)
    p = parameters(model)
    routines = list(_routines(model))
    flat = stack([stack(list(r.results.values())) for r in routines])
    flat, symbols, values = ca.extract_parametric(flat, p)
    constants = stack([ca.vec(s) for s in symbols])
    calibration = ca.cse(
        stack([*(ca.vec(v) for v in values), *(c.value for c in model.static_checks), _noise_active(model)])
    )
    split = [0, constants.numel(), constants.numel() + len(model.static_checks), calibration.numel()]
    functions = [
        _function(
            "calibrate",
            {"p": p},
            dict(zip(("c", "checks", "active"), ca.vertsplit(calibration, split), strict=True)),
        )
    ]
    offset = 0
    for routine in routines:
        results = {}
        for name, value in routine.results.items():
            results[name] = flat[offset : offset + value.numel(), 0]  # a bare slice of one element is a row
            offset += value.numel()
        functions.append(_function(routine.name, {**routine.arguments, "p": p, "c": constants}, results))
    return Lowered(tuple(functions), constants.numel())


def _routines(model: Model) -> Sequence[Routine]:
    t, u = model.time, inputs(model)
    x = stack([state.symbol for state in model.states])
    y = stack(model.output_values)
    evolution = stack([ca.SX(state.evolution) for state in model.states])
    checks = stack([check.value for check in model.checks])
    initial = Routine("initial", {"t": t, "u": u}, {"x": stack([s.initial for s in model.states])})
    if isinstance(model, SampledModel):
        w = model.noise.symbol if model.noise else ca.SX(0, 1)
        arguments = {"t": t, "x": x, "u": u, "w": w}
        held = stack([s.symbol if s.slow else ca.SX(s.evolution) for s in model.states])
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
        Routine("derivative", arguments, {"dx": evolution}),
        Routine("output", arguments, {"y": y, "checks": checks}),
    ]
    if model.events:
        z = stack([event.indicator for event in model.events])
        routines.append(Routine("event_indicators", {"t": t, "x": x}, {"z": z}))
    return routines


def _noise_active(model: Model) -> ca.SX:
    return model.noise.active if isinstance(model, SampledModel) and model.noise else ca.SX(0)


def _require_complete(model: Model) -> None:
    if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", model.name):
        msg = f"{model.name!r} is no C identifier, so it cannot name an FMU."
        raise DefinitionError(msg)
    if not model.output_values:
        msg = f"{model.name} has no outputs."
        raise DefinitionError(msg)
    for state in model.states:
        if state.evolution is None:
            msg = f"{model.name}: state {state.name} has no derivative or update."
            raise DefinitionError(msg)


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
