"""Every function of FMI reaches the process of an isolated FMU, and what the function writes comes back."""

import ctypes as ct
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from orchestration.fmi import remote_calls, signatures
from orchestration.fmi.codes import Status
from orchestration.fmi.description import read_description
from orchestration.fmi.instance import Instance, c_references
from orchestration.fmi.isolation import Isolation
from orchestration.fmi.remote_library import RemoteLibrary, start_process
from orchestration.sandbox.archive import unpacked
from orchestration.sandbox.remote import RemoteProcess

Opened = Callable[..., Instance]


@pytest.fixture
def opened(unruly_file: Callable[[str], Path]) -> Iterator[Opened]:
    """Open an FMU of a kind, isolated or not."""
    with ExitStack() as stack:

        def open_one(kind: str, *, isolated: bool = True) -> Instance:
            description = read_description(unruly_file(kind))
            folder = stack.enter_context(unpacked(description.path))
            process = start_process(Isolation(), len(description.variables)) if isolated else None
            instance = Instance.open("m", description, folder, process=process)
            stack.callback(instance.close)
            return instance

        yield open_one


def test_texts(opened: Opened) -> None:
    instance = opened("text")
    texts = [b"", "Grüße, Welt".encode()]
    assert instance.set("String", [2, 3], texts) == Status.OK
    assert instance.get("String", [2, 3, 1]) == (Status.OK, [*texts, b"abc!"])
    assert instance.set("String", [0], [b"abcdef"]) == Status.OK
    assert instance.get("Real", [1]) == (Status.OK, [6.0])


def test_numbers_of_all_types(opened: Opened) -> None:
    instance = opened("none")
    for kind, values in (("Real", [0.1, -2.5]), ("Integer", [-7, 2**31 - 1]), ("Boolean", [1, 0])):
        assert instance.set(kind, [2, 3], values) == Status.OK
        assert instance.get(kind, [3, 2]) == (Status.OK, values[::-1])
        assert instance.get(kind, []) == (Status.OK, [])


def test_states(opened: Opened) -> None:
    instance = opened("none")
    instance.set("Real", [2], [5.0])
    saved = instance.save()
    handle = ct.c_void_p()
    instance.call("fmi2GetFMUstate", ct.byref(handle))
    instance.set("Real", [2], [6.0])
    instance.restore(saved)
    assert instance.get("Real", [2]) == (Status.OK, [5.0])
    instance.set("Real", [2], [7.0])
    instance.call("fmi2SetFMUstate", handle)
    assert instance.get("Real", [2]) == (Status.OK, [5.0])
    instance.call("fmi2FreeFMUstate", ct.byref(handle))
    assert handle.value is None


def test_a_serialized_state_is_that_of_the_fmu_itself(opened: Opened) -> None:
    """Both end in the callbacks, an address: only what comes before is compared."""
    saved = [opened("none", isolated=isolated).save() for isolated in (True, False)]
    assert len(saved[0]) == len(saved[1]) > 100
    assert saved[0][:-8] == saved[1][:-8]


def test_questions_after_a_discarded_step(opened: Opened) -> None:
    instance = opened("none")
    reached, ends = ct.c_double(), ct.c_int(7)
    assert instance.ask("fmi2GetRealStatus", 2, ct.byref(reached)) == Status.OK
    assert instance.ask("fmi2GetBooleanStatus", 3, ct.byref(ends)) == Status.OK
    assert (reached.value, ends.value) == (0.0, 0)
    text = ct.c_char_p(b"unchanged")
    assert instance.status("fmi2GetStringStatus", 1, ct.byref(text)) == Status.DISCARD


def test_the_other_functions(opened: Opened) -> None:
    instance = opened("none")
    assert instance.library.function("fmi2GetVersion")() == b"2.0"
    assert instance.library.function("fmi2GetTypesPlatform")() == b"default"
    categories = (ct.c_char_p * 2)(b"one", b"two")
    assert instance.status("fmi2SetDebugLogging", 1, 2, categories) == Status.OK
    assert instance.status("fmi2Reset") == Status.OK
    assert instance.status("fmi2CancelStep") == Status.ERROR
    values, orders = (ct.c_double * 1)(), (ct.c_int * 1)(1)
    assert instance.status("fmi2GetRealOutputDerivatives", c_references([1]), 1, orders, values) == Status.ERROR
    assert instance.library.lacks() == []
    assert all(instance.library.address(name) for name in signatures.ARGUMENTS)


def test_more_than_fits_is_an_error(opened: Opened) -> None:
    assert opened("none").set("Real", [2] * 10_000, [0.0] * 10_000) == Status.ERROR


def test_after_the_end_every_call_is_fatal_at_once(opened: Opened) -> None:
    instance = opened("set crash")
    assert instance.set("Real", [2], [1.0]) == Status.FATAL
    assert instance.failure("fmi2SetReal", Status.FATAL) == "m: fmi2SetReal died of SIGSEGV; it logged nothing."
    assert instance.set("Real", [2], [1.0]) == Status.FATAL
    assert instance.status("fmi2Reset") == Status.FATAL
    assert instance.get("String", [2])[0] == Status.FATAL


def process_of(instance: Instance) -> RemoteProcess:
    """The process that an instance lives in."""
    assert isinstance(instance.library, RemoteLibrary)
    return instance.library._process


def test_no_message_of_a_call_is_late(opened: Opened, monkeypatch: pytest.MonkeyPatch) -> None:
    """The call has ended before anybody reads: what the FMU logged is still in the socket."""
    instance = opened("step refuse")

    def wait_for_the_end_only(_: Any, ready: Callable[[], bool], *, limit: float | None = None) -> None:  # noqa: ARG001
        while not ready():
            time.sleep(0.001)

    monkeypatch.setattr(RemoteProcess, "wait", wait_for_the_end_only)
    status = instance.status("fmi2DoStep", 0.45, 0.1, 1)
    said = instance.failure("fmi2DoStep", status)
    monkeypatch.undo()
    assert said == 'm: fmi2DoStep returned fmi2Error; its last message: "this cannot be done at t = 0.45 s".'


@pytest.mark.parametrize("damage", [b"", b"serve\n", b"serve\nno text for LLVM"])
def test_a_damaged_server_is_made_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, damage: bytes) -> None:
    monkeypatch.setattr(remote_calls, "_folder", lambda: tmp_path)
    whole = remote_calls.server()
    assert remote_calls.server() == whole
    (kept,) = tmp_path.iterdir()
    kept.write_bytes(damage)
    name, text = remote_calls.server()
    assert f"define i32 @{name}" in text
    assert remote_calls.server() == (name, text)


def test_the_start_is_not_limited_by_the_time_of_a_call(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first message is longer than what a socket holds, so it waits until the process has begun."""
    name, text = remote_calls.server()
    monkeypatch.setattr(remote_calls, "server", lambda: (name, text + ";" * 2**20))
    process = start_process(Isolation(time_limit=0.001), 1)
    try:
        assert process.ending == ""
    finally:
        process.close()


@pytest.mark.parametrize("answer", ["no object", {}, {"status": 0}, {"status": float("inf"), "written": {}}])
def test_an_answer_that_makes_no_sense_ends_the_process(
    opened: Opened, monkeypatch: pytest.MonkeyPatch, answer: object
) -> None:
    instance = opened("none")
    monkeypatch.setattr(RemoteProcess, "request", lambda *_, **__: answer)
    assert instance.status("fmi2Reset") == Status.FATAL
    assert instance.failure("fmi2Reset", Status.FATAL).startswith("m: fmi2Reset sent what is no answer")


def test_the_process_ends_also_if_its_library_cannot_be_unloaded(
    opened: Opened, monkeypatch: pytest.MonkeyPatch
) -> None:
    instance = opened("none")
    process = process_of(instance)

    def interrupted(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(RemoteProcess, "request", interrupted)
    with pytest.raises(KeyboardInterrupt):
        instance.library.close()
    assert process.ending == "was ended"
