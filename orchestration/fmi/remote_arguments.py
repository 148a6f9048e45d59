"""Arguments of FMI functions on their way between two processes, for calls whose speed does not matter.

`FORMS` tells what stands behind the pointers of each function: how many elements of how many bytes, and who writes
them. A message holds the numbers, and the bytes behind each pointer as text.
"""

import ctypes as ct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from orchestration.fmi import signatures

MOST_TEXT = 2**20  # bytes of a text that an FMU returns


@dataclass(frozen=True)
class Array:
    """What a pointer points to; arguments are counted from 0, without the instance.

    Attributes
    ----------
    size
        Bytes of an element.
    count
        Argument that holds the number of elements; -1 for a single one.
    read, written
        Whether the function reads and writes the elements.
    """

    size: int
    count: int = -1
    read: bool = True
    written: bool = False


@dataclass(frozen=True)
class Texts:
    """An array of texts; `written` by the function or else read."""

    count: int = -1
    written: bool = False


_REFERENCES, _WORD = Array(4, 1), 8
_FORMS: dict[str, dict[int, Array | Texts]] = {
    "fmi2SetDebugLogging": {2: Texts(1)},
    "fmi2GetString": {0: _REFERENCES, 2: Texts(1, written=True)},
    "fmi2SetString": {0: _REFERENCES, 2: Texts(1)},
    "fmi2FreeFMUstate": {0: Array(_WORD, written=True)},
    "fmi2SerializedFMUstateSize": {1: Array(_WORD, read=False, written=True)},
    "fmi2SerializeFMUstate": {1: Array(1, 2, read=False, written=True)},
    "fmi2DeSerializeFMUstate": {0: Array(1, 1), 2: Array(_WORD, written=True)},
    "fmi2GetRealOutputDerivatives": {0: _REFERENCES, 2: Array(4, 1), 3: Array(8, 1, read=False, written=True)},
    "fmi2GetStatus": {1: Array(4, written=True)},
    "fmi2GetRealStatus": {1: Array(8, written=True)},
    "fmi2GetIntegerStatus": {1: Array(4, written=True)},
    "fmi2GetBooleanStatus": {1: Array(4, written=True)},
    "fmi2GetStringStatus": {1: Texts(written=True)},
}
_NUMBERS = {ct.c_double: ct.c_double, ct.c_int: ct.c_int, ct.c_size_t: ct.c_size_t}


def forms(function: str) -> dict[int, Array | Texts]:
    """What stands behind the pointers of a function, by argument."""
    return _FORMS.get(function, {})


def types(function: str) -> list[Any]:
    """C types of the arguments after the instance; every pointer is a plain address."""
    return [_NUMBERS.get(kind, ct.c_void_p) for kind in signatures.ARGUMENTS[function]]


def number(form: Array | Texts, arguments: Sequence[Any]) -> int:
    """How many elements an array has."""
    return 1 if form.count < 0 else int(arguments[form.count])


def outward(function: str, arguments: Sequence[Any]) -> list[Any]:
    """Arguments of a call as a message holds them: numbers, and what the function reads behind pointers."""
    sent = [0 if value is None else value for value in arguments]
    for place, form in forms(function).items():
        address, n = arguments[place], number(form, arguments)
        if isinstance(form, Texts):
            texts = (ct.c_char_p * n).from_address(address) if address and not form.written else []
            sent[place] = [(text or b"").decode("latin-1") for text in texts]
        else:
            sent[place] = as_text(ct.string_at(address, form.size * n)) if address and form.read else ""
    return sent


def as_text(content: bytes) -> str:
    """Bytes as a text with a character for each."""
    return content.decode("latin-1")


def as_bytes(text: str) -> bytes:
    """The bytes that `as_text` made a text of."""
    return text.encode("latin-1")


def deliver(function: str, arguments: Sequence[Any], answers: dict[str, Any], kept: list[Any], *, status: int) -> int:
    """Write what the function has written behind the pointers of the caller; returns the status.

    Parameters
    ----------
    answers
        By place of the argument. Nothing is written beyond what the caller has room for.
    kept
        Receives the texts that pointers of the caller point to.
    """
    for place, form in forms(function).items():
        answer, address = answers.get(str(place)), arguments[place]
        if answer is None or not address or not form.written:
            continue
        n = number(form, arguments)
        if isinstance(form, Texts):
            array = (ct.c_char_p * n).from_address(address)
            texts = [ct.create_string_buffer(as_bytes(text)[:MOST_TEXT]) for text in answer[:n]]
            kept[:] = texts
            for k, text in enumerate(texts):
                array[k] = ct.cast(text, ct.c_char_p)
        else:
            content = as_bytes(answer)[: form.size * n]
            ct.memmove(address, content, len(content))
    return status


class Inward:
    """Arguments of a call in the process that makes it.

    Parameters
    ----------
    sent
        What `outward` made.
    """

    def __init__(self, function: str, sent: Sequence[Any]) -> None:
        self.function, self.values, self._sent = function, list(sent), sent
        for place, form in forms(function).items():
            n = number(form, sent)
            if isinstance(form, Texts):
                texts = [as_bytes(text) for text in sent[place]]
                self.values[place] = (ct.c_char_p * max(1, n))(*texts)
            else:
                self.values[place] = ct.create_string_buffer(max(1, form.size * n))
                content = as_bytes(sent[place])
                ct.memmove(self.values[place], content, min(len(content), form.size * n))

    def answers(self) -> dict[str, Any]:
        """What the function has written, by place of the argument."""
        found: dict[str, Any] = {}
        for place, form in forms(self.function).items():
            if not form.written:
                continue
            n = number(form, self._sent)
            if isinstance(form, Texts):
                found[str(place)] = [as_text((text or b"")[:MOST_TEXT]) for text in self.values[place][:n]]
            else:
                found[str(place)] = as_text(ct.string_at(self.values[place], form.size * n))
        return found
