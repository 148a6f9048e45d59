"""Tests of rules 13 and 14: the state of an instance can be saved and restored, and instances are independent."""

import ctypes as ct
import math
import struct
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from adaptimp_fmu import ContinuousModel, build
from fmus.catalog import MODELS
from tests.conformance.binary import ERROR, OK, PHASES, Binary, Callbacks, Instance, Log
from tests.conformance.container import of_models
from tests.conformance.scenes import H, lengths_of, random_inputs, run, scene

Create = Callable[..., Instance]
Load = Callable[[str], Binary]
ROOT = Path(__file__).parents[2]


def started(binary: Binary, create: Create) -> Instance:
    """An instance in its scene, a few steps after initialization at t0 = 0.125 s."""
    instance = create(binary, start=scene(binary)).initialize(t0=0.125, stop=10.0)
    run(instance, seed=1, steps=7)
    return instance


# 13: reset, states, serialized states


@pytest.mark.parametrize("phase", PHASES)
def test_13_reset_is_a_fresh_instance_bitwise(binary: Binary, create: Create, phase: str) -> None:
    fresh, used = create(binary), create(binary, start=scene(binary)).to(phase)
    if phase == "step complete":
        run(used, seed=2, steps=5)
    assert used.call("fmi2Reset") == OK
    assert used.blob() == fresh.blob()
    rows = []
    for instance in (fresh, used):
        assert instance.set(scene(binary)) == OK
        rows.append(run(instance.initialize(t0=0.25), seed=3))
    np.testing.assert_array_equal(rows[0], rows[1])
    assert used.blob() == fresh.blob()


def test_13_runs_change_something(binary: Binary, create: Create) -> None:
    """Guards the comparisons below: outputs move, and the end differs from the start."""
    rows = run(started(binary, create), seed=4)
    assert np.ptp(rows, axis=0).max() > 1e-3


def test_13_state_replays_bitwise(binary: Binary, create: Create) -> None:
    instance, state = started(binary, create), ct.c_void_p()
    time, before = instance.time, instance.blob()
    assert instance.call("fmi2GetFMUstate", ct.byref(state)) == OK
    first = run(instance, seed=5)
    after = instance.blob()
    for _ in range(2):  # a copy survives Set
        assert instance.call("fmi2SetFMUstate", state) == OK
        instance.time = time
        assert instance.blob() == before
        np.testing.assert_array_equal(run(instance, seed=5), first)
        assert instance.blob() == after
    assert instance.call("fmi2FreeFMUstate", ct.byref(state)) == OK


def test_13_state_holds_what_is_prepared(tmp_path: Path, create: Create) -> None:
    """What depends on states alone is prepared for the next step; in an FMU with events they would renew it."""
    model = ContinuousModel("Prepared", "A pendulum without events", dt_max=H)
    u = model.input("u", 2.0, description="Weight")
    z = model.state("z", 1.0)
    model.derivative(z, -u * ca.sin(z))
    model.output("z", z, description="Angle", scalar=True)
    instance = create(Binary(build(model, tmp_path, cache=tmp_path / "cache"), tmp_path / "unpacked")).initialize()
    assert instance.step(H) == OK
    before = instance.blob()
    assert instance.step(H) == OK
    expected = instance.outputs()
    assert instance.restore(before) == OK
    assert instance.step(H) == OK
    np.testing.assert_array_equal(instance.outputs(), expected)


def test_13_state_restores_parameters(binary: Binary, create: Create) -> None:
    instance = create(binary)
    before, starts = instance.blob(), binary.starts("input", "parameter")
    assert instance.set(scene(binary)) == OK
    assert scene(binary) == {} or instance.blob() != before
    assert instance.restore(before) == OK
    np.testing.assert_array_equal(instance.enter().get(*starts), list(starts.values()))


@pytest.mark.parametrize("phase", PHASES)
def test_13_state_restores_the_phase(binary: Binary, create: Create, phase: str) -> None:
    """Also out of the error state, as FMI 2.0.5 demands (2.1.3, fmi2Error)."""
    saved = create(binary, start=scene(binary)).to(phase).blob()
    for other in PHASES:
        instance = create(binary).to(other)
        assert instance.restore(saved) == OK
        assert instance.blob() == saved
        assert (instance.call("fmi2Terminate") == OK) == (phase == "step complete")


def test_13_a_given_state_is_overwritten(binary: Binary, create: Create) -> None:
    instance, state = started(binary, create), ct.c_void_p()
    assert instance.call("fmi2GetFMUstate", ct.byref(state)) == OK
    address = state.value
    run(instance, seed=6, steps=3)
    later = instance.blob()
    assert instance.call("fmi2GetFMUstate", ct.byref(state)) == OK
    assert state.value == address
    assert instance.call("fmi2Reset") == OK
    assert instance.call("fmi2SetFMUstate", state) == OK
    assert instance.blob() == later
    assert instance.call("fmi2FreeFMUstate", ct.byref(state)) == OK
    assert state.value is None


def test_13_freeing_nothing_is_fine(binary: Binary, create: Create) -> None:
    instance = create(binary)
    assert instance.call("fmi2FreeFMUstate", None) == OK
    assert instance.call("fmi2FreeFMUstate", ct.byref(ct.c_void_p())) == OK


def test_13_missing_states_are_refused(binary: Binary, create: Create) -> None:
    instance, size = create(binary), ct.c_size_t()
    before = instance.blob()
    for status in (
        instance.call("fmi2GetFMUstate", None),
        instance.call("fmi2SetFMUstate", None),
        instance.call("fmi2SerializedFMUstateSize", None, ct.byref(size)),
        instance.call("fmi2SerializeFMUstate", None, ct.create_string_buffer(len(before)), len(before)),
        instance.call("fmi2DeSerializeFMUstate", None, len(before), ct.byref(ct.c_void_p())),
        instance.call("fmi2DeSerializeFMUstate", before, len(before), None),
    ):
        assert status == ERROR
    assert len(instance.log) == 6
    assert instance.blob() == before


def test_13_a_short_buffer_is_refused(binary: Binary, create: Create) -> None:
    instance, state = create(binary), ct.c_void_p()
    size = len(instance.blob())
    assert instance.call("fmi2GetFMUstate", ct.byref(state)) == OK
    buffer = ct.create_string_buffer(b"untouched", size)
    assert instance.call("fmi2SerializeFMUstate", state, buffer, size - 1) == ERROR
    assert str(size) in instance.last
    assert buffer.value == b"untouched"
    assert instance.call("fmi2FreeFMUstate", ct.byref(state)) == OK


def test_13_serialized_state_works_in_another_instance(binary: Binary, create: Create) -> None:
    one, other = started(binary, create), create(binary, name=b"another")
    assert other.restore(one.blob()) == OK
    np.testing.assert_array_equal(run(other, seed=8), run(one, seed=8))
    assert other.blob() == one.blob()


REPLAY = """
import sys
from pathlib import Path
from tests.conformance.binary import OK, Binary, Instance
from tests.conformance.scenes import run
instance = Instance(Binary(Path(sys.argv[1]), Path(sys.argv[2])))
assert instance.restore(Path(sys.argv[3]).read_bytes()) == OK, instance.last
sys.stdout.buffer.write(run(instance, seed=9).tobytes() + instance.blob())
"""


def test_13_serialized_state_works_in_another_process(
    binary: Binary, create: Create, fmu: Path, tmp_path: Path
) -> None:
    instance = started(binary, create)
    (tmp_path / "state").write_bytes(instance.blob())
    command = [sys.executable, "-c", REPLAY, str(fmu), str(tmp_path / "unpacked"), str(tmp_path / "state")]
    replayed = subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout
    assert replayed == run(instance, seed=9).tobytes() + instance.blob()


def assert_blob_refused(instance: Instance, blob: bytes) -> None:
    """A message, no state, and an instance that has not changed."""
    before, state, told = instance.blob(), ct.c_void_p(), len(instance.log)
    assert instance.call("fmi2DeSerializeFMUstate", blob, len(blob), ct.byref(state)) == ERROR
    assert state.value is None
    assert len(instance.log) == told + 1
    assert "fmi2DeSerializeFMUstate" in instance.last
    assert instance.blob() == before


def test_13_truncated_blobs_are_refused(binary: Binary, create: Create) -> None:
    instance = started(binary, create)
    blob = instance.blob()
    for size in (0, 1, 8, len(blob) // 2, len(blob) - 1):
        assert_blob_refused(instance, blob[:size])
        assert str(size) in instance.last
    assert_blob_refused(instance, blob + b"\0")
    assert_blob_refused(instance, 2 * blob)


def test_13_every_corrupted_byte_is_noticed(binary: Binary, create: Create) -> None:
    instance = started(binary, create)
    blob = instance.blob()
    for i in range(len(blob)):
        for flip in (0x01, 0x80):
            corrupted = bytearray(blob)
            corrupted[i] ^= flip
            status = instance.call("fmi2DeSerializeFMUstate", bytes(corrupted), len(blob), ct.byref(ct.c_void_p()))
            assert status == ERROR, f"byte {i} of {len(blob)}"
    assert_blob_refused(instance, bytes(len(blob)))
    assert_blob_refused(instance, blob[::-1])


def forged(blob: bytes, place: int, field: bytes) -> bytes:
    """A state with a field changed, and with the right checksum, FNV-1a of all that follows it."""
    changed = bytearray(blob)
    changed[place : place + len(field)] = field
    checksum = 0xCBF29CE484222325
    for byte in changed[16:]:
        checksum = (checksum ^ byte) * 0x100000001B3 % 2**64
    changed[8:16] = struct.pack("<Q", checksum)
    return bytes(changed)


@of_models
def test_13_made_up_states_are_refused(binary: Binary, create: Create) -> None:
    """Fields at the end of a state: ticks, position between ticks, phase and five flags, from the end."""
    instance = started(binary, create)
    blob = instance.blob()
    assert forged(blob, 0, blob[:8]) == blob
    ends = {
        (-40, struct.pack("<q", -1)): "ticks",
        (-40, struct.pack("<q", 2**62)): "ticks",
        (-32, struct.pack("<d", 1.0)): "position",
        (-32, struct.pack("<d", math.nan)): "position",
        (-24, struct.pack("<i", 0)): "phase",
        (-24, struct.pack("<i", 3)): "phase",
        (-56, struct.pack("<d", math.inf)): "time",
    }
    for (place, field), said in ends.items():
        assert_blob_refused(instance, forged(blob, len(blob) + place, field))
        assert said in instance.last


@of_models
def test_13_made_up_parameters_are_refused(binary: Binary, create: Create) -> None:
    """Among them a divisor of 0: the number of a tick modulo this divisor ended the process with SIGFPE."""
    instance = started(binary, create)
    blob = instance.blob()
    for variable in binary.variables.values():
        if variable.causality != "parameter":
            continue
        wrong = {math.nan, math.inf} | ({0.0} if variable.name == "update_divisor" else set())
        wrong |= {math.nextafter(float(variable.min), -math.inf)} if variable.min is not None else set()
        for value in wrong:
            place = 64 + 8 * variable.valueReference
            assert_blob_refused(instance, forged(blob, place, struct.pack("<d", value)))
            assert "a parameter is out of its range" in instance.last


def resized(blob: bytes, size: int) -> bytes:
    """A foreign blob, cut or filled to the size of one's own."""
    return blob[:size].ljust(size, b"\0")


def test_13_foreign_blobs_are_refused(binary: Binary, create: Create, load: Load) -> None:
    instance = started(binary, create)
    size = len(instance.blob())
    for name in set(MODELS) - {binary.name}:
        foreign = create(load(name)).blob()
        assert_blob_refused(instance, foreign)
        assert_blob_refused(instance, resized(foreign, size))
        assert "another FMU" in instance.last


def test_13_foreign_states_are_refused(binary: Binary, create: Create, load: Load) -> None:
    """A state is only a pointer: of another FMU it points to less, or to other, memory."""
    instance, size = started(binary, create), ct.c_size_t()
    before = instance.blob()
    buffer = ct.create_string_buffer(2**16)
    for name in set(MODELS) - {binary.name}:
        foreign, state = create(load(name)), ct.c_void_p()
        assert foreign.call("fmi2GetFMUstate", ct.byref(state)) == OK
        untouched = foreign.blob()
        for status in (
            instance.call("fmi2SetFMUstate", state),
            instance.call("fmi2GetFMUstate", ct.byref(state)),
            instance.call("fmi2SerializedFMUstateSize", state, ct.byref(size)),
            instance.call("fmi2SerializeFMUstate", state, buffer, len(buffer)),
            instance.call("fmi2FreeFMUstate", ct.byref(state)),
        ):
            assert status == ERROR
        assert instance.blob() == before
        assert foreign.call("fmi2SetFMUstate", state) == OK
        assert foreign.blob() == untouched
        assert foreign.call("fmi2FreeFMUstate", ct.byref(state)) == OK


# 14: split steps, many instances, no leak


def sampled_fmus() -> list[str]:
    """FMUs with a sample time."""
    return [name for name, declare in MODELS.items() if "sample_time" in {v.name for v in declare().variables}]


def rows_of(instance: Instance, steps: Sequence[float], parts: int) -> np.ndarray:
    """Outputs after each step, taken in so many equal parts, with the same inputs."""
    rng, rows = np.random.default_rng(14), []
    for h in steps:
        assert instance.set(random_inputs(instance.binary, rng)) == OK
        for _ in range(parts):
            assert instance.step(h / parts) == OK, instance.last
        rows.append(instance.outputs())
    return np.array(rows)


@pytest.mark.parametrize("identifier", sampled_fmus())
@pytest.mark.parametrize("parts", [2, 3, 8])
@pytest.mark.parametrize("ratio", [0.5, 0.7, 1.0, 2.0, 3.0, 1 / 3, 7.25])
def test_14_split_steps_of_sampled_fmus_are_bitwise_the_same(
    load: Load, create: Create, identifier: str, ratio: float, parts: int
) -> None:
    binary = load(identifier)
    rows = [rows_of(create(binary, start=scene(binary)).initialize(), [ratio * H] * 60, n) for n in (1, parts)]
    np.testing.assert_array_equal(rows[0], rows[1])


@pytest.mark.parametrize("identifier", sorted(name for name in MODELS if name.startswith("Plant")))
@pytest.mark.parametrize(("substeps", "parts"), [(2, 2), (8, 2), (8, 4), (64, 8)])
def test_14_split_steps_of_the_plant_are_bitwise_the_same(
    load: Load, create: Create, identifier: str, substeps: int, parts: int
) -> None:
    """Where both grids coincide. Powers of two, so that h / substeps is the same number in both."""
    binary = load(identifier)
    dt = 2.0**-14
    steps = [substeps * dt] * (512 // substeps)  # 31 ms
    rows = [rows_of(create(binary, start=scene(binary) | {"dt_max": dt}).initialize(), steps, n) for n in (1, parts)]
    contact = rows[0][:, binary.names("output").index("F_ext[1]")]
    assert contact.any()
    assert not contact.all(), "the tip leaves the wall on the way"
    np.testing.assert_array_equal(rows[0], rows[1])


def test_14_interleaved_instances_are_independent(binary: Binary, create: Create) -> None:
    seeds = range(8)
    alone = [run(create(binary, start=scene(binary)).initialize(), seed, steps=20) for seed in seeds]
    instances = [create(binary, start=scene(binary)).initialize() for _ in seeds]
    generators = [np.random.default_rng(seed) for seed in seeds]
    rows: list[list[np.ndarray]] = [[] for _ in seeds]
    for _ in range(20):
        for instance, rng, own in zip(instances, generators, rows, strict=True):
            assert instance.set(random_inputs(binary, rng)) == OK
            assert instance.step(H * rng.choice(lengths_of(binary))) == OK
            own.append(instance.outputs())
    np.testing.assert_array_equal(rows, alone)


def test_14_threads_are_independent(binary: Binary, create: Create) -> None:
    """Python's lock is open during a call through ctypes, so steps of 1e4 ticks overlap."""
    instances = [create(binary, start={}).initialize() for _ in range(4)]
    with ThreadPoolExecutor(4) as pool:
        statuses = list(pool.map(lambda instance: [instance.step(1e4 * H) for _ in range(3)], instances))
    assert statuses == [[OK] * 3] * 4, [instance.last for instance in instances]
    alone = create(binary, start={}).initialize()
    assert [alone.step(1e4 * H) for _ in range(3)] == [OK] * 3
    assert {instance.blob() for instance in instances} == {alone.blob()}


class MallocInfo(ct.Structure):
    """What glibc's mallinfo2 returns."""

    _fields_ = tuple(
        (name, ct.c_size_t)
        for name in "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost".split()
    )


def allocated_bytes() -> int:
    """Bytes that malloc has given out: a leak also shows where the process has free memory of its own."""
    mallinfo = ct.CDLL(None).mallinfo2
    mallinfo.restype = MallocInfo
    return mallinfo().uordblks


@pytest.mark.skipif(
    not sys.platform.startswith("linux") or not hasattr(ct.CDLL(None), "mallinfo2"),
    reason="asks glibc 2.33 or later how much is allocated",
)
def test_14_no_leak_in_2500_lives(binary: Binary) -> None:
    """Instantiate, run, save, fail, restore, free: a lost block has at least 32 bytes, 80 kB in all lives.

    Python may allocate a little itself: 64 kB are allowed, after 500 lives to warm up.
    """
    log, buffer = Log(), ct.create_string_buffer(2**16)
    callbacks = ct.byref(Callbacks(logger=log.callback))

    def live() -> None:
        component = binary.create(callbacks=callbacks, logging=0)
        state, size, copy = ct.c_void_p(), ct.c_size_t(), ct.c_void_p()
        binary["fmi2SetupExperiment"](component, 0, 0.0, 0.0, 0, 0.0)
        binary["fmi2EnterInitializationMode"](component)
        binary["fmi2ExitInitializationMode"](component)
        assert binary["fmi2DoStep"](component, 0.0, H, 1) == OK
        binary["fmi2GetFMUstate"](component, ct.byref(state))
        binary["fmi2SerializedFMUstateSize"](component, state, ct.byref(size))
        binary["fmi2SerializeFMUstate"](component, state, buffer, size.value)
        assert binary["fmi2DeSerializeFMUstate"](component, buffer, size.value, ct.byref(copy)) == OK
        wrong = b"wrong" + buffer.raw[5 : size.value]
        assert binary["fmi2DeSerializeFMUstate"](component, wrong, size.value, ct.byref(ct.c_void_p())) == ERROR
        assert binary["fmi2DoStep"](component, H, -H, 1) == ERROR
        binary["fmi2SetFMUstate"](component, copy)
        binary["fmi2FreeFMUstate"](component, ct.byref(state))
        binary["fmi2FreeFMUstate"](component, ct.byref(copy))
        binary["fmi2Reset"](component)
        binary["fmi2FreeInstance"](component)
        binary.create(callbacks=callbacks, logging=0, guid=b"wrong")

    for _ in range(500):
        live()
    before = allocated_bytes()
    for _ in range(2500):
        live()
    assert allocated_bytes() - before <= 2**16
