"""A model's symbols as column vectors, in the order of their value references."""

from collections.abc import Sequence

import casadi as ca

from adaptimp_fmu.model import Model


def stack(parts: Sequence[ca.SX]) -> ca.SX:
    """Concatenate column vectors; the empty list gives an empty column."""
    return ca.vertcat(*parts) if parts else ca.SX(0, 1)


def parameters(model: Model) -> ca.SX:
    """All parameters, shape (n_p,)."""
    return stack(model.parameter_symbols)


def inputs(model: Model) -> ca.SX:
    """All inputs, shape (n_u,)."""
    return stack(model.input_symbols)
