"""What classes and objects are made of, by name, so that the identity of a measure can cover it."""

import copyreg
import functools
import pickle
import sys
from collections.abc import Iterator
from types import BuiltinFunctionType, FunctionType, GetSetDescriptorType, MappingProxyType, MemberDescriptorType
from types import MethodType as Method
from typing import Any

from orchestration.campaigns.measuring.module_content import is_own
from orchestration.errors import StudyError, printable

# What Python notes of a class beside its code. Values of fields are in the class and in its __init__.
_NOTES = frozenset(
    "__abstractmethods__ __annotate__ __annotate_func__ __annotations__ __annotations_cache__ __dataclass_fields__"
    " __dataclass_params__ __dict__ __doc__ __firstlineno__ __module__ __orig_bases__ __parameters__"
    " __static_attributes__ __weakref__ _abc_impl".split()
)
_MADE_AT_RUN_TIME = 1 << 9  # Py_TPFLAGS_HEAPTYPE; other types are Python's own, such as that of functions


def is_named(value: Any) -> bool:
    """Whether a function or class is told by its name: it belongs to Python or to a package, and is found there."""
    module, name = getattr(value, "__module__", None), getattr(value, "__qualname__", None)
    if not isinstance(module, str) or not isinstance(name, str) or is_own(module):
        return False
    found: Any = sys.modules.get(module)
    for part in name.split("."):
        found = getattr(found, part, None)
    return found is value or (isinstance(value, type) and not value.__flags__ & _MADE_AT_RUN_TIME)


def class_members(kind: type) -> Iterator[tuple[str, Any]]:
    """Members of a class by name, and its bases."""
    for name, member in sorted(vars(kind).items()):
        if name not in _NOTES and not isinstance(member, MemberDescriptorType | GetSetDescriptorType):
            yield name, member
    yield "metaclass", type(kind)
    yield "bases", kind.__bases__


def unwrapped(value: Any) -> list[tuple[str, Any]] | None:
    """What is inside of methods, properties, and objects of packages around a function; None of other values."""
    if isinstance(value, Method):
        return [("function", value.__func__), ("object", value.__self__)]
    if isinstance(value, property):
        return [("get", value.fget), ("set", value.fset), ("delete", value.fdel)]
    if isinstance(value, staticmethod | classmethod):
        return [("function", value.__func__)]
    if isinstance(value, functools.cached_property):
        return [("function", value.func)]
    if isinstance(value, functools.partial | functools.partialmethod):
        return [("function", value.func), ("arguments", value.args), *sorted(value.keywords.items())]
    if isinstance(value, MappingProxyType):
        return [("content", dict(value))]
    if isinstance(value, BuiltinFunctionType):
        return [("name", value.__name__), ("object", value.__self__)]
    if isinstance(value, functools._lru_cache_wrapper):
        return [("function", value.__wrapped__)]
    if hasattr(value, "targetoptions") and isinstance(getattr(value, "py_func", None), FunctionType):
        return [("function", value.py_func), ("options", value.targetoptions)]  # compiled by numba.njit
    return None


def object_members(value: Any, name: str) -> list[tuple[str, Any]]:
    """What an object is made of, as pickle takes it to pieces.

    Raises
    ------
    StudyError
        If pickle cannot do so.
    """
    try:
        reduce = copyreg.dispatch_table.get(type(value))
        pieces = value.__reduce_ex__(2) if reduce is None else reduce(value)
        if isinstance(pieces, str):
            return [("name", _found_by_name(value, pieces))]
    except Exception as error:
        msg = (
            f"A measure reads {name}, a value of type {type(value).__name__}, whose content cannot be told"
            f" ({printable(error, 300)});"
            " give a formula, or keep the value in a module of your own and read it as module.name."
        )
        raise StudyError(msg) from error
    given: tuple[Any, ...] = (*pieces, None, None, None)
    function, arguments, state, items, pairs = given[:5]
    return [
        ("made by", function),
        ("arguments", arguments),
        ("state", sorted(state.items()) if type(state) is dict and all(isinstance(k, str) for k in state) else state),
        ("items", None if items is None else list(items)),
        ("pairs", None if pairs is None else list(pairs)),
    ]


def _found_by_name(value: Any, name: str) -> str:
    """Full name of an object that pickle takes by its name, from a package."""
    pickle.dumps(value)  # fails unless it is found by this name
    module = getattr(value, "__module__", None)
    if is_own(module):
        msg = f"it is known by its name {name} only"
        raise TypeError(msg)
    return f"{module}.{name}"
