"""Declares a model a second time with Reals in the place of its Booleans and Integers, for tools that know Reals only.

A Boolean becomes a Real that is 0 or 1, an Integer a Real that is a whole number. Names, start values, ranges,
dependencies and equations stay. The runtime refuses any other value. The declared type of such a variable says what
the variable stands for.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace

import casadi as ca

from adaptimp_fmu.model import Model
from adaptimp_fmu.sampled_model import SampledModel
from adaptimp_fmu.variables import Role, Type, Variable

REMARK = "Booleans are Reals of 0 and 1, Integers are Reals of whole numbers"
"""What the description of such an FMU says besides that of the model."""
_LARGEST = 1.7976931348623157e308


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
    types = [variable.type for variable in model.with_role(Role.OUTPUT)]
    changed.output_values = _as_shown(model.output_values, types)
    return changed


def _as_real(variable: Variable) -> Variable:
    """The variable as a Real."""
    if variable.type is Type.REAL:
        return variable
    if variable.type is Type.BOOLEAN:
        return replace(variable, type=Type.REAL, stands_for=Type.BOOLEAN, minimum=0.0, maximum=1.0)
    return replace(variable, type=Type.REAL, stands_for=Type.INTEGER)


def _as_shown(values: Sequence[ca.SX], types: Sequence[Type]) -> list[ca.SX]:
    """Values of outputs, where each Boolean is 0 or 1 if it is a number: other Booleans than 0 mean true."""
    shown, first = [], 0
    for value in values:
        elements = ca.vertsplit(value)
        kinds = types[first : first + len(elements)]
        first += len(elements)
        shown.append(ca.vertcat(*(_truth(e) if kind is Type.BOOLEAN else e for e, kind in zip(elements, kinds, strict=True))))
    return shown


def _truth(value: ca.SX) -> ca.SX:
    """1 if a number is not 0; what is not finite stays, so that the runtime reports it."""
    return ca.if_else(ca.fabs(value) <= _LARGEST, value != 0, value)
