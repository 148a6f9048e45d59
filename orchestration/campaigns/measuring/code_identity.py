"""The identity of a function: a hash of everything of its code that can change what it returns.

It covers the bytecode with its constants and names, default values, values from enclosing functions, and global
values that the code reads. It covers the functions, classes and objects among them in the same way, and the modules
that the code imports (`orchestration.campaigns.measuring.module_content`). Comments and line numbers of a function
do not count. What cannot be followed is refused.
"""

import hashlib
from collections.abc import Callable, Iterable
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from orchestration.campaigns.measuring.code_reads import Reads
from orchestration.campaigns.measuring.module_content import is_own, module_content
from orchestration.campaigns.measuring.object_content import class_members, is_named, object_members, unwrapped
from orchestration.errors import StudyError

_PLAIN = (type(None), type(...), type(NotImplemented), bool, int, float, complex, str, bytes)
_CODE_AS_TEXT = ("eval", "exec", "__import__", "import_module")


def function_identity(function: Callable[..., Any]) -> str:
    """SHA-256 hash, as hexadecimal text, of what a function does.

    Raises
    ------
    StudyError
        If the function reads a value whose content cannot be told, such as an open file, or runs code from a text.
    """
    content = _Content({}, set())
    try:
        content.add(function, f"the function {getattr(function, '__qualname__', type(function).__name__)}")
    except RecursionError as error:
        msg = "A measure reads values that are nested too deeply to be told apart; give a formula, or flat values."
        raise StudyError(msg) from error
    return content.digest.hexdigest()


class _Content:
    """A hash of values that are added one after the other.

    Parameters
    ----------
    seen
        Number and value of each function, class and object that was added before, by its ``id``. A value that comes
        again counts by its number. The values are kept, so that no ``id`` is used twice.
    modules
        Names of modules that were added before.
    """

    def __init__(self, seen: dict[int, tuple[int, Any]], modules: set[str]) -> None:
        self.digest = hashlib.sha256()
        self.seen = seen
        self.modules = modules

    def add(self, value: Any, name: str) -> None:
        """Add a value, which messages call by a name."""
        if type(value) in _PLAIN:
            self._text(f"{type(value).__name__} {value!r}")
        elif isinstance(value, CodeType):
            self._code(value, name)
        elif isinstance(value, ModuleType):
            self.module(value.__name__, value)
        elif type(value) in (tuple, frozenset, set):
            self._collection(value, name)
        elif type(value) is np.ndarray and value.dtype.hasobject is False:
            self._text(f"array {value.dtype.descr} {value.shape}")
            self._bytes(value.tobytes())
        elif id(value) in self.seen:
            self._text(f"seen {self.seen[id(value)][0]}")
        else:
            self.seen[id(value)] = len(self.seen), value
            self._once(value, name)

    def module(self, name: str, loaded: ModuleType | None = None) -> None:
        """Add a module by its name; one that is loaded may be another than that which an import would give."""
        self._text(f"module {name}")
        for text in module_content(name, self.modules, loaded):
            self._text(text)

    def _once(self, value: Any, name: str) -> None:
        """Add a value that can be a part of itself."""
        if is_named(value) and value.__module__ in ("builtins", "importlib") and value.__name__ in _CODE_AS_TEXT:
            msg = f"A measure uses {value.__name__} as {name}, which cannot be followed; give a formula, or import it."
            raise StudyError(msg)
        if is_named(value):
            self._text(f"{value.__module__}.{value.__qualname__}")
            self.module(value.__module__)
        elif isinstance(value, FunctionType):
            self._function(value)
        elif isinstance(value, type):
            self._members(class_members(value), f"class {value.__qualname__}")
        elif type(value) is list:
            self._collection(value, name)
        elif type(value) is dict:
            self._collection(list(value.items()), name)
        elif (inner := unwrapped(value)) is not None:
            self.add(type(value), f"the type of {name}")
            self._members(inner, name)
        else:
            self.add(type(value), f"the type of {name}")
            self._members(object_members(value, name), name)

    def _collection(self, value: Any, name: str) -> None:
        """Add the items of a collection; those of a set in the order of their hashes."""
        self._text(f"{type(value).__name__} {len(value)}")
        if not isinstance(value, set | frozenset):
            for item in value:
                self.add(item, f"an item of {name}")
            return
        digests = []
        for item in value:  # each by itself, so that the order of the set does not count
            alone = _Content(dict(self.seen), set(self.modules))
            alone.add(item, f"an item of {name}")
            digests.append(alone.digest.digest())
        self._bytes(b"".join(sorted(digests)))

    def _members(self, members: Iterable[tuple[str, Any]], name: str) -> None:
        """Add values by name."""
        for part, value in members:
            self._text(part)
            self.add(value, f"{part} of {name}")

    def _function(self, function: FunctionType) -> None:
        """Add the code of a function, and the values that it reads."""
        name = function.__qualname__
        self._text(f"function {name}")
        home = function.__globals__.get("__name__")
        if is_own(home):
            self.add(function.__code__, name)
            self._globals(function)
        else:  # a function of a package around another one, such as one that a decorator made
            self.module(str(home))
            self._text(function.__code__.co_qualname)
        self._members([("default values", function.__defaults__)], name)
        self._members(sorted((function.__kwdefaults__ or {}).items()), name)
        for free, cell in zip(function.__code__.co_freevars, function.__closure__ or (), strict=True):
            try:
                content = cell.cell_contents
            except ValueError:  # nothing was assigned yet
                content = None
            self._members([(free, content)], name)
        self._members(sorted(vars(function).items()), name)

    def _globals(self, function: FunctionType) -> None:
        """Add the global values that the code of a function reads, and what it imports."""
        reads = Reads.of(function.__code__, str(function.__globals__.get("__package__") or ""))
        for name in sorted(reads.names):
            if name in function.__globals__:
                value = function.__globals__[name]
                self._members([(name, value)], function.__qualname__)
                if isinstance(value, ModuleType):
                    self._attributes(value, reads.attributes)
            elif name in _CODE_AS_TEXT:
                msg = f"The function {function.__qualname__} uses {name}, which cannot be followed; give a formula."
                raise StudyError(msg)
        for name in reads.modules:
            self.module(name)

    def _attributes(self, module: ModuleType, names: Iterable[str]) -> None:
        """Add what code reads of a module, for a program may have changed it."""
        if not is_own(module.__name__):
            if module.__name__ == "importlib" and "import_module" in names:
                msg = "A measure uses importlib.import_module, which cannot be followed; use an import statement."
                raise StudyError(msg)
            return
        for name in sorted(names):
            if name in vars(module):
                alone = _Content(dict(self.seen), set(self.modules))
                try:
                    alone.add(vars(module)[name], f"{name} of {module.__name__}")
                except StudyError:  # then the module's file tells what it is
                    continue
                self._text(f"{name} {alone.digest.hexdigest()}")

    def _code(self, code: CodeType, name: str) -> None:
        """Add bytecode, names and constants, those of functions within included."""
        self._bytes(code.co_code)
        self._bytes(code.co_exceptiontable)
        self._text(repr((code.co_names, code.co_varnames, code.co_freevars, code.co_flags)))
        self._members([("constants", code.co_consts)], name)

    def _text(self, text: str) -> None:
        self._bytes(text.encode("utf-8", "surrogatepass"))

    def _bytes(self, content: bytes) -> None:
        self.digest.update(len(content).to_bytes(8, "big") + content)
