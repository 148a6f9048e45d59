"""Hints for models in which Python is used where CasADi is needed, such as ``if a > 0`` of a symbol.

A symbol has no value while a model is declared. CasADi's messages say which of its own rules is broken; a hint says
what to write instead.
"""

import re
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

_PLACE = re.compile(r"\.\.\./casadi/\S+:\d+: (Assertion \".*?\" failed:)?\s*")
_HINTS = (
    (
        r"truth value",
        "Python cannot decide on a symbol; use ca.if_else for if, ca.logic_and for and, ca.fmax for max",
    ),
    (r"Notify the CasADi developers", "functions of math take no symbols; use those of CasADi, such as ca.sin"),
    (r"to_int not defined", "a symbol has no value yet; use ca.floor, or a plain number"),
    (r"'SX' object cannot be interpreted as an integer", "a symbol has no value yet; use a plain number here"),
    (r"[Dd]imension mismatch|incompatible dimensions", "make the shapes equal; a symbol of n elements is n x 1"),
    (r"out of bounds with supplied length", "elements of a symbol count from 0"),
    (r"No module named", "install that package, or correct its name"),
)
_NUMPY_ON_SYMBOL = r"\s*casadi: a numpy function was called"
NUMPY_HINT = "a function of NumPy was called on a symbol; use that of CasADi, such as ca.sin for np.sin"


def hinted(said: str) -> str:
    """An error's message without places in CasADi's sources, and with a hint if there is one, in one line."""
    text = " ".join(_PLACE.sub("", said).split()).rstrip(".")
    hint = next((hint for pattern, hint in _HINTS if re.search(pattern, said)), "")
    unhelpful = text.startswith("Notify")
    return hint if hint and unhelpful else f"{text}; {hint}." if hint else text


@contextmanager
def numpy_on_symbols(file: str) -> Iterator[list[int]]:
    """Collect the lines of a file that call functions of NumPy on symbols, instead of CasADi's warning.

    Yields
    ------
    list of int
        Numbers of the lines, each once.
    """
    lines: dict[int, None] = {}
    found: list[int] = []
    with warnings.catch_warnings():
        before = warnings.showwarning

        def note(message: Warning | str, category: type[Warning], *others: object, **more: object) -> None:
            if not re.match(_NUMPY_ON_SYMBOL, str(message)):
                before(message, category, *others, **more)  # type: ignore[arg-type]
                return
            frame = sys._getframe(1)
            while frame is not None and frame.f_code.co_filename != file:
                frame = frame.f_back
            if frame is not None and frame.f_lineno not in lines:
                lines[frame.f_lineno] = None
                found.append(frame.f_lineno)

        warnings.filterwarnings("always", _NUMPY_ON_SYMBOL)
        warnings.showwarning = note
        yield found
