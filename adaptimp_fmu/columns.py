"""Column vectors of a model's symbols, in the order of their FMI value references."""

from collections.abc import Sequence

import casadi as ca

from adaptimp_fmu.continuous_model import ContinuousModel
from adaptimp_fmu.errors import DefinitionError
from adaptimp_fmu.model import Model


def stack(parts: Sequence[ca.SX]) -> ca.SX:
    """Concatenate column vectors; the empty list gives an empty column."""
    return ca.vertcat(*parts) if parts else ca.SX(0, 1)


def parameters(model: Model) -> ca.SX:
    """Return the symbols of all parameters as a column, shape (n_p,)."""
    return stack(model.parameter_symbols)


def inputs(model: Model) -> ca.SX:
    """Return the symbols of all inputs as a column, shape (n_u,)."""
    return stack(model.input_symbols)


def states(model: Model) -> ca.SX:
    """Return the symbols of all states as a column, shape (n_x,)."""
    return stack([state.symbol for state in model.states])


def evolutions(model: Model) -> list[ca.SX]:
    """Return the derivatives of a continuous model's states, or the next values of a sampled model's states.

    Raises
    ------
    DefinitionError
        If a state has neither a derivative nor an update.
    """
    values = []
    for state in model.states:
        if state.evolution is None:
            call = "derivative" if isinstance(model, ContinuousModel) else "update"
            call = f"model.{call}({state.name}, ...)"
            msg = f"{model.name}: state {state.name} has no derivative or update; give one with {call}."
            raise DefinitionError(msg)
        values.append(state.evolution)
    return values
