"""Declares a model a second time with Reals in the place of its Booleans and Integers, for tools that know Reals only.

A Boolean becomes a Real that is 0 or 1, an Integer a Real that is a whole number. Names, start values, ranges,
dependencies and equations stay. The runtime refuses any other value. The declared type of such a variable says what
the variable stands for.
"""

import sys
from copy import copy
from dataclasses import replace

import casadi as ca

from adaptimp_fmu.model import Model
from adaptimp_fmu.sampled_model import SampledModel
from adaptimp_fmu.variables import Role, Type, Variable

REMARK = "Booleans are Reals of 0 and 1, and Integers are Reals of whole numbers"
"""What the description of such an FMU says besides that of the model."""
_LARGEST = sys.float_info.max


def as_reals(model: Model) -> Model:
    """Return a model with Reals in the place of Booleans and Integers; the given one is left as it is.

    A model that has only Reals is returned itself.

    Raises
    ------
    DefinitionError
        If a divisor or a seed is not a suitable parameter.
    """
    if all(variable.type is Type.REAL for variable in model.variables):
        return model
    if isinstance(model, SampledModel):
        model.require_named_parameters()
    changed = copy(model)
    changed.description = f"{model.description.rstrip('.')}. {REMARK}"
    changed.variables = [_as_real(variable) for variable in model.variables]
    changed.output_values = _as_shown(model)
    return changed


def _as_real(variable: Variable) -> Variable:
    """The variable as a Real."""
    if variable.type is Type.REAL:
        return variable
    if variable.type is Type.BOOLEAN:
        least, most = max(variable.minimum, 0.0), min(variable.maximum, 1.0)
        return replace(variable, type=Type.REAL, stands_for=Type.BOOLEAN, minimum=least, maximum=most)
    return replace(variable, type=Type.REAL, stands_for=Type.INTEGER)


def _as_shown(model: Model) -> list[ca.SX]:
    """Values of the outputs, where each Boolean is 0 or 1: in the runtime other numbers than 0 mean true."""
    variables = iter(model.with_role(Role.OUTPUT))
    shown = []
    for value in model.output_values:
        types = {next(variables).type for _ in range(value.numel())}
        shown.append(_truth(value) if Type.BOOLEAN in types else value)
    return shown


def _truth(value: ca.SX) -> ca.SX:
    """1 if a number is not 0; what is not finite stays, so that the runtime reports it."""
    return ca.if_else(ca.fabs(value) <= _LARGEST, value != 0, value)
