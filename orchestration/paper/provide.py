"""FMU files for the paper's scenarios, built when they are not there yet."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from orchestration.errors import SystemDescriptionError
from orchestration.paper.scenarios import SCENARIOS, Scenario


def scenario(name: str) -> Scenario:
    """A scenario by name.

    Raises
    ------
    SystemDescriptionError
        Listing the known names.
    """
    if name not in SCENARIOS:
        msg = f"There is no scenario {name}; there are {', '.join(SCENARIOS)}."
        raise SystemDescriptionError(msg)
    return SCENARIOS[name]


def fmus(identifiers: Iterable[str]) -> Mapping[str, Path]:
    """FMU files by model identifier, for this machine, from the cache or built now."""
    from adaptimp_fmu import build
    from fmus.catalog import UNITS

    return {identifier: build(UNITS[identifier]()) for identifier in dict.fromkeys(identifiers)}
