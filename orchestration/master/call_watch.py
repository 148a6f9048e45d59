"""Tells which messages of an FMU belong to which call of a compiled loop, at no cost for FMUs that log nothing.

A loop calls an FMU by addresses that stand in tables. When an FMU logs its first message of a run, its addresses are
replaced by those of functions of Python. Such a function takes note that a call begins, and makes the call. The first
message itself belongs to the call that is being made then.
"""

import ctypes as ct
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, cast

import numpy as np

from orchestration.fmi.deferred import keep
from orchestration.fmi.instance import Instance
from orchestration.fmi.logging import Messages
from orchestration.master.kernel.codes import Column

_Step = ct.CFUNCTYPE(ct.c_int, ct.c_void_p, ct.c_double, ct.c_double, ct.c_int)
_Transfer = ct.CFUNCTYPE(ct.c_int, ct.c_void_p, ct.c_void_p, ct.c_size_t, ct.c_void_p)
_State = ct.CFUNCTYPE(ct.c_int, ct.c_void_p, ct.c_void_p)
_Rates = ct.CFUNCTYPE(ct.c_int, ct.c_void_p, ct.c_void_p, ct.c_size_t, ct.c_void_p, ct.c_void_p)
_Direction = ct.CFUNCTYPE(
    ct.c_int, ct.c_void_p, ct.c_void_p, ct.c_size_t, ct.c_void_p, ct.c_size_t, ct.c_void_p, ct.c_void_p
)
_TRANSFERS = (
    *(Column.SET_REAL, Column.SET_INTEGER, Column.SET_BOOLEAN),
    *(Column.GET_REAL, Column.GET_INTEGER, Column.GET_BOOLEAN),
)
_TYPES: dict[Column, Any] = {
    Column.DO_STEP: _Step,
    **dict.fromkeys(_TRANSFERS, _Transfer),
    Column.GET_STATE: _State,
    Column.SET_STATE: _State,
    Column.GET_DIRECTION: _Direction,
    Column.SET_RATES: _Rates,
}
"""C types of the functions whose addresses stand in these columns of the table of components."""


class CallWatch:
    """Follows the calls of instances from their first message on.

    Parameters
    ----------
    table
        Table of components, whose addresses are replaced.
    instances
        Instances in the order of the components.
    """

    def __init__(self, table: np.ndarray, instances: Sequence[Instance]) -> None:
        self._table, self._instances = table, instances
        self._operations: np.recarray | None = None
        self._followed: set[int] = set()
        self._own: dict[int, Any] = {}  # functions that are called by address
        for i, instance in enumerate(instances):
            instance.messages.listener = partial(self._follow, i)

    def complete(self, operations: np.recarray) -> None:
        """Take note of the operations of a step, and that the table has all addresses now."""
        self._operations = operations
        for i in self._followed:
            self._replace(i)

    def _follow(self, i: int) -> None:
        self._followed.add(i)
        self._replace(i)

    def _replace(self, i: int) -> None:
        """Replace the addresses of component i that are not replaced yet."""
        for column, kind in _TYPES.items():
            address = int(self._table[i, column])
            if address and address not in self._own:
                self._table[i, column] = self._noting(i, kind, address)
        if self._operations is None:
            return
        mine = self._operations.subject == i
        self._operations.function[mine] = self._table[i, self._operations.call[mine]]

    def _noting(self, i: int, kind: Any, address: int) -> int:
        """Return the address of a function that notes a call of component i and makes it."""
        function = kind(partial(_noted, self._instances[i].messages, kind(address)))
        found = int(ct.cast(cast("Any", function), ct.c_void_p).value or 0)
        self._own[found] = function
        return found


def _noted(messages: Messages, function: Callable[..., int], *arguments: Any) -> int:
    """Make a call exactly once, also if Ctrl-C arrives meanwhile, and return its fmi2Status.

    The status goes into a list within one operation of Python, so an interrupt comes before or after both.
    """
    returned: list[int] = []
    try:
        messages.begin_call()
        returned.extend(map(function, *([argument] for argument in arguments)))
    except KeyboardInterrupt as interrupt:
        keep(interrupt)
        if not returned:
            returned.append(function(*arguments))
    return returned[0]
