"""Limits of a process that runs a stranger's library, set by the process itself before it loads the library."""

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

MOST_WRITTEN = 4 * 1024**3  # bytes of a file, so that a library that writes for ever fills no disk


def limit_process(limits: Mapping[str, int | None]) -> None:
    """Limit this process, where the system can.

    Parameters
    ----------
    limits
        ``memory``, bytes that it may take beyond what it has taken, and ``descriptors``, files that it may have open;
        None sets no limit.
    """
    with suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_FSIZE, (MOST_WRITTEN, MOST_WRITTEN))
        if (descriptors := limits["descriptors"]) is not None:
            resource.setrlimit(resource.RLIMIT_NOFILE, (descriptors, descriptors))
        if (memory := limits["memory"]) is not None:
            most = _addresses() + memory
            resource.setrlimit(resource.RLIMIT_AS, (most, most))


def _addresses() -> int:
    """Bytes of addresses that this process has taken; 0 where the system does not tell."""
    import resource

    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except OSError:
        return 0
    return pages * resource.getpagesize()
