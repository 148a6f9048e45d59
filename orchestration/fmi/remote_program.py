"""The program of the process that holds an isolated FMU: ``python -m orchestration.fmi.remote_program ENDS``.

Calls that are frequent in a run come through the shared memory and are made by compiled code; see
`orchestration.fmi.remote_calls`. All others come as messages and are made here. The process ends when the master does.
"""

import _ctypes
import ctypes as ct
import json
import mmap
import os
import re
import select
import signal
import socket
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import Any

from llvmlite import binding as llvm

from orchestration.fmi import signatures
from orchestration.fmi.logging import Messages, callbacks, listen
from orchestration.fmi.remote_arguments import Inward, as_text, types
from orchestration.fmi.remote_layout import CALLS, GONE, IDLE, LOAD, UNLOAD, Server, Word
from orchestration.sandbox.confinement import Limits, limit
from orchestration.sandbox.remote import REPLY, SAID, packed, received

MOST_WRITTEN = 4 * 1024**3  # bytes of a file, so that an FMU that writes for ever fills no disk
_DECLARED = re.compile(r"^declare [^@\n]*@([\w.$]+)", re.MULTILINE)


class _Voice(Messages):
    """Sends each text that the FMU logs to the master."""

    def __init__(self, served: "_Served") -> None:
        super().__init__()
        self._served = served

    def append(self, text: str) -> None:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Send a text, after a digit for its fmi2Status."""
        status = min(getattr(text, "status", 0), 9)
        self._served.send(SAID, f"{status}{''.join(text)}".encode())
        self._served.words[Word.SAID] += 1


class _Served:
    """The FMU of this process, and the connection to the master, whose descriptors are given."""

    def __init__(self, ends: dict[str, int]) -> None:
        self._talk, self._sending = socket.socket(fileno=ends["talk"]), threading.Lock()
        memory = mmap.mmap(ends["memory"], ends["size"])
        os.close(ends["memory"])
        for descriptor in (ends["talk"], ends["bell"]):
            os.set_inheritable(descriptor, False)
        threading.Thread(target=_end_with_master, args=(ends["talk"],), daemon=True).start()
        self.words = (ct.c_int64 * Word.ARRAYS).from_buffer(memory)
        plan = received(self._talk) or os._exit(0)
        self._byte = ct.create_string_buffer(1)
        self._record = (ct.c_int64 * (Server.FUNCTIONS + len(CALLS)))()
        c = ct.CDLL(None)
        self._record[Server.SHARED] = ct.addressof(self.words)
        self._record[Server.BYTE], self._record[Server.BELL] = ct.addressof(self._byte), ends["bell"]
        for word, name in ((Server.YIELD, "sched_yield"), (Server.WRITE, "write"), (Server.READ, "read")):
            self._record[word] = ct.cast(getattr(c, name), ct.c_void_p).value or 0
        self._record[Server.SPINS], self._record[Server.YIELDS] = plan["spins"], plan["yields"]
        self._engine, self._serve = _compiled(*plan["server"])
        self._library: Any = None
        self._kept: list[Any] = []
        self._voice = _Voice(self)
        memory_limit, files = plan["limits"]
        limit(Limits(None if memory_limit is None else _addresses() + memory_limit, MOST_WRITTEN, files))

    def run(self) -> None:
        """Serve the master until it closes the connection."""
        while True:
            call = self._serve(ct.addressof(self._record))
            if call == GONE:
                return
            request = received(self._talk)
            if request is None:
                return
            answer = self._answer(request)
            self.words[Word.CALL] = IDLE
            self.send(REPLY, json.dumps(answer).encode())

    def send(self, kind: int, content: bytes) -> None:
        """Send a message, from any thread."""
        with self._sending, suppress(OSError):  # without a master the process ends by itself
            self._talk.sendall(packed(kind, content))

    def _answer(self, request: dict[str, Any]) -> Any:
        function, sent = request["function"], request["arguments"]
        if function == LOAD:
            return self._load(*sent)
        if function == UNLOAD:
            return _ctypes.dlclose(self._library._handle)
        if function == "fmi2Instantiate":
            return self._instantiate(*sent)
        if function in signatures.OTHERS and function != "fmi2FreeInstance":
            return as_text(self._function(function, ct.c_char_p)() or b"")
        component = self._record[Server.COMPONENT]
        if function == "fmi2FreeInstance":
            self._record[Server.COMPONENT] = 0
            return self._function(function, None, ct.c_void_p)(component)
        listen()
        inward = Inward(function, sent)
        status = self._function(function, ct.c_int, ct.c_void_p, *types(function))(component, *inward.values)
        return {"status": status, "written": inward.answers()}

    def _load(self, path: str) -> dict[str, Any]:
        try:
            self._library = ct.CDLL(path)
        except OSError as error:
            return {"error": str(error)}
        for place, name in enumerate(CALLS):
            if hasattr(self._library, name):
                address = ct.cast(getattr(self._library, name), ct.c_void_p).value or 0
                self._record[Server.FUNCTIONS + place] = address
        return {"exported": [name for name in signatures.FUNCTIONS if hasattr(self._library, name)]}

    def _instantiate(self, name: str, kind: int, guid: str, resources: str, visible: int, logging: int) -> bool:
        given = callbacks(self._voice)
        self._kept.append(given)
        instantiate = self._function("fmi2Instantiate", *_prototype("fmi2Instantiate"))
        texts = [text.encode() for text in (name, guid, resources)]
        component = instantiate(texts[0], kind, *texts[1:], ct.byref(given), visible, logging)
        self._record[Server.COMPONENT] = component or 0
        return bool(component)

    def _function(self, name: str, result: Any, *arguments: Any) -> Any:
        function = getattr(self._library, name)
        function.restype, function.argtypes = result, arguments
        return function


def _prototype(function: str) -> tuple[Any, ...]:
    result, arguments = signatures.prototype(function)
    return result, *arguments


def _compiled(name: str, text: str) -> tuple[Any, Any]:
    """The function that serves calls, and what keeps its machine code.

    What numba declares in the text for errors, of which the function raises none, is never called.
    """
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    never = ct.cast(ct.CDLL(None).abort, ct.c_void_p).value
    for declared in _DECLARED.findall(text):
        if not declared.startswith("llvm."):
            llvm.add_symbol(declared, never)
    module = llvm.parse_assembly(text)
    engine = llvm.create_mcjit_compiler(module, llvm.Target.from_default_triple().create_target_machine(opt=2))
    engine.finalize_object()
    return engine, ct.CFUNCTYPE(ct.c_int, ct.c_int64)(engine.get_function_address(name))


def _addresses() -> int:
    """Bytes of addresses that this process has taken; 0 where the system does not tell."""
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except OSError:
        return 0
    return pages * mmap.PAGESIZE


def _end_with_master(descriptor: int) -> None:
    """End the process, whatever its FMU does, when the master closes the connection or dies."""
    poll = select.poll()
    poll.register(descriptor, 0)
    poll.poll()
    os.kill(os.getpid(), signal.SIGKILL)


def main() -> None:
    """Serve the master at the other ends of the given descriptors."""
    _Served(json.loads(sys.argv[1])).run()
    os._exit(0)


if __name__ == "__main__":
    main()
