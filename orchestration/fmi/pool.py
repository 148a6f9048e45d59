"""An FMU that stays open over many runs: unpacked and loaded once, and made like new before each run.

    fmu = PooledFmu(["plant"], description)
    (instance,) = fmu.like_new(Reuse.RESET)        # loads it the first time, and after a crash
    ...                                            # a run
    fmu.close()

A quick way must be as good as loading the FMU again; `orchestration.master.reuse` finds out whether it is.
"""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from enum import IntEnum
from pathlib import Path
from typing import Any

from orchestration.fmi.blame import blaming
from orchestration.fmi.codes import SAVES_STATE
from orchestration.fmi.description import Description
from orchestration.fmi.instance import Instance
from orchestration.fmi.isolation import Isolation
from orchestration.fmi.library import needed_to_run
from orchestration.fmi.remote_library import start_process
from orchestration.fmi.units import Linear
from orchestration.sandbox.archive import unpacked
from orchestration.sandbox.guard import Guard
from orchestration.sandbox.remote import RemoteProcess

Scales = Mapping[str, Mapping[int, Linear]]
"""Conversions of inputs by value reference, by the name of a component."""
_WHEN = "while it was made ready for another run"


class Reuse(IntEnum):
    """How an FMU that has been run is made like new, from the quickest way to the surest."""

    RESET = 0
    """By fmi2Reset."""
    STATE = 1
    """By the state that was saved when the FMU had been instantiated."""
    ANEW = 2
    """By another instance, with the library that is loaded."""
    FRESH = 3
    """By loading the library again, from another file or in another process."""


class PooledFmu:
    """An FMU that stays open over many runs, with an instance for each component that shares its library.

    Parameters
    ----------
    names
        Names of the components; of an isolated FMU, and of one that allows a single instance, one.
    description
        Description of the FMU.
    isolation
        Limits of the process in which the FMU lives; None to load it in this process.
    scales
        Conversions of inputs, by component and value reference.

    Attributes
    ----------
    instances
        The instances in the order of `names`; none before the first `like_new`.
    can_reset
        Whether the library has fmi2Reset, once it was loaded.
    """

    def __init__(
        self,
        names: Sequence[str],
        description: Description,
        *,
        isolation: Isolation | None = None,
        scales: Scales | None = None,
    ) -> None:
        self.names, self.description, self.isolation = tuple(names), description, isolation
        self.instances: list[Instance] = []
        self.can_reset = True
        self._saves = False
        self._scales = scales or {}
        self._folder = ExitStack()
        self._unpacked: Path | None = None
        self._process: RemoteProcess | None = None  # of the instance
        self._spare: RemoteProcess | None = None  # that gets ready
        self._states: list[Any] = []

    @property
    def is_lost(self) -> bool:
        """Whether the FMU must be loaded: it is not loaded yet, or must not be called any more."""
        return not self.instances or any(instance.is_lost for instance in self.instances)

    @property
    def is_overdue(self) -> bool:
        """Whether the process of an isolated FMU was ended because a call took longer than its time limit."""
        return self._process is not None and self._process.overdue

    @property
    def can_save(self) -> bool:
        """Whether the FMU declares that its state can be saved."""
        return self.description.can(SAVES_STATE)

    @property
    def process(self) -> int | None:
        """Id of the process in which the FMU lives; None if there is none."""
        return None if self._process is None or self._process.ending else self._process.pid

    def start(self) -> None:
        """Let a process for an isolated FMU get ready, while this process goes on."""
        if self.isolation is not None and self._spare is None:
            self._spare = start_process(self.isolation, len(self.description.variables))

    def like_new(self, way: Reuse, guard: Guard | None = None) -> list[Instance]:
        """Return the instances as they were when the FMU had been instantiated.

        Parameters
        ----------
        way
            How it is done. An FMU that is lost is loaded in any case, and so is one whose state was not saved yet.
        guard
            Puts back what the FMU changes in this process.

        Raises
        ------
        ArchiveError
            If the FMU does not load.
        InitializationError
            If a call fails. The FMU is then unloaded.
        """
        guard = guard or Guard()
        unsaved = way == Reuse.STATE and not self._states
        self._saves = self._saves or unsaved
        with blaming(f"{self.names[0]}: {self.description.path.name}", self.description.path):
            try:
                if way == Reuse.FRESH or unsaved or self.is_lost:
                    self._load(guard)
                else:
                    with guard.over(self._exposed, "while it was made ready for another run"):
                        self._make_like_new(way)
            except BaseException:
                self.unload(guard)
                raise
        return self.instances

    def unload(self, guard: Guard | None = None) -> None:
        """Free the instances and unload the library; the next `like_new` loads it again."""
        instances, self.instances, states, self._states = self.instances, [], self._states, []
        with (guard or Guard()).over(self._exposed, "while it was freed"), ExitStack() as each:
            for instance in instances:
                each.callback(instance.close)
            for instance, state in zip(instances, states, strict=False):
                if not instance.is_lost:
                    instance.free_state(state)
        if self._process is not None:
            self._process.close()
        self._process = None
        if self.isolation is None:  # the same file would be the same library, with the values of its variables
            self._remove()

    def end(self, how: str) -> None:
        """End the process of an isolated FMU, from any thread; its run fails with this end of a sentence."""
        if (process := self._process) is not None:
            process.end(how)

    def close(self) -> None:
        """Free everything; a second call does nothing."""
        try:
            self.unload()
        finally:
            if self._spare is not None:
                self._spare.close()
            self._spare = None
            self._remove()

    def _load(self, guard: Guard) -> None:
        """Load the library and instantiate the FMU, in a new process if it is isolated."""
        self.unload(guard)
        self.start()
        self._process, self._spare = self._spare, None
        if self._unpacked is None:
            self._unpacked = self._folder.enter_context(unpacked(self.description.path, needed_to_run))
        with guard.over(self._exposed, "while it was loaded and instantiated"):
            for name in self.names:
                self.instances.append(Instance.open(name, self.description, self._unpacked, process=self._process))
                self._scale(self.instances[-1])
            self.can_reset = not self.instances[0].library.lacks(["fmi2Reset"])
            if self._saves:
                self._states = [instance.save() for instance in self.instances]

    def _make_like_new(self, way: Reuse) -> None:
        for k, instance in enumerate(self.instances):
            if way == Reuse.RESET:
                instance.reset()
            elif way == Reuse.STATE:
                instance.forget()
                instance.restore(self._states[k])
            else:
                instance.renew()
                self._scale(instance)

    @property
    def _exposed(self) -> tuple[str, ...]:
        """Components whose FMUs run in this process."""
        return self.names if self.isolation is None else ()

    def _scale(self, instance: Instance) -> None:
        if instance.name in self._scales:
            instance.scale_inputs(self._scales[instance.name])

    def _remove(self) -> None:
        """Remove what was unpacked."""
        self._unpacked = None
        self._folder.close()
