"""The FMUs of a system that stay open over many runs."""

from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from enum import Enum

from orchestration.errors import InitializationError
from orchestration.fmi.codes import ONE_INSTANCE
from orchestration.fmi.instance import Instance
from orchestration.fmi.isolation import Isolation
from orchestration.fmi.pool import PooledFmu, Reuse
from orchestration.master.initialization import input_scales
from orchestration.sandbox.guard import Guard
from orchestration.system.system import System

Key = tuple[str, ...]
"""Names of the components that share a library."""
Ways = Mapping[Key, Reuse]
"""How each library is made like new."""


class After(Enum):
    """What the FMUs have been through."""

    NOTHING = "nothing"
    END = "a run that came to its end"
    FAILURE = "a run that failed"


class OpenSystem:
    """The FMUs of a system, each unpacked and loaded once for many runs, one after the other.

    Parameters
    ----------
    system
        The system; its start values do not matter.
    isolation
        Which components live in processes of their own.

    Attributes
    ----------
    fmus
        The FMUs by the components that share a library.
    after
        What the FMUs have been through since they were loaded.
    """

    def __init__(self, system: System, isolation: Isolation | None) -> None:
        self._order = [component.name for component in system.components]
        self.after = After.NOTHING
        self.fmus: dict[Key, PooledFmu] = {}
        sharing: dict[tuple[str, str], list[str]] = {}
        for component in system.components:
            alone = component.description.can(ONE_INSTANCE) or _isolates(isolation, component.name)
            key = str(component.description.path), component.name if alone else ""
            sharing.setdefault(key, []).append(component.name)
        scales = input_scales(system)
        for names in sharing.values():
            limits = isolation if _isolates(isolation, names[0]) else None
            description = system.component(names[0]).description
            self.fmus[tuple(names)] = PooledFmu(names, description, isolation=limits, scales=scales)

    @contextmanager
    def like_new(self, ways: Ways, guard: Guard, *, strict: bool = False) -> Iterator[list[Instance]]:
        """Make all FMUs like new for a run; the end of the context leaves them as they are.

        Parameters
        ----------
        ways
            How; all FMUs that are not named are loaded.
        strict
            Whether it is an error if an FMU refuses its way. Otherwise it is loaded.

        Yields
        ------
        list of Instance
            Instances in the order of the components.

        Raises
        ------
        ArchiveError
            If an FMU does not load.
        InitializationError
            If an FMU cannot be instantiated.
        """
        for key, fmu in self.fmus.items():
            if fmu.is_lost or ways.get(key, Reuse.FRESH) == Reuse.FRESH:
                fmu.start()
        found = {}
        for key, fmu in self.fmus.items():
            try:
                instances = fmu.like_new(ways.get(key, Reuse.FRESH), guard)
            except InitializationError:
                if strict or key not in ways:
                    raise
                instances = fmu.like_new(Reuse.FRESH, guard)
            found |= {instance.name: instance for instance in instances}
        self.after = After.FAILURE
        yield [found[name] for name in self._order]
        self.after = After.END

    @property
    def processes(self) -> list[int]:
        """Ids of the processes in which isolated FMUs live."""
        return [process for fmu in self.fmus.values() if (process := fmu.process) is not None]

    @property
    def is_overdue(self) -> bool:
        """Whether a process was ended because a call took longer than its time limit."""
        return any(fmu.is_overdue for fmu in self.fmus.values())

    def reused(self, ways: Ways) -> Ways:
        """Those of the ways that do not load their FMU."""
        return {key: way for key, way in ways.items() if way != Reuse.FRESH and not self.fmus[key].is_lost}

    def unload(self) -> None:
        """Unload all FMUs; the next run loads them again."""
        for fmu in self.fmus.values():
            fmu.unload()
        self.after = After.NOTHING

    def end(self, how: str) -> None:
        """End the processes of isolated FMUs, from any thread; their run fails with this end of a sentence."""
        for fmu in self.fmus.values():
            fmu.end(how)

    def close(self) -> None:
        """Free everything; a second call does nothing."""
        with ExitStack() as each:
            for fmu in self.fmus.values():
                each.callback(fmu.close)


def _isolates(isolation: Isolation | None, component: str) -> bool:
    return isolation is not None and isolation.covers(component)
