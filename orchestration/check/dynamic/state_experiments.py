"""Experiments on rules 13 and 14: reset, saved states, serialized states, split steps, several instances."""

import ctypes as ct
import random

from orchestration.check.dynamic.bitwise_runs import STEPS, Rows, Yield, fresh_rows, move, moves, run, same, trace
from orchestration.check.dynamic.instance import Binary, Instance, RefusedError
from orchestration.check.findings import note, warning
from orchestration.fmi.codes import accepted

LARGEST_STATE = 1024**3  # bytes


def reset(binary: Binary) -> Yield:
    """Try rule 13: after fmi2Reset an instance behaves like a fresh one, bit by bit."""
    moved = moves(binary)
    fresh = fresh_rows(binary, moved)
    with Instance(binary) as instance:
        instance.initialize()
        run(instance, moved, seed=2)
        instance.call("fmi2Reset")
        instance.initialize()
        again = run(instance, moved, first=True)
    if not binary.plan["random"]:
        yield from same(binary, fresh, again, "13", "After fmi2Reset", "in a fresh instance")


def rollback(binary: Binary) -> Yield:
    """Try rule 13: from a saved state the same steps give the same bits, twice."""
    moved = moves(binary)
    with Instance(binary) as instance:
        instance.initialize()
        run(instance, moved)
        state, time, saved = ct.c_void_p(), instance.time, instance.outputs()
        instance.call("fmi2GetFMUstate", ct.byref(state))
        first = [saved, *run(instance, moved, seed=3)]
        for _ in range(2):
            instance.call("fmi2SetFMUstate", state)
            instance.time = time
            again = [instance.outputs(), *run(instance, moved, seed=3)]
            wrong = list(same(binary, first, again, "13", "After fmi2SetFMUstate", "when the state was saved"))
            if wrong and not binary.plan["random"]:
                yield from wrong
                break
        instance.call("fmi2FreeFMUstate", ct.byref(state))


def serialization(binary: Binary) -> Yield:
    """Try rule 13: from a serialized state an instance that is initialized gives the same bits."""
    moved = moves(binary)
    with Instance(binary) as instance:
        instance.initialize()
        run(instance, moved)
        blob, time = _serialized(instance), instance.time
        first = [instance.outputs(), *run(instance, moved, seed=3)]
        again = _restored(instance, blob, time, moved) if binary.plan["once"] else None
    if again is None:
        with Instance(binary) as other:
            again = _restored(other.initialize(), blob, time, moved)
    if not binary.plan["random"]:
        yield from same(binary, first, again, "13", "With its state deserialized", "in the instance it came from")


def early_restoring(binary: Binary) -> Yield:
    """Try rule 13 more strictly: a serialized state can be set in an instance that is not initialized."""
    moved = moves(binary)
    with Instance(binary) as instance:
        instance.initialize()
        run(instance, moved)
        blob, time = _serialized(instance), instance.time
        first = [instance.outputs(), *run(instance, moved, seed=3)]
    try:
        with Instance(binary) as other:
            again = _restored(other, blob, time, moved)
    except RefusedError as refused:
        yield note("13", f"A state can be restored in an initialized instance only. In a fresh one, {refused}")
        return
    if not binary.plan["random"]:
        when = "With its state deserialized in an instance that is not initialized"
        for found in same(binary, first, again, "13", when, "in the instance it came from"):
            yield note(found.rule, found.message)


def _restored(instance: Instance, blob: bytes, time: float, moved: bool) -> Rows:
    """Set a serialized state; returns the outputs then and in the steps that follow."""
    state = ct.c_void_p()
    instance.call("fmi2DeSerializeFMUstate", blob, len(blob), ct.byref(state))
    instance.call("fmi2SetFMUstate", state)
    instance.call("fmi2FreeFMUstate", ct.byref(state))
    instance.time = time
    return [instance.outputs(), *run(instance, moved, seed=3)]


def torn_state(binary: Binary) -> Yield:
    """Try rule 13: a serialized state that is cut off is refused."""
    with Instance(binary) as instance:
        blob, state = _serialized(instance.initialize()), ct.c_void_p()
        half = blob[: len(blob) // 2]
        if half and accepted(instance.status("fmi2DeSerializeFMUstate", half, len(half), ct.byref(state))):
            yield warning("13", f"fmi2DeSerializeFMUstate accepts {len(half)} of {len(blob)} bytes of a state.")


def splitting(binary: Binary) -> Yield:
    """Try rule 14: compare a step with its two halves; only a sampled FMU must give the same bits.

    An FMU with a step of its own takes whole multiples of that step only. There two proposed steps are taken at once.
    """
    h, rows = binary.plan["step"], []
    if not _takes(binary, h / 2):
        yield f"A step of {h / 2:g} s, half of the proposed one, is refused; steps of {2 * h:g} s were split instead."
        h = 2 * h
    for parts in (1, 2):
        with Instance(binary) as instance:
            instance.initialize()
            found = []
            for _ in range(STEPS):
                for _ in range(parts):
                    instance.step(h / parts)
                found.append(instance.outputs())
            rows.append(found)
    if binary.plan["random"]:
        return
    if binary.plan["sampled"]:
        difference = list(same(binary, rows[0], rows[1], "14", "With each step split in two", "with whole steps"))
        yield from (warning(found.rule, found.message) for found in difference)
    else:
        pairs = [(a, b) for one, two in zip(*rows, strict=True) for a, b in zip(one, two, strict=True)]
        worst = max((abs(a - b) / max(1.0, abs(a)) for a, b in pairs), default=0.0)
        yield f"Steps of {h:g} s split in two change outputs by at most {worst:.1e} of their size in {STEPS} steps."


def _takes(binary: Binary, h: float) -> bool:
    """Whether a fresh instance takes a first step of a length, s."""
    with Instance(binary) as instance:
        instance.initialize()
        try:
            instance.step(h)
        except RefusedError:
            return False
    return True


def instances(binary: Binary) -> Yield:
    """Try rule 14: two instances that step in turn do not influence each other."""
    moved = moves(binary)
    alone = [trace(binary, moved, seed) for seed in (1, 4)]
    with Instance(binary) as one, Instance(binary) as two:
        pairs = [(one.initialize(), random.Random(1)), (two.initialize(), random.Random(4))]
        together: list[Rows] = [[one.outputs()], [two.outputs()]]
        for _ in range(STEPS):
            for rows, (instance, generator) in zip(together, pairs, strict=True):
                move(instance, generator, moved=moved)
                instance.step()
                rows.append(instance.outputs())
    for rows, expected in zip(together, alone, strict=True):
        if rows != expected and not binary.plan["random"]:
            yield from same(binary, expected, rows, "14", "With a second instance beside it", "alone")
            return


def _serialized(instance: Instance) -> bytes:
    state, size = ct.c_void_p(), ct.c_size_t()
    instance.call("fmi2GetFMUstate", ct.byref(state))
    instance.call("fmi2SerializedFMUstateSize", state, ct.byref(size))
    if not 0 < size.value <= LARGEST_STATE:
        msg = f"fmi2SerializedFMUstateSize says {size.value} bytes."
        raise RefusedError(msg)
    buffer = ct.create_string_buffer(size.value)
    instance.call("fmi2SerializeFMUstate", state, buffer, size.value)
    instance.call("fmi2FreeFMUstate", ct.byref(state))
    return buffer.raw
