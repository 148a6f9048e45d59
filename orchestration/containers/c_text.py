"""Names, numbers and texts of a system as C text; whatever a stranger calls a thing, the C text stays what it is."""

import math
import re
from collections.abc import Iterable
from functools import cache

import jinja2

_KEYWORDS = frozenset(
    "alignas alignof asm auto bool break case char const constexpr continue default do double else enum extern false"
    " float for goto if inline int long nullptr register restrict return short signed sizeof static static_assert"
    " struct switch thread_local true typedef typeof typeof_unqual union unsigned void volatile while"
    " and catch class delete explicit export friend mutable namespace new not operator or private protected public"
    " template this throw try typename using virtual xor".split()
)
"""Words that no identifier may be, in C and in C++."""
_DEVICES = frozenset({"con", "prn", "aux", "nul", *(f"{port}{i}" for port in ("com", "lpt") for i in range(10))})
"""Names that no file has on Windows."""
_MACRO = re.compile(
    r"NULL|EOF|NAN|INFINITY|CONTAINED|PREFIXED|STEP_SIZE|linux|unix|[A-Z0-9_]+_(MIN|MAX|\d+)|(L?DBL|FLT|MODEL)_\w+"
)
"""Names that may be macros where the identifiers stand."""


def identifier(text: str, taken: Iterable[str] = (), default: str = "x") -> str:
    """Return a C identifier that resembles a text and is none of those that are taken.

    Examples
    --------
    >>> from orchestration.containers.c_text import identifier
    >>> identifier("two arms"), identifier("2nd", {"_2nd"}), identifier("double"), identifier("+")
    ('two_arms', 'x_2nd', 'double_1', 'x')

    Names differ by more than the case of letters, since files are called by them:

    >>> identifier("Plant", {"plant"}), identifier("NULL"), identifier("aux")
    ('Plant_1', 'x_NULL', 'aux_1')
    """
    word = re.sub(r"[^A-Za-z0-9]+", "_", text).strip("_") or default
    if word[0].isdigit() or _MACRO.fullmatch(word):
        word = f"{default}_{word}"
    occupied = {name.lower() for name in taken} | _KEYWORDS | _DEVICES
    numbered = (f"{word}_{i}" for i in range(1, len(occupied) + 2))
    return word if word.lower() not in occupied else next(name for name in numbered if name.lower() not in occupied)


def c_string(text: str) -> str:
    r"""Return a C string literal of a text in UTF-8; all but plain characters are octal escapes.

    Examples
    --------
    >>> from orchestration.containers.c_text import c_string
    >>> print(c_string('a "b"\n°'))
    "a \"b\"\012\302\260"
    """
    plain = "".join(map(_c_character, text.encode("utf-8", "surrogateescape")))
    return f'"{plain}"'


def _c_character(byte: int) -> str:
    character = chr(byte)
    if character in '"\\':
        return f"\\{character}"
    if character == "?":  # two of them begin a trigraph
        return "\\?"
    return character if 0x20 <= byte < 0x7F else f"\\{byte:03o}"


def c_comment(text: str) -> str:
    """Return a text for a comment in C: one line of plain characters that does not end the comment."""
    plain = "".join(c if " " <= c <= "~" and c != "\\" else "?" for c in text)
    return plain.replace("*/", "* /").replace("/*", "/ *").replace("??/", "? ?/")


def md(text: str) -> str:
    """Return a text for Markdown: one line of plain characters, without marks that begin something else."""
    return re.sub(r"[^\w .,:;/()+*^=\[\]-]", "?", text).replace("[", "\\[").replace("*", "\\*").replace("|", "?")


def c_number(value: float) -> str:
    """Return a double as C text, to the last bit; infinity becomes the largest number."""
    if math.isinf(value):
        return "DBL_MAX" if value > 0 else "-DBL_MAX"
    return repr(float(value))


@cache
def environment() -> jinja2.Environment:
    """Return the templates of this package, in which an undefined name is an error; each is compiled once."""
    found = jinja2.Environment(
        loader=jinja2.PackageLoader("orchestration.containers"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        # The output is C, not HTML; `c_string` and `c_comment` take care of the texts of strangers.
        autoescape=False,  # noqa: S701  # nosec B701
    )
    found.filters |= {"c_string": c_string, "c_number": c_number, "c_comment": c_comment, "md": md}
    return found
