"""A task as bytes: the system as an SSP package with its FMUs, all else by cloudpickle."""

import hashlib
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from pickle import PicklingError
from sysconfig import get_path
from types import ModuleType
from typing import Any

from adaptimp_fmu.files.temporary_folder import temporary_folder
from orchestration.campaigns.engines.engine import Engine
from orchestration.campaigns.engines.task import Task
from orchestration.errors import ClusterError, printable
from orchestration.system.system import System

MakeEngine = Callable[[Task], Engine]
_FILE = "system.ssp"
_OURS = frozenset({"adaptimp_fmu", "fmus", "orchestration"})


@dataclass(frozen=True)
class Payload:
    """What a worker needs to make the runs of a task; it holds no path of the machine that made it.

    Attributes
    ----------
    package
        SSP package with the system and its FMUs.
    rest
        All other fields of the task, and the function that makes the engine, by cloudpickle.
    """

    package: bytes
    rest: bytes

    @classmethod
    def of(cls, task: Task, make_engine: MakeEngine) -> "Payload":
        """Pack a task and the function that makes its engine.

        Raises
        ------
        SystemDescriptionError
            If an SSP package cannot hold the system.
        ClusterError
            If a measure refers to something that cannot be sent, such as an open file.
        """
        others = {field.name: getattr(task, field.name) for field in fields(task) if field.name != "system"}
        try:
            rest = _pickled((others, make_engine), [m.function for m in task.measures])
        except (TypeError, PicklingError) as error:
            names = printable(", ".join(task.measure_names), 200)
            msg = f"A function among the measures {names} cannot be sent to workers: {printable(error, 500)}."
            raise ClusterError(msg) from error
        with temporary_folder() as folder:
            return cls(task.system.write(folder / _FILE).read_bytes(), rest)

    @cached_property
    def name(self) -> str:
        """A name that tells the content from all others."""
        content = hashlib.sha256(self.package)
        content.update(hashlib.sha256(self.rest).digest())
        return f"adaptimp-{content.hexdigest()[:32]}"

    def engine(self) -> Engine:
        """Unpack the task and make its engine.

        Raises
        ------
        OrchestrationError
            If the system cannot be read here, or there is no engine for it.
        ImportError, AttributeError
            If a measure needs a module that is not here.
        """
        import cloudpickle

        others, make_engine = cloudpickle.loads(self.rest)
        with temporary_folder() as folder:
            file = folder / _FILE
            file.write_bytes(self.package)
            system = System.read(file)  # its FMUs stay in the cache
        return make_engine(Task(system=system, **others))


def _pickled(content: Any, functions: list[Any]) -> bytes:
    """Content as bytes, with the code of the functions that a worker cannot import."""
    import cloudpickle

    with _by_value({function.__module__ for function in functions if hasattr(function, "__module__")}):
        return cloudpickle.dumps(content)


@contextmanager
def _by_value(modules: set[str]) -> Iterator[None]:
    """Let cloudpickle send the code of modules that are not installed, such as files beside a program."""
    import cloudpickle

    already = cloudpickle.list_registry_pickle_by_value()
    sent = [sys.modules[name] for name in modules - already if name in sys.modules and _is_own(sys.modules[name])]
    for module in sent:
        cloudpickle.register_pickle_by_value(module)
    try:
        yield
    finally:
        for module in sent:
            cloudpickle.unregister_pickle_by_value(module)


def _is_own(module: ModuleType) -> bool:
    """Whether a module belongs neither to Python, nor to an installed package, nor to this project."""
    if module.__name__.partition(".")[0] in _OURS or not getattr(module, "__file__", None):
        return False
    file = Path(str(module.__file__)).resolve()
    return not any(file.is_relative_to(Path(get_path(kind)).resolve()) for kind in ("stdlib", "purelib", "platlib"))
