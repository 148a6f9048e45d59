"""Finds out how FMUs can be made like new for another run, so that it has the bits of a run with FMUs just loaded.

FMI 2.0 has fmi2Reset for that, but a library may reset too little, keep values in global variables, or lack the
function. So nothing is taken on trust. The first time that a run follows another, it is made with FMUs just loaded,
and once more after fmi2Reset. If both record the same bits, all FMUs are reset from then on. Else each FMU is tried
alone, in each of its ways, from the quickest to the surest.
"""

import threading
from collections.abc import Callable

from orchestration.errors import printable, warn_caller
from orchestration.fmi.pool import Reuse
from orchestration.master.form import FormalityWarning
from orchestration.master.open_system import After, Key, OpenSystem, Ways
from orchestration.results.result import Result

Attempt = Callable[[Ways], Result | None]
"""Makes a run in the given ways; returns all that it recorded, or None if it failed."""

_INSTEAD = {
    Reuse.STATE: "the state after its instantiation is restored",
    Reuse.ANEW: "it is instantiated again",
    Reuse.FRESH: "it is loaded again",
}


class Learned:
    """What is known of the FMUs of a system; several threads may ask and learn at the same time.

    Attributes
    ----------
    learning
        Held by the thread that finds out; the others load their FMUs in the meantime.
    """

    def __init__(self) -> None:
        self.learning = threading.Lock()
        self._ways: dict[tuple[After, Key], Reuse] = {}

    def ways(self, system: OpenSystem) -> Ways | None:
        """How to make the FMUs of a system like new after what they have been through; None if that is not known."""
        if system.after == After.NOTHING:
            return {}
        known = {key: self.way(system.after, key) for key, fmu in system.fmus.items() if not fmu.is_lost}
        found = {key: way for key, way in known.items() if way is not None}
        return found if len(found) == len(known) else None

    def way(self, after: After, key: Key) -> Reuse | None:
        """How to make a library like new; None if that is not known."""
        return self._ways.get((after, key))

    def learn(self, after: After, ways: Ways) -> None:
        """Take note of what was found out."""
        self._ways |= {(after, key): way for key, way in ways.items()}


def same(found: Result | None, truth: Result) -> bool:
    """Whether a run has recorded the rows of another bit by bit, with the same end."""
    if found is None or (found.status, found.message) != (truth.status, truth.message):
        return False
    numbers = found.time.tobytes() == truth.time.tobytes() and found.rows.tobytes() == truth.rows.tobytes()
    return numbers and all(list(found[name]) == list(truth[name]) for name in truth.texts)


def quickest(system: OpenSystem) -> Ways:
    """The quickest way that each library offers."""
    loaded = {key: fmu for key, fmu in system.fmus.items() if not fmu.is_lost}
    return {key: Reuse.RESET if fmu.can_reset else Reuse.ANEW for key, fmu in loaded.items()}


def each_alone(system: OpenSystem, truth: Result, before: Attempt, again: Attempt) -> Ways:
    """Find the quickest way of each FMU with which a run has the right bits.

    Parameters
    ----------
    truth
        The run with FMUs just loaded.
    before, again
        Make the run that came before it, and this run, with the FMUs of the system.
    """

    def right(ways: Ways) -> bool:
        system.unload()
        before(ways)
        return same(again(ways), truth)

    ways: dict[Key, Reuse] = {}
    for key, fmu in system.fmus.items():
        offered = [Reuse.RESET] * fmu.can_reset + [Reuse.STATE] * fmu.can_save + [Reuse.ANEW]
        ways[key] = next((way for way in offered if right({key: way})), Reuse.FRESH)
    if not right(ways):
        ways = dict.fromkeys(system.fmus, Reuse.FRESH)
    return ways


def warn_of_slow_ones(system: OpenSystem, ways: Ways) -> None:
    """Warn of each FMU that fmi2Reset does not make like new."""
    for key, way in ways.items():
        if way == Reuse.RESET:
            continue
        msg = (
            f"{system.fmus[key].description.path.name} breaks a rule of FMI that no step needs: fmi2Reset does not make"
            f" {' and '.join(key)} like new, so {_INSTEAD[way]} before each run, which takes longer."
        )
        warn_caller(printable(msg), FormalityWarning)
