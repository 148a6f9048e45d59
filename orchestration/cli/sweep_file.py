"""Reads a study from a TOML file; its keys are the long options of ``adaptimp sweep``.

system = "fig5"
seeds = "1-30"
measure = ["peak_force", "max_e"]
store = "runs"

[vary]
"plant.K_f" = "1e4:1e6:9log"
"""

import tomllib
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from orchestration.errors import OrchestrationError, SystemDescriptionError
from orchestration.fmi.names import suggestion

SUFFIX = ".toml"
TEXT, NUMBER, INTEGER, FLAG, TABLE = "a text", "a number", "an integer", "true or false", "a table"
TEXTS, INTEGERS = "a list of texts", "a list of integers"
KEYS: dict[str, tuple[str, ...]] = {
    "system": (TEXT, TABLE),
    "variant": (TEXT,),
    "controller": (TEXT,),
    "map": (TABLE,),
    "set": (TABLE,),
    "vary": (TABLE,),
    "seeds": (TEXT, INTEGER, INTEGERS),
    "measure": (TEXT, TEXTS, TABLE),
    "samples": (INTEGER,),
    "method": (TEXT,),
    "sample-seed": (INTEGER,),
    "stop": (NUMBER,),
    "step": (NUMBER,),
    "sample-time": (NUMBER,),
    "algorithm": (TEXT,),
    "isolate": (FLAG, TEXTS),
    "workers": (INTEGER,),
    "cluster": (TEXT,),
    "store": (TEXT,),
    "retry-failed": (FLAG,),
    "out": (TEXT,),
    "plot": (TEXT,),
    "best": (TEXT,),
}
"""Keys of a file, and what each may be."""
FACTOR = {"variables", "values"}
"""Keys of a factor that sets several start values."""


def read_study_file(path: Path) -> dict[str, Any]:
    """Read the keys of a file; paths in the file are those of files beside it.

    Raises
    ------
    SystemDescriptionError
        If the file is not there or not TOML, or a key is unknown or has a value of another kind.
    OrchestrationError
        If the file cannot be read.
    """
    try:
        found = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        msg = f"{path}: there is no such file of a study."
        raise SystemDescriptionError(msg) from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        msg = f"{path} is not TOML: {error}."
        raise SystemDescriptionError(msg) from error
    except OSError as error:
        msg = f"{path}: the file cannot be read: {error.strerror}."
        raise OrchestrationError(msg) from error
    for key, value in found.items():
        _require_kind(path, key, value)
    if "system" not in found:
        msg = f'{path}: the key system is missing; write system = "fig5", or the name of a file.'
        raise SystemDescriptionError(msg)
    found["vary"] = _flat(path, found.get("vary", {}), leaves=lambda table: FACTOR & set(table) != set())
    found["set"] = _flat(path, found.get("set", {}), leaves=lambda _: False)
    return _beside(path.parent, found)


def _require_kind(path: Path, key: str, value: Any) -> None:
    if key not in KEYS:
        msg = f"{path}: there is no key {key}; {suggestion(key, KEYS)}"
        raise SystemDescriptionError(msg)
    if not any(_IS[kind](value) for kind in KEYS[key]):
        msg = f"{path}: {key} is {value!r}; {' or '.join(KEYS[key])} is needed."
        raise SystemDescriptionError(msg)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_integer(value: Any) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _is_list(value: Any, of: Callable[[Any], bool]) -> bool:
    return isinstance(value, list) and all(map(of, value))


_IS: dict[str, Callable[[Any], bool]] = {
    TEXT: lambda value: isinstance(value, str),
    NUMBER: _is_number,
    INTEGER: _is_integer,
    FLAG: lambda value: isinstance(value, bool),
    TEXTS: lambda value: _is_list(value, lambda element: isinstance(element, str)),
    INTEGERS: lambda value: _is_list(value, _is_integer),
    TABLE: lambda value: isinstance(value, dict),
}


def _flat(path: Path, table: Mapping[str, Any], leaves: Callable[[Mapping[str, Any]], bool]) -> dict[str, Any]:
    """A table in which the keys of nested tables are paths: TOML makes nested tables of ``plant.K_f = 1e5``."""
    found: dict[str, Any] = {}
    for name, value in table.items():
        if not isinstance(value, dict):
            found[name] = value
        elif leaves(value):
            found[name] = _factor(path, name, value)
        else:
            found |= {f"{name}.{inner}": deep for inner, deep in _flat(path, value, leaves).items()}
    return found


def _factor(path: Path, name: str, table: Mapping[str, Any]) -> Mapping[str, Any]:
    """The table of a factor that sets several start values, which has both keys and no other."""
    if set(table) != FACTOR or not _IS[TEXTS](table["variables"]):
        msg = f"{path}: factor {name} has the keys {', '.join(table)}; variables, a list, and values are needed."
        raise SystemDescriptionError(msg)
    return table


def _beside(folder: Path, found: dict[str, Any]) -> dict[str, Any]:
    """The keys with paths that lead from the present folder to files beside the file."""
    system = found["system"]
    systems = dict(system) if isinstance(system, dict) else {"": system}
    for name, value in systems.items():
        if not isinstance(value, str):
            msg = f"Variant {name} of the study is {value!r}; a text, the name of a system, is needed."
            raise SystemDescriptionError(msg)
    found["system"] = {name: _path(folder, value) for name, value in systems.items()}
    if "controller" in found:
        found["controller"] = _path(folder, found["controller"])
    return found | {key: str(folder / found[key]) for key in ("store", "out", "plot") if key in found}


def _path(folder: Path, name: str) -> str:
    """The path of a file beside the study's; the name of a scenario or of a model stays as it is."""
    beside = folder / name
    return str(beside) if beside.exists() else name
