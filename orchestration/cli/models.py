"""Finds the models of a Python file, or the shipped ones by name, for ``adaptimp build``.

The file declares models at its top level, and each of them is built:

    model = SampledModel("Mine", "What it does")
    model.output("tau_cmd", ...)
"""

import inspect
import runpy
import sys
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from orchestration.cli.model_hints import NUMPY_HINT, hinted, numpy_on_symbols
from orchestration.cli.output import output
from orchestration.errors import SystemDescriptionError
from orchestration.fmi.names import suggestion

if TYPE_CHECKING:
    from adaptimp_fmu import Model


def models_of(files: Sequence[Path]) -> "list[Model]":
    """Return the models of the catalog by name, and those that Python files name at their top level, in their order.

    A model without documentation gets the docstring of its file.

    Raises
    ------
    SystemDescriptionError
        If there is no such file, a file fails or does not name a model, or two models have the same name.
    """
    found: dict[str, tuple[Path, Model]] = {}
    for path in files:
        for model in _models(path):
            other, known = found.setdefault(model.name, (path, model))
            if known is not model:
                msg = f"Two models are called {model.name}, in {other} and in {path}; rename one."
                raise SystemDescriptionError(msg)
    return [model for _, model in found.values()]


def _models(path: Path) -> "list[Model]":
    from adaptimp_fmu import Model
    from fmus.catalog import MODELS, VARIANTS, model

    if str(path) in MODELS or str(path) in VARIANTS:
        return [model(str(path))]
    if not path.suffix and path.name == str(path) and not path.exists():
        near = suggestion(path.name, [*MODELS, *VARIANTS])
        msg = f"{path}: there is no such shipped model, and build takes Python files by their whole name; {near}"
        raise SystemDescriptionError(msg)
    if path.suffix != ".py" or not path.is_file():
        known = "files that declare models, names of shipped models, or none for all FMUs"
        msg = f"{path}: there is no such Python file; build takes {known}."
        raise SystemDescriptionError(msg)
    names = _run(path)
    models = [value for value in names.values() if isinstance(value, Model)]
    if not models:
        msg = f"{path} names no model at its top level; declare one, such as model = SampledModel(...)."
        raise SystemDescriptionError(msg)
    docstring = names.get("__doc__")
    for one in models:
        if not one.documentation and isinstance(docstring, str):
            one.documentation = {path.stem: inspect.cleandoc(docstring)}
    return models


def _run(path: Path) -> dict[str, object]:
    """Run a Python file and return the names that it defines; an error becomes a sentence with line and hint."""
    try:
        with _beside(path), numpy_on_symbols(str(path)) as lines:
            names = runpy.run_path(str(path))
    except Exception as error:
        file, line, said = path, _line(path, error), hinted(str(error))
        if isinstance(error, SyntaxError):  # may be one of a file that this one imports
            file, line, said = error.filename, error.lineno, error.msg
        where = f"{file}" if line is None else f"{file}, line {line}"
        msg = f"{where}: {type(error).__name__}: {said}"
        raise SystemDescriptionError(msg) from error
    for line in lines:
        output.remark(f"Notice: {path}, line {line}: {NUMPY_HINT}.")
    return names


def _line(path: Path, error: Exception) -> int | None:
    """Return the number of the innermost line of a file that an error came through."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(path)]
    return lines[-1] if lines else None


@contextmanager
def _beside(path: Path) -> Iterator[None]:
    """Let a file import its neighbours, as Python does for a script."""
    before = sys.path[:]
    sys.path.insert(0, str(path.parent.resolve()))
    try:
        yield
    finally:
        sys.path[:] = before
