"""Exact derivatives of a model's outputs, by algorithmic differentiation.

    output_rate          dy/dt along the motion, for inputs that change at the rates v
    output_sensitivity   dy = (dy/du) v at fixed states: what reaches an output within a communication point
    initial_sensitivity  dy = (dy/du) v + (dy/dp) q during initialization, through the first states

Where a value switches, the derivative is that of the branch taken; event modes are held.
"""

from collections.abc import Sequence

import casadi as ca

from adaptimp_fmu.columns import evolutions, inputs, parameters, stack, states
from adaptimp_fmu.continuous_model import ContinuousModel
from adaptimp_fmu.model import Model
from adaptimp_fmu.sampled_model import SampledModel


def sensitivity_functions(model: Model) -> Sequence[ca.Function]:
    """Return the derivative functions of a model by name; only a continuous model has the first two.

    Arguments are those of the seam (``runtime/model.h``): t, x, u, p, m, r and the directions v of the
    inputs and q of the parameters, shape (n_u,) and (n_p,).
    """
    u, p = inputs(model), parameters(model)
    y = stack(model.output_values)
    v = ca.SX.sym("v", u.numel())
    functions = [_initial_sensitivity(model, v)]
    if isinstance(model, ContinuousModel):
        x, dx = states(model), stack(evolutions(model))
        m = stack([event.mode for event in model.events])
        names, arguments = ["t", "x", "u", "p", "m", "v"], [model.time, x, u, p, m, v]
        rate = _along(y, [x, u, model.time], [dx, v, ca.SX(1)])
        direct = _along(y, [u], [v])
        functions.append(ca.Function("output_rate", arguments, [ca.cse(rate)], names, ["dy"]))
        functions.append(ca.Function("output_sensitivity", arguments, [ca.cse(direct)], names, ["dy"]))
    return functions


def initial_outputs(model: Model, uniforms: ca.SX) -> ca.SX:
    """Return the outputs in initialization mode: states at their first values, modes by their indicators."""
    y = stack(model.output_values)
    for event in getattr(model, "events", ()):
        y = ca.substitute(y, event.mode, event.indicator > 0)
    if isinstance(model, SampledModel) and model.noise:
        drawn = ca.substitute(model.noise.value, model.noise.uniforms, uniforms)
        y = ca.substitute(y, model.noise.symbol, ca.if_else(model.noise.active > 0, drawn, 0))
    symbols = [state.symbol for state in model.states]
    return ca.substitute([y], symbols, [state.initial for state in model.states])[0] if symbols else y


def _initial_sensitivity(model: Model, v: ca.SX) -> ca.Function:
    u, p = inputs(model), parameters(model)
    r, q = ca.SX.sym("r", 4), ca.SX.sym("q", p.numel())
    dy = _along(initial_outputs(model, r), [u, p], [v, q])
    names, arguments = ["t", "u", "p", "r", "v", "q"], [model.time, u, p, r, v, q]
    return ca.Function("initial_sensitivity", arguments, [ca.cse(dy)], names, ["dy"])


def _along(y: ca.SX, variables: Sequence[ca.SX], directions: Sequence[ca.SX]) -> ca.SX:
    """Return the derivative of y along a direction, with the shape of y."""
    pairs = [(a, d) for a, d in zip(variables, directions, strict=True) if a.numel()]
    if not pairs:
        return ca.SX.zeros(y.numel(), 1)
    total = ca.jtimes(y, stack([a for a, _ in pairs]), stack([d for _, d in pairs]))
    return ca.densify(total)
