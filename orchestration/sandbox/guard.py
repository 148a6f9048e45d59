"""Guards this process while code of strangers runs in it: puts back what that code changes, and says so if it exits.

    guard = Guard()
    with guard.over(["plant"], "while plant was loaded"):
        ...  # calls of the stranger's library

What was changed is put back, with one warning. If the library ends the process by ``exit``, the process ends with
`EXIT_CODE` and a sentence on standard error, because an exit code of 0 would look like a run that succeeded. A library
that ends the process by ``_exit``, or crashes, can be survived in another process only.
"""

import atexit
import ctypes
import os
import platform
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import cache
from typing import Any

from adaptimp_fmu.files.temporary_folder import remove_all
from orchestration.errors import printable, warn_caller
from orchestration.sandbox.process_state import ProcessState

EXIT_CODE = 4
"""Exit code of a process that an FMU has ended."""
MOST_NAMES = 4
"""Components that a message names."""


class ProcessChangedWarning(RuntimeWarning):
    """Warning that an FMU has changed something of this process, such as the rounding mode; it was put back.

    Examples
    --------
    To refuse FMUs that do so:

    >>> import warnings
    >>> from orchestration import ProcessChangedWarning, scenario, simulate
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", ProcessChangedWarning)
    ...     result = simulate(scenario("fig2"), stop_time=0.01)
    """


class Guard:
    """Guards the process during one run; each warning is given once.

    Parameters
    ----------
    remedy
        What keeps the process out of the reach of an FMU, as a command.
    """

    def __init__(self, remedy: str = "isolate the component") -> None:
        self._said: set[tuple[str, ...]] = set()
        self._remedy = remedy

    @contextmanager
    def over(self, names: Sequence[str], when: str) -> Iterator[None]:
        """Guard the process as long as the context lasts.

        Parameters
        ----------
        names
            Components whose libraries may be called. Without any, nothing is guarded.
        when
            What happens meanwhile, as the end of a sentence.
        """
        if not names or sys.is_finalizing():  # nobody would see the warning
            yield
            return
        before = ProcessState.now()
        try:
            with self._told(f"{_either(names)} ended the process {when}"):
                yield
        finally:
            self._put_back(before, names, when)

    def over_call(self, name: str, function: str) -> AbstractContextManager[None]:
        """Guard the process against the exit of an FMU in a single call; what it changes is left to a longer context.

        Parameters
        ----------
        name
            Component whose library is called.
        function
            Function of FMI that is called.
        """
        return self._told(f"{name} ended the process in {function}")

    def _told(self, what: str) -> "_Told":
        advice = f"What was not written before is lost; {self._remedy} to keep it."
        return _Told(f"{what}, as if the program were at its end. {advice}")

    def _put_back(self, before: ProcessState, names: Sequence[str], when: str) -> None:
        for what, how in before.restore().items():
            key = (*names, what)
            if key in self._said:
                continue
            self._said.add(key)
            msg = (
                f"{_either(names)} changed {what}{printable(how)} {when}, for everybody in this process; it was put"
                f" back. Results of this run may be affected; {self._remedy} to keep such changes out."
            )
            warn_caller(msg, ProcessChangedWarning)


def _either(names: Sequence[str]) -> str:
    """The component, or one of the components."""
    if len(names) == 1:
        return names[0]
    more = f" or {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return f"One of the components {', '.join(names[:MOST_NAMES])}{more}"


class _Exits:
    """What is said if the process is ended by ``exit`` while code of strangers runs."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._sentences: dict[int, list[str]] = {}
        self._armed, self._registered = 0, False
        self._function = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(self._end)
        self._mark = ctypes.create_string_buffer(8)  # its address tells this function from others

    def begin(self, sentence: str) -> None:
        """Say a sentence if the process ends by ``exit``, until `end` is called in the same thread."""
        thread = threading.get_ident()
        with self._lock:
            self._sentences.setdefault(thread, []).append(sentence)
            self._armed += 1
            if self._armed == 1 and _can_be_told():
                self._arm()

    def end(self) -> None:
        """Say the sentence no more that was given last in this thread."""
        thread = threading.get_ident()
        with self._lock:
            self._sentences[thread].pop()
            if not self._sentences[thread]:
                del self._sentences[thread]
            self._armed -= 1
            if self._armed == 0:
                self._disarm()

    def _arm(self) -> None:
        """Have the function called at an exit."""
        if not self._registered:
            self._registered = True
            atexit.register(self._disarm)  # Python cannot be called once it has ended
        _c_functions()[0](self._function, None, self._mark)

    def _disarm(self) -> None:
        """Take the function back, which calls it once."""
        if _can_be_told():
            armed, self._armed = self._armed, 0
            _c_functions()[1](self._mark)
            self._armed = armed

    def _end(self, _: int | None) -> None:
        """End the process in place of the exit that is under way."""
        if not self._armed:
            return
        own = self._sentences.get(threading.get_ident())
        said = own[-1] if own else next(iter(self._sentences.values()))[-1]
        try:
            if sys.stdout is not None:
                with suppress(OSError, ValueError):  # it may be closed
                    sys.stdout.flush()
            os.write(2, f"Error: {said}\n".encode(errors="replace"))
            with suppress(OSError):
                remove_all()
        finally:
            os._exit(EXIT_CODE)


@cache
def _can_be_told() -> bool:
    """Whether the C library of this system takes such functions back."""
    return sys.platform == "darwin" or platform.libc_ver()[0] == "glibc"


@cache
def _c_functions() -> tuple[Any, Any]:
    """The functions of C that register a function for the exit, and that call it at once, and never again."""
    library = ctypes.CDLL(None)
    return getattr(library, "__cxa_atexit"), getattr(library, "__cxa_finalize")


_exits = _Exits()


class _Told:
    """A context within which an exit is told; it is no generator, because it is entered for every call of an FMU."""

    __slots__ = ("_sentence",)

    def __init__(self, sentence: str) -> None:
        self._sentence = sentence

    def __enter__(self) -> None:
        _exits.begin(self._sentence)

    def __exit__(self, *_: object) -> None:
        _exits.end()
