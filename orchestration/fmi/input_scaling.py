"""Converts inputs between units, by compiled functions that are called in place of an FMU's own.

The compiled loops copy an output to an input unchanged, and call the addresses in their table. Where a
connection scales, the table has a stand-in for the instance and functions of the same signatures:

    fmi2SetReal(v)                  v_i -> factor_i v_i + offset_i
    fmi2SetRealInputDerivatives(v)  v_i -> factor_i v_i
    fmi2GetDirectionalDerivative    with the seed times factor_i

and then call the FMU's own function. So every algorithm sees the input in the unit of its source, also in residuals
and tolerances. A system without scaling runs the same code as if this module did not exist.
"""

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any, cast

import numpy as np
from numba import types
from numba.core.ccallback import CFunc
from numba.core.registry import CPUDispatcher

from orchestration.fmi.codes import Status
from orchestration.fmi.kept_code import keep_machine_code
from orchestration.fmi.machine_code import code_folder
from orchestration.fmi.native_calls import (
    SOURCES,
    emit_direction,
    emit_do_step,
    emit_rates,
    emit_state,
    emit_transfer,
    load_integer,
    load_real,
    load_reference,
    store_real,
)
from orchestration.fmi.units import Linear

# Slots of the stand-in, eight bytes each: the instance, addresses of its functions, then the number of
# scaled inputs, addresses of their references, factors and offsets, and of a buffer with its length.
_FUNCTIONS = (
    *("fmi2DoStep", "fmi2SetReal", "fmi2SetInteger", "fmi2SetBoolean"),
    *("fmi2GetReal", "fmi2GetInteger", "fmi2GetBoolean", "fmi2GetFMUstate", "fmi2SetFMUstate"),
    *("fmi2SetRealInputDerivatives", "fmi2GetDirectionalDerivative"),
)
_FIRST = 1 + len(_FUNCTIONS)
_SLOTS = {name: 1 + i for i, name in enumerate(_FUNCTIONS)}
_N, _REFERENCES, _FACTORS, _OFFSETS, _BUFFER, _CAPACITY = range(_FIRST, _FIRST + 6)
_DO_STEP, _SET_REAL = _SLOTS["fmi2DoStep"], _SLOTS["fmi2SetReal"]
_SET_RATES, _DIRECTION = _SLOTS["fmi2SetRealInputDerivatives"], _SLOTS["fmi2GetDirectionalDerivative"]
_ORDERS = 2  # of input derivatives that are handed over at once
_ERROR = int(Status.ERROR)
_I64 = types.int64


class ScaledInputs:
    """A stand-in for an instance of an FMU that converts the Real inputs it receives.

    Parameters
    ----------
    handle
        Address of the instance.
    own
        Returns the address of an FMU's own function by its name.
    scales
        Conversion of each Real input, by value reference.
    n_inputs
        Number of the FMU's inputs.
    """

    def __init__(self, handle: int, own: Callable[[str], int], scales: Mapping[int, Linear], n_inputs: int) -> None:
        self._own = own
        references = np.array(sorted(scales), np.uint32)
        factors = np.array([scales[reference].factor for reference in sorted(scales)])
        offsets = np.array([scales[reference].offset for reference in sorted(scales)])
        buffer = np.zeros(max(1, _ORDERS * n_inputs))
        arrays = (references, factors, offsets, buffer)
        addresses = [array.ctypes.data for array in arrays]
        functions = [own(name) for name in _FUNCTIONS]
        self._slots = np.array([handle, *functions, len(references), *addresses, len(buffer)], np.int64)
        self._alive = arrays

    @property
    def component(self) -> int:
        """Address of the stand-in."""
        return self._slots.ctypes.data

    def address(self, function: str) -> int:
        """Address of the function to call with it."""
        return _stand_in(function) if function in _SLOTS else self._own(function)


@cache
def _stand_in(function: str) -> int:
    """Return the address of the compiled stand-in for an FMI function; it is compiled when it is first needed."""
    slot = _SLOTS[function]
    signature, body = {
        _DO_STEP: (types.int32(_I64, types.float64, types.float64, types.int32), _do_step),
        _SET_REAL: (types.int32(*[_I64] * 4), _set_real),
        _SET_RATES: (types.int32(*[_I64] * 5), _set_rates),
        _DIRECTION: (types.int32(*[_I64] * 7), _direction),
    }.get(slot, (None, None))
    if body is None:
        state = function.endswith("FMUstate")
        signature = types.int32(_I64, _I64) if state else types.int32(*[_I64] * 4)
        body = _forward_state(slot) if state else _forward_transfer(slot)
    made = CFunc(body, (signature.args, signature.return_type), locals={}, options={"error_model": "numpy"})
    keep_machine_code(made, body, _folder()).compile()
    _compiled[function] = made
    return cast("int", made.address)


@cache
def _folder() -> Path | None:
    """Return the folder that keeps the machine code of this module; None if nothing is kept."""
    return code_folder([Path(__file__), *SOURCES])


_compiled: dict[str, Any] = {}  # keeps the code that addresses point to


@CPUDispatcher  # not njit, which does nothing where compilation is off for loops
def _place(unit, reference):
    """Return the place of an input among the scaled inputs, whose references go up; -1 if it is not among them."""
    listed, low, high = load_integer(unit + 8 * _REFERENCES), 0, load_integer(unit + 8 * _N)
    while low < high:
        middle = (low + high) // 2
        if load_reference(listed + 4 * middle) < reference:
            low = middle + 1
        else:
            high = middle
    return low if low < load_integer(unit + 8 * _N) and load_reference(listed + 4 * low) == reference else -1


def _do_step(unit, t, h, final):  # noqa: ARG001 - emit_do_step says that no step is undone
    return emit_do_step(load_integer(unit + 8 * _DO_STEP), load_integer(unit), t, h)


def _set_real(unit, references, n, values):
    buffer = load_integer(unit + 8 * _BUFFER)
    if n > load_integer(unit + 8 * _CAPACITY):
        return types.int32(_ERROR)
    for i in range(n):
        value = load_real(values + 8 * i)
        j = _place(unit, load_reference(references + 4 * i))
        if j >= 0:
            factor = load_real(load_integer(unit + 8 * _FACTORS) + 8 * j)
            value = factor * value + load_real(load_integer(unit + 8 * _OFFSETS) + 8 * j)
        store_real(buffer + 8 * i, value)
    return emit_transfer(load_integer(unit + 8 * _SET_REAL), load_integer(unit), references, n, buffer)


def _set_rates(unit, references, n, orders, values):
    buffer = load_integer(unit + 8 * _BUFFER)
    if n > load_integer(unit + 8 * _CAPACITY):
        return types.int32(_ERROR)
    for i in range(n):
        value = load_real(values + 8 * i)
        j = _place(unit, load_reference(references + 4 * i))
        if j >= 0:
            value *= load_real(load_integer(unit + 8 * _FACTORS) + 8 * j)
        store_real(buffer + 8 * i, value)
    return emit_rates(load_integer(unit + 8 * _SET_RATES), load_integer(unit), references, n, orders, buffer)


def _direction(unit, unknowns, n, known, one, seed, values):  # noqa: ARG001 - there is one known variable
    buffer = load_integer(unit + 8 * _BUFFER)
    value = load_real(seed)
    j = _place(unit, load_reference(known))
    if j >= 0:
        value *= load_real(load_integer(unit + 8 * _FACTORS) + 8 * j)
    store_real(buffer, value)
    return emit_direction(load_integer(unit + 8 * _DIRECTION), load_integer(unit), unknowns, n, known, buffer, values)


def _forward_transfer(slot: int) -> Callable:
    def forward(unit, references, n, values):
        return emit_transfer(load_integer(unit + 8 * slot), load_integer(unit), references, n, values)

    return forward


def _forward_state(slot: int) -> Callable:
    def forward(unit, state):
        return emit_state(load_integer(unit + 8 * slot), load_integer(unit), state)

    return forward
