"""Saved states of a single FMU: each has a head that tells which FMU it is of, and the time."""

import hashlib
import struct
from dataclasses import dataclass, field
from typing import Any

from orchestration.errors import SignalError
from orchestration.fmi.given import require_type

_HEAD = struct.Struct("<16sddqq")  # which FMU; origin, step, steps since the origin, steps
Clock = tuple[float, float, int, int]
"""Origin, s, step, s, steps since the origin, and steps."""


@dataclass(frozen=True)
class SavedState:
    """A saved state of an FMU that cannot serialize it; the state is valid for the same open `Fmu` only."""

    head: bytes
    owner: object = field(repr=False)
    state: Any = field(repr=False)


def with_head(state: Any, guid: str, clock: Clock, owner: object) -> bytes | SavedState:
    """The state of an FMU with its head; bytes if the state is."""
    head = _HEAD.pack(_key(guid), *clock)
    return head + state if isinstance(state, bytes) else SavedState(head, owner, state)


def without_head(name: str, guid: str, state: Any, owner: object) -> tuple[Any, Clock]:
    """The bare state of an FMU of a name, and its clock.

    Raises
    ------
    SignalError
        If it is the state of another FMU, or none at all.
    """
    require_type(f"{name}: the state", state, (bytes, SavedState), "give one that save() returned", SignalError)
    if isinstance(state, SavedState):
        head, own, foreign = state.head, state.state, state.owner is not owner
    else:
        head, own, foreign = state[: _HEAD.size], state[_HEAD.size :], False
    if foreign or len(head) < _HEAD.size or not head.startswith(_key(guid)):
        msg = f"{name}: the state to restore is of another FMU, or damaged; use one that save() returned."
        raise SignalError(msg)
    _, *clock = _HEAD.unpack(head)
    return own, (clock[0], clock[1], clock[2], clock[3])


def _key(guid: str) -> bytes:
    """A key that marks the states of an FMU, so that a state of another FMU is noticed."""
    return hashlib.sha256(guid.encode()).digest()[:16]
