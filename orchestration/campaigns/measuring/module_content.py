"""What a module adds to the identity of a measure: the version of its package, or its file and what that imports.

A module is an *own* module if it belongs neither to Python, nor to an installed package, nor to this project. It
counts by the content of its file, and by all modules that its source imports, wherever the source does so. An installed
package counts by its version. A module of Python counts by its name, for Python's version counts for each run.
"""

import ast
import hashlib
import importlib.util
import site
import sys
from collections.abc import Iterable, Iterator
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, distribution, packages_distributions, version
from pathlib import Path
from sysconfig import get_path
from types import ModuleType

from orchestration.errors import StudyError

_OURS = frozenset({"adaptimp_fmu", "fmus", "orchestration"})
_MAIN = "__main__"


def is_own(name: str | None) -> bool:
    """Whether code of a module of this name must be looked at: it is that of an own module, or of no known module."""
    if name is None or name == _MAIN:
        return True
    place = _file(name)
    return _package(name, place) is None and not _of_python(name, place)


def module_content(name: str, seen: set[str], loaded: ModuleType | None = None) -> Iterator[str]:
    """Texts that tell a module from others, and from itself with other code.

    Parameters
    ----------
    name
        Full name of the module, imported or not.
    seen
        Names of modules that were counted before; they are left out, and this module is added.
    loaded
        The module itself, where a program has it at hand. Default: the one that an import gives.

    Raises
    ------
    StudyError
        If an own module has no file, or its file is not Python's source.
    """
    file = _file(name, loaded)
    if f"{name} {file}" in seen:
        return
    seen.add(f"{name} {file}")
    if loaded is not None and file is None and not _of_python(name, file) and not hasattr(loaded, "__path__"):
        msg = (
            f"A measure uses the module {name}, which has no file to tell it by; give a formula, or write it to a file."
        )
        raise StudyError(msg)
    package = _package(name, file)
    if package is not None:
        yield f"{name} of {package}"
    elif file is None or _of_python(name, file):
        yield name
    else:
        content = file.read_bytes()
        yield f"{name} {hashlib.sha256(content).hexdigest()}"
        if file.suffix == ".py":
            for other in _imports(content, name, is_package=file.name == "__init__.py"):
                yield from module_content(other, seen)


def imported(package: str, name: str, level: int, names: Iterable[str] | None) -> Iterator[str]:
    """Names of the modules that an import statement reads.

    Parameters
    ----------
    package
        Package of the code that has the statement.
    name
        Name of the module after ``import`` or ``from``.
    level
        Number of leading dots.
    names
        Names after ``from ... import``; those that are modules count, too.
    """
    if level:
        parts = package.split(".")
        base = ".".join(parts[: len(parts) - level + 1])
        name = f"{base}.{name}" if name else base
    parts = name.split(".")
    yield from (".".join(parts[:end]) for end in range(1, len(parts) + 1))  # each package's __init__ is run, too
    if is_own(name):
        yield from (f"{name}.{one}" for one in names or () if one != "*" and _file(f"{name}.{one}") is not None)


@lru_cache(maxsize=256)
def _imports(content: bytes, name: str, *, is_package: bool) -> tuple[str, ...]:
    """Names of all modules that a source imports."""
    package = name if is_package else name.rpartition(".")[0]
    try:
        nodes = list(ast.walk(ast.parse(content)))
    except (SyntaxError, ValueError) as error:
        msg = f"A measure uses the module {name}, whose file cannot be read ({error}); mend it, or give a formula."
        raise StudyError(msg) from error
    found: dict[str, None] = {}
    for node in nodes:
        if isinstance(node, ast.Import):
            for alias in node.names:
                found.update(dict.fromkeys(imported(package, alias.name, 0, None)))
        elif isinstance(node, ast.ImportFrom):
            names = [alias.name for alias in node.names]
            found.update(dict.fromkeys(imported(package, node.module or "", node.level, names)))
    return tuple(found)


def _file(name: str, loaded: ModuleType | None = None) -> Path | None:
    """File of a module; None of one that has no file, or is not there."""
    module = loaded or sys.modules.get(name)
    file = getattr(module, "__file__", None)
    if module is None:
        try:
            found = importlib.util.find_spec(name)
        except (ImportError, AttributeError, ValueError):  # its package is not there, or is not a package
            return None
        file = found.origin if found is not None and found.has_location else None
    if file is None or Path(file).is_file():
        return None if file is None else Path(file).resolve()
    if name.partition(".")[0] in sys.stdlib_module_names:
        return None
    msg = f"A measure uses the module {name}, whose file {file} is not there; give a formula, or keep it in a folder."
    raise StudyError(msg)


def _package(name: str, file: Path | None) -> str | None:
    """Name and version of the installed package that a module is of; None if it is of none."""
    top = name.partition(".")[0]
    if top in _OURS:
        return "adaptimp"  # its version and its source count for each run
    if file is None or not any(file.is_relative_to(folder) for folder in _installed()):
        return None
    return ", ".join(f"{one} {_version(one)}" for one in _distributions(top)) or None


def _of_python(name: str, file: Path | None) -> bool:
    """Whether a module is one of Python's standard library."""
    if file is None:
        return name.partition(".")[0] in sys.stdlib_module_names
    standard = (Path(get_path(kind)).resolve() for kind in ("stdlib", "platstdlib"))
    return any(file.is_relative_to(folder) for folder in standard) and not any(
        file.is_relative_to(folder) for folder in _installed()
    )


@lru_cache(maxsize=1)
def _installed() -> tuple[Path, ...]:
    """Folders of installed packages."""
    folders = [get_path("purelib"), get_path("platlib"), *site.getsitepackages(), site.getusersitepackages()]
    return tuple(Path(folder).resolve() for folder in dict.fromkeys(folders))


@lru_cache(maxsize=256)
def _distributions(top: str) -> tuple[str, ...]:
    """Names of the distributions that bring a module, by the first part of the module's name."""
    try:  # most have the name of their module, and a search among all takes some tenths of a second
        if f"{top}/" in (distribution(top).read_text("RECORD") or ""):
            return (top,)
    except PackageNotFoundError:
        pass
    return tuple(sorted(set(packages_distributions().get(top, ()))))


@lru_cache(maxsize=256)
def _version(distribution: str) -> str:
    """Version of a distribution that is installed."""
    return version(distribution)
