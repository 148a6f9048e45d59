"""The identity of a function: a hash of everything of its code that can change what it returns.

It covers the bytecode with its constants and names, default values, values from enclosing functions, and global
values that the code reads. It covers the functions and classes among them in the same way. Of a module it covers the
name, and of a module that no installed package brings the file. Comments and line numbers do not count.
"""

import functools
import hashlib
import pickle
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import BuiltinFunctionType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

from orchestration.errors import StudyError


def function_identity(function: Callable[..., Any]) -> str:
    """SHA-256 hash, as hexadecimal text, of what a function does.

    Raises
    ------
    StudyError
        If the function reads a value whose content cannot be told, such as an open file.
    """
    digest = hashlib.sha256()
    for part in _parts(function, set()):
        digest.update(len(part).to_bytes(8, "big") + part)
    return digest.hexdigest()


def _parts(value: Any, seen: set[int]) -> Iterator[bytes]:
    """Texts that tell a value from others; functions that were seen before are named only."""
    if isinstance(value, FunctionType):
        yield value.__qualname__.encode()
        if id(value) not in seen:
            seen.add(id(value))
            yield from _function(value, seen)
    elif isinstance(value, MethodType):
        yield from _parts(value.__func__, seen)
        yield from _parts(value.__self__, seen)
    elif isinstance(value, functools.partial):
        for part in (value.func, value.args, sorted(value.keywords.items())):
            yield from _parts(part, seen)
    elif isinstance(value, ModuleType):
        yield value.__name__.encode()
        yield _own_file(value)
    elif isinstance(value, type) and id(value) not in seen and _own_file(sys.modules.get(value.__module__)):
        seen.add(id(value))
        for name, member in sorted(vars(value).items()):
            if isinstance(member, FunctionType):
                yield name.encode()
                yield from _parts(member, seen)
    elif isinstance(value, type | BuiltinFunctionType):
        yield f"{value.__module__}.{value.__qualname__}".encode()
    elif isinstance(value, tuple | list):
        yield type(value).__name__.encode()
        for item in value:
            yield from _parts(item, seen)
    elif isinstance(value, set | frozenset):
        yield repr(sorted(map(repr, value))).encode()
    else:
        yield from _object(value, seen)


def _object(value: Any, seen: set[int]) -> Iterator[bytes]:
    """Content of a value that is neither a function nor a collection, and the code of its type if it can be called."""
    if callable(value):
        yield from _parts(type(value), seen)
    try:
        yield pickle.dumps(value, protocol=5)
    except (pickle.PicklingError, TypeError, AttributeError) as error:
        msg = (
            f"A measure reads a value of type {type(value).__name__}, whose content cannot be told ({error});"
            " give the function what it needs as numbers, texts or arrays."
        )
        raise StudyError(msg) from error


def _own_file(module: ModuleType | None) -> bytes:
    """Hash of the file of a module; empty for one of Python or of an installed package."""
    file = getattr(module, "__file__", None)
    if file is None or Path(file).is_relative_to(sys.prefix) or Path(file).is_relative_to(sys.base_prefix):
        return b""
    return hashlib.sha256(Path(file).read_bytes()).digest()


def _function(function: FunctionType, seen: set[int]) -> Iterator[bytes]:
    """Code of a function, and the values that it reads."""
    yield from _code(function.__code__, seen)
    yield from _parts(function.__defaults__ or (), seen)
    yield from _parts(sorted((function.__kwdefaults__ or {}).items()), seen)
    for cell in function.__closure__ or ():
        yield from _parts(cell.cell_contents, seen)
    for name in sorted(_names(function.__code__)):
        if name in function.__globals__:
            yield name.encode()
            yield from _parts(function.__globals__[name], seen)


def _code(code: CodeType, seen: set[int]) -> Iterator[bytes]:
    """Bytecode, names and constants, those of functions within included."""
    yield code.co_code
    yield repr((code.co_names, code.co_varnames, code.co_freevars)).encode()
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _code(constant, seen)
        else:
            yield from _parts(constant, seen)


def _names(code: CodeType) -> set[str]:
    """Names of globals that code may read, within inner functions too."""
    inner = (constant for constant in code.co_consts if isinstance(constant, CodeType))
    return set(code.co_names).union(*map(_names, inner))
