"""Finds the inputs and parameters that each output of a model depends on, from the sparsity of Jacobians."""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu.columns import inputs, parameters, stack
from adaptimp_fmu.model import Model
from adaptimp_fmu.sampled_model import SampledModel


@dataclass(frozen=True)
class Dependencies:
    """Value references that each output depends on, in the order of the outputs.

    Attributes
    ----------
    in_step
        After initialization: inputs that reach the output at the same communication point. A
        sampled model has none, since its outputs belong to the tick.
    initial
        During initialization: parameters and inputs.
    """

    in_step: tuple[tuple[int, ...], ...]
    initial: tuple[tuple[int, ...], ...]


def dependencies(model: Model) -> Dependencies:
    """Return the value references that each output of a model depends on."""
    p, u = parameters(model), inputs(model)
    y = stack(model.output_values)
    if isinstance(model, SampledModel):
        direct: list[list[int]] = [[] for _ in range(y.numel())]
    else:
        direct = _rows(y, u)
    initial_y = _initial_outputs(model, y)
    n_p = p.numel()
    initial = _rows(initial_y, ca.vertcat(p, u))
    return Dependencies(
        in_step=tuple(tuple(n_p + j for j in row) for row in direct),
        initial=tuple(tuple(row) for row in initial),
    )


def _initial_outputs(model: Model, y: ca.SX) -> ca.SX:
    """Return the outputs with states replaced by their first values and modes by their indicators."""
    symbols = [state.symbol for state in model.states]
    values = [state.initial for state in model.states]
    for event in getattr(model, "events", ()):
        y = ca.substitute(y, event.mode, event.indicator)
    if isinstance(model, SampledModel) and model.noise:
        noise = model.noise
        seeded = noise.value + noise.active + noise_seed(model)
        y = ca.substitute(y, noise.symbol, seeded)
    return ca.substitute([y], symbols, values)[0] if symbols else y


def noise_seed(model: SampledModel) -> ca.SX:
    """Return the symbol of the parameter that seeds the noise."""
    if model.noise is None:
        return ca.SX(0)
    index = model.reference(model.noise.seed_name)
    return parameters(model)[index]


def _rows(y: ca.SX, of: ca.SX) -> list[list[int]]:
    """Column indices of the structural non-zeros of dy/d(of), by row."""
    pattern = ca.jacobian_sparsity(y, of)
    rows: list[list[int]] = [[] for _ in range(y.numel())]
    for row, column in zip(*pattern.get_triplet(), strict=True):
        rows[row].append(column)
    return [sorted(row) for row in rows]
