"""Versions that scheduler, workers and client must have in common, so that a run gives the same bits everywhere.

Operating systems and processors may differ: an FMU of this project brings its own mathematics, and steps are strict
IEEE arithmetic on every platform.
"""

from collections.abc import Mapping
from typing import Any

from orchestration.errors import ClusterError

COMPARED: Mapping[str, int | None] = {
    "adaptimp": None,  # it decides every bit
    "distributed": None,  # its protocol changes from release to release
    "python": 2,  # functions of measures travel as its byte code, which minor versions change
    "numpy": 2,  # minor versions change the order of sums, with which measures may be made
    "numba": 2,  # minor versions change the compiler behind the master
}
"""Packages, with the number of leading parts of their versions that must agree; None for all of them."""

SCHEDULER = ("adaptimp", "distributed", "python")
"""Packages that matter on a scheduler, which makes no runs."""
_SHOWN = 3  # machines that a message names


def require_equal(versions: Mapping[str, Any]) -> None:
    """Refuse a cluster whose machines would not make the same runs as this one.

    Parameters
    ----------
    versions
        What `distributed.Client.get_versions` returns when it is asked for `COMPARED`.

    Raises
    ------
    ClusterError
        If a version differs. The message names machine, both versions and the remedy.
    """
    ours = versions["client"]["packages"]
    found = differences("The scheduler", versions["scheduler"]["packages"], ours, SCHEDULER)
    for address, worker in versions["workers"].items():
        found += differences(f"Worker {address}", worker["packages"], ours)
    if found:
        more = len(found) - _SHOWN
        raise ClusterError(" ".join([*found[:_SHOWN], *([f"There are {more} more differences."] if more > 0 else [])]))


def differences(
    machine: str, theirs: Mapping[str, Any], ours: Mapping[str, Any], packages: Mapping[str, Any] | tuple = COMPARED
) -> list[str]:
    """Sentences about versions of a machine that do not fit those of the client.

    Parameters
    ----------
    machine
        Subject of the sentences.
    theirs, ours
        Versions by package; None of a package that is not installed.
    packages
        Packages that matter on the machine.
    """
    return [
        f"{machine} has {_shown(package, theirs.get(package))}, but this program {_shown(package, ours.get(package))};"
        f" {_remedy(package, ours.get(package))}"
        for package in packages
        if _leading(package, theirs.get(package)) != _leading(package, ours.get(package))
    ]


def _leading(package: str, version: str | None) -> list[str] | None:
    """The parts of a version that must agree."""
    return None if version is None else version.split(".")[: COMPARED[package]]


def _shown(package: str, version: str | None) -> str:
    """A package with its version; that of Python is short."""
    name = "Python" if package == "python" else package
    return f"no {name}" if version is None else f"{name} {'.'.join(version.split('.')[:3])}"


def _remedy(package: str, version: str | None) -> str:
    """What to do about a difference."""
    if package == "python":
        return f"start it with Python {'.'.join((version or '').split('.')[:2])}."
    return f"install {package} {version} there." if version else f"install {package} here, or remove it there."
