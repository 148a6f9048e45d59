"""The equations of a model, as declared in fmus/, evaluated at many samples: no FMU, no time stepping."""

from collections.abc import Callable
from functools import cache

import casadi as ca
import numpy as np

from adaptimp_fmu import ContinuousModel, Model, SampledModel
from adaptimp_fmu.variables import Role
from fmus.catalog import model as declared


def outputs(identifier: str, **columns: np.ndarray) -> dict[str, np.ndarray]:
    """Outputs of a model of the catalog at given states, inputs and parameters.

    Parameters
    ----------
    columns
        By name, shape (k, size): all states, the modes of events as ``mode_NAME``, and those inputs and
        parameters that differ from their start values.

    Returns
    -------
    dict
        By name, shape (size, k); states of a sampled model after the tick as ``NAME_next``.
    """
    return _values(*_function(identifier), columns)


def outputs_of(declare: Callable[[], Model], **columns: np.ndarray) -> dict[str, np.ndarray]:
    """Outputs of a model that a function declares, as `outputs` gives those of the catalog."""
    return _values(*_as_function(declare()), columns)


def evaluator(model: Model) -> Callable[..., dict[str, np.ndarray]]:
    """A function that gives the outputs of a model for columns by name, as often as it is called."""
    function, starts = _as_function(model)
    return lambda **columns: _values(function, starts, columns)


def _values(
    function: ca.Function, starts: dict[str, np.ndarray], columns: dict[str, np.ndarray]
) -> dict[str, np.ndarray]:
    """What a function gives at every sample."""
    size = max(values.shape[1] for values in columns.values())
    given = {name: np.tile(values[:, None], size) for name, values in starts.items()} | columns
    values = function.map(size)(*(given[name] for name in function.name_in()))
    values = values if isinstance(values, tuple) else (values,)
    return {name: np.array(value).T for name, value in zip(function.name_out(), values, strict=True)}


@cache
def _function(identifier: str) -> tuple[ca.Function, dict[str, np.ndarray]]:
    """The map of a model of the catalog to all outputs, and start values."""
    return _as_function(declared(identifier))


def _as_function(model: Model) -> tuple[ca.Function, dict[str, np.ndarray]]:
    """The map to all outputs, and the start values of inputs and parameters."""
    parameters = [variable for variable in model.variables if variable.role.is_parameter]
    inputs, shown = model.with_role(Role.INPUT), model.with_role(Role.OUTPUT)
    symbols = dict(zip(_names(parameters), model.parameter_symbols, strict=True))
    symbols |= dict(zip(_names(inputs), model.input_symbols, strict=True))
    starts = {
        name: np.array([v.start for v in (*parameters, *inputs) if v.name.partition("[")[0] == name], dtype=float)
        for name in symbols
    }
    symbols |= {state.name: state.symbol for state in model.states}
    if isinstance(model, ContinuousModel):
        symbols |= {f"mode_{event.name}": event.mode for event in model.events}
    values = dict(zip(_names(shown), model.output_values, strict=True))
    if isinstance(model, SampledModel):
        values |= {f"{state.name}_next": state.evolution for state in model.states if state.evolution is not None}
    result = {f"{name}_out" if name in symbols else name: value for name, value in values.items()}
    return ca.Function("unit", list(symbols.values()), list(result.values()), list(symbols), list(result)), starts


def _names(variables: list) -> list[str]:
    """Names of the vectors, in order."""
    return list(dict.fromkeys(variable.name.partition("[")[0] for variable in variables))
