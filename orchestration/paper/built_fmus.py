"""Finds the FMU files of the paper's scenarios, and builds those that are not in the cache."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from orchestration.errors import OrchestrationError, UnknownNameError
from orchestration.fmi.names import suggestion
from orchestration.paper.scenarios import ALL_SCENARIOS, Scenario

if TYPE_CHECKING:
    from adaptimp_fmu import Model, Platform


def find_scenario(name: str) -> Scenario:
    """Return the models and the numbers of a scenario by its name, such as ``fig5``.

    Raises
    ------
    UnknownNameError
        If there is no such scenario; the message gives near names.
    """
    if name not in ALL_SCENARIOS:
        msg = f"There is no scenario {name}; {suggestion(name, ALL_SCENARIOS)}"
        raise UnknownNameError(msg)
    return ALL_SCENARIOS[name]


def fmus(identifiers: Iterable[str], *, reals: bool = False) -> Mapping[str, Path]:
    """FMU files for this machine by model identifier; those that are not in the cache are built."""
    return {identifier: built(identifier, reals=reals) for identifier in dict.fromkeys(identifiers)}


def built(identifier: str, *, reals: bool = False) -> Path:
    """The FMU file for this machine of a model identifier; errors are those of `built_model`."""
    from fmus.catalog import model

    return built_model(model(identifier), reals=reals)


def built_model(
    model: "Model",
    folder: Path | None = None,
    platforms: "Iterable[Platform] | None" = None,
    *,
    reals: bool = False,
) -> Path:
    """The FMU file of a model; the arguments are those of `adaptimp_fmu.build`.

    Raises
    ------
    OrchestrationError
        If the model is incomplete, or the compiler or the cache fails.
    """
    from adaptimp_fmu import DefinitionError, ToolchainError, build

    try:
        return build(model, folder, platforms, reals=reals)
    except (DefinitionError, ToolchainError, OSError) as error:
        msg = f"{model.name}.fmu cannot be built: {error}"
        raise OrchestrationError(msg) from error
