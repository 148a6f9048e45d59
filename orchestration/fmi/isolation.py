"""Which components of a run live in processes of their own, and what such a process may do."""

import sys
from collections.abc import Collection
from dataclasses import dataclass

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.given import positive, require_names, shown

GIBIBYTE = 1024**3
CAN_ISOLATE = sys.platform != "win32"
"""Whether this system can isolate FMUs; on Windows a process inherits no sockets."""


@dataclass(frozen=True)
class Isolation:
    """Components whose FMUs live in processes of their own, and the limits of such a process.

    Attributes
    ----------
    components
        Names of components; all components if None.
    time_limit
        Longest time that a call of the FMU may take, s; None for no limit.
    memory_limit
        Bytes of memory that the FMU may take; None for no limit.
    descriptor_limit
        Files and connections that the process may have open at once; None for no limit.

    Raises
    ------
    SystemDescriptionError
        If a name is not a text, or a limit is not a positive number.

    Examples
    --------
    A controller of somebody else may take a second for a step, and a gigabyte:

    >>> from orchestration import Isolation, scenario, simulate
    >>> careful = Isolation(["controller"], time_limit=1.0, memory_limit=2**30)
    >>> result = simulate(scenario("fig2"), stop_time=0.1, isolate=careful)
    >>> result.metadata["isolated"]
    '["controller"]'
    >>> careful.covers("controller"), careful.covers("plant"), Isolation.of(True).covers("plant")
    (True, False, True)
    """

    components: Collection[str] | None = None
    time_limit: float | None = 60.0
    memory_limit: int | None = 4 * GIBIBYTE
    descriptor_limit: int | None = 256

    def __post_init__(self) -> None:
        """Refuse limits that nothing can keep."""
        if self.components is not None:
            require_names("isolate", self.components, "'controller'")
            names = (self.components,) if isinstance(self.components, str) else tuple(self.components)
            object.__setattr__(self, "components", names)
        for name, unit in (("time_limit", "s"), ("memory_limit", "bytes"), ("descriptor_limit", "")):
            value = getattr(self, name)
            if value is not None:
                positive(f"{name} of Isolation", value, unit=unit)

    @classmethod
    def of(cls, given: object) -> "Isolation | None":
        """What was asked for: True for all components, names of components, or an `Isolation`; None for none.

        Raises
        ------
        SystemDescriptionError
        """
        if given is None or given is False:
            return None
        if given is True:
            return cls()
        if isinstance(given, cls):
            return given
        if isinstance(given, str) or isinstance(given, Collection):
            return cls(given)
        msg = f"isolate is {shown(given)}; give True, names of components, or an Isolation."
        raise SystemDescriptionError(msg)

    def covers(self, component: str) -> bool:
        """Whether a component lives in a process of its own."""
        return self.components is None or component in self.components
