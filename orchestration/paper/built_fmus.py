"""FMU files for the paper's scenarios, built when they are not there yet."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from orchestration.errors import OrchestrationError, SystemDescriptionError
from orchestration.paper.scenarios import SCENARIOS, Scenario

if TYPE_CHECKING:
    from adaptimp_fmu import Model, Platform


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
    return {identifier: built(identifier) for identifier in dict.fromkeys(identifiers)}


def built(identifier: str) -> Path:
    """One unit's FMU for this machine, from the cache or built now; raises as `built_model`."""
    from fmus.catalog import MODELS

    return built_model(MODELS[identifier]())


def built_model(model: "Model", folder: Path | None = None, platforms: "Iterable[Platform] | None" = None) -> Path:
    """A model's FMU; arguments as those of `adaptimp_fmu.build`.

    Raises
    ------
    OrchestrationError
        If the model is incomplete, or the compiler or the cache fails.
    """
    from adaptimp_fmu import DefinitionError, ToolchainError, build

    try:
        return build(model, folder, platforms)
    except (DefinitionError, ToolchainError, OSError) as error:
        msg = f"{model.name}.fmu cannot be built: {error}"
        raise OrchestrationError(msg) from error
