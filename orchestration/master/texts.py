"""Texts that components exchange, and that a run records.

The compiled loops know numbers only. So each text has a number, an Integer of 32 bits, and equal texts have the same
number. A number is connected, taken back with a step, compared in an iteration and recorded as an Integer is.

Where a component has Strings, a loop calls a function of this module instead of fmi2GetInteger or fmi2SetInteger:

    get   Integers from the FMU; texts from the FMU -> their numbers
    set   Integers to the FMU; numbers -> their texts to the FMU

A run without Strings runs the same code as if this module did not exist.
"""

import ctypes
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np

from orchestration.fmi.codes import accepted
from orchestration.fmi.deferred import deferring
from orchestration.fmi.instance import Instance

FIRST_LIMIT = 2**14
"""Number of texts from which on those that nobody uses any more are forgotten."""
NUMBERS, LENGTHS, BYTES = "text_numbers", "text_lengths", "text_bytes"
"""Names of the arrays that keep the texts in a snapshot."""
_SIZE = 4  # bytes of a value reference and of an Integer
_Transfer = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p)


class TextTable:
    """Texts by their numbers; number 0 is the empty text.

    A text is kept as the bytes that the FMU gave, so that it arrives at another FMU unchanged.
    """

    def __init__(self) -> None:
        self._texts: dict[int, bytes] = {0: b""}
        self._numbers: dict[bytes, int] = {b"": 0}
        self._next = 0  # no number below it is free
        self._limit = FIRST_LIMIT

    def __len__(self) -> int:
        """Number of texts that are kept."""
        return len(self._numbers)

    def number(self, text: bytes) -> int:
        """Return the number of a text."""
        found = self._numbers.get(text)
        if found is None:
            while self._next in self._texts:
                self._next += 1
            found = self._next
            self._texts[found], self._numbers[text] = text, found
        return found

    def text(self, number: int) -> bytes:
        """Return the text of a number."""
        return self._texts[number]

    def decoded(self, numbers: np.ndarray) -> np.ndarray:
        """Return the texts of numbers as an array of objects of type str; a byte that is not UTF-8 becomes U+FFFD."""
        known, places = np.unique(numbers.astype(np.int64), return_inverse=True)
        texts = np.array([self._texts[number].decode(errors="replace") for number in known], object)
        return texts[places] if len(known) else np.empty(0, object)

    def forget(self, used: Callable[[], Iterable[np.ndarray]]) -> None:
        """Forget texts whose numbers are not used, if the texts are many; their numbers are given anew.

        Parameters
        ----------
        used
            Returns arrays of all numbers in use.
        """
        if len(self) <= self._limit:
            return
        alive = {0, *(int(number) for array in used() for number in np.unique(array))}
        for text, number in list(self._numbers.items()):
            if number not in alive:
                del self._numbers[text], self._texts[number]
        self._next = 0
        self._limit = max(FIRST_LIMIT, 2 * len(self))

    def save(self) -> dict[str, np.ndarray]:
        """Return all texts as arrays: their numbers, their lengths in bytes, and their bytes one after the other."""
        lengths = [len(text) for text in self._numbers]
        joined = np.frombuffer(b"".join(self._numbers), np.uint8)
        return {
            NUMBERS: np.array(list(self._numbers.values()), np.int64),
            LENGTHS: np.array(lengths, np.int64),
            BYTES: joined.copy(),
        }

    def restore(self, arrays: dict[str, np.ndarray]) -> None:
        """Restore the texts that `save` returned; `orchestration.master.snapshot_fit` looks at them before."""
        numbers, joined = arrays[NUMBERS].tolist(), arrays[BYTES].tobytes()
        ends = np.cumsum(arrays[LENGTHS]).tolist()
        texts = [joined[begin:end] for begin, end in zip([0, *ends], ends, strict=False)]
        self._texts = dict(zip(numbers, texts, strict=True))
        self._numbers = dict(zip(texts, numbers, strict=True))
        self._next = 0


@dataclass(frozen=True)
class Texts:
    """The texts of a run.

    Attributes
    ----------
    columns
        Recorded Strings as ``component.variable``.
    first
        Column of the first of them in a row of numbers, where they are the last columns.
    places
        Places of Strings in the buffer of discretes.
    alive
        Functions that the loops call by their addresses.
    """

    columns: tuple[str, ...]
    first: int
    places: np.ndarray
    table: TextTable = field(default_factory=TextTable)
    alive: list[Any] = field(default_factory=list, repr=False)

    def __bool__(self) -> bool:
        """Whether any String is exchanged or recorded."""
        return len(self.places) > 0

    def split(self, rows: np.ndarray) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Split rows into numbers, a view, and recorded texts by name, shape (n_rows,) each."""
        if not self.columns:
            return rows, {}
        numbers = zip(self.columns, rows[:, self.first :].T, strict=True)
        return rows[:, : self.first], {name: self.table.decoded(column) for name, column in numbers}

    def forget(self, discretes: Iterable[np.ndarray], rows: Callable[[], Iterable[np.ndarray]]) -> None:
        """Forget texts that stand neither in buffers of discretes nor in rows."""
        if not self:
            return
        self.table.forget(lambda: [*(d[self.places] for d in discretes), *(r[:, self.first :] for r in rows())])


class TextCall:
    """A function that gets or sets Integers, and after them Strings, of an instance; a loop calls its address.

    Parameters
    ----------
    verb
        Get or Set.
    n_integers
        Number of the Integers, which are the first of the references.
    references
        Value references, uint32. A call may be for neighbours among them; its address tells which.
    """

    def __init__(
        self, instance: Instance, verb: str, n_integers: int, references: np.ndarray, table: TextTable
    ) -> None:
        self._instance, self._verb, self._n_integers = instance, verb, n_integers
        self._references, self._table = references, table
        self._function = _Transfer(lambda *given: deferring(lambda: self._transfer(*given)))

    @property
    def address(self) -> int:
        """Address of the function, with the C type of fmi2GetInteger."""
        return int(ctypes.cast(cast("Any", self._function), ctypes.c_void_p).value or 0)

    def _transfer(self, _: int | None, references: int, n: int, values: int) -> int:
        """Make both calls; returns the worse fmi2Status."""
        skipped = (references - self._references.ctypes.data) // _SIZE
        n_integers = min(n, max(0, self._n_integers - skipped))
        worst = self._call("Integer", references, n_integers, values) if n_integers else 0
        if n_integers == n or not accepted(worst):
            return worst
        places = (ctypes.c_int * (n - n_integers)).from_address(values + _SIZE * n_integers)
        texts = (ctypes.c_char_p * len(places))()
        if self._verb == "Set":
            texts[:] = [self._table.text(number) for number in places]
        status = self._call("String", references + _SIZE * n_integers, len(places), ctypes.addressof(texts))
        if self._verb == "Get" and accepted(status):
            places[:] = [self._table.number(text or b"") for text in texts]
        return max(worst, status)

    def _call(self, kind: str, references: int, n: int, values: int) -> int:
        function = f"fmi2{self._verb}{kind}"
        status = _Transfer(self._instance.library.address(function))(self._instance.handle, references, n, values)
        if not accepted(status):
            self._instance.failed_in = function
        return status
