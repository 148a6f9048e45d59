"""Finds the FMU files of the paper's scenarios: carried by the wheel, in the cache, or built now."""

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
    """FMU files by model identifier; those that are neither carried by the wheel nor in the cache are built."""
    return {identifier: built(identifier, reals=reals) for identifier in dict.fromkeys(identifiers)}


def built(identifier: str, *, reals: bool = False) -> Path:
    """The FMU file of a model identifier.

    The wheel carries it for all platforms, unless the definitions have changed since. With Reals, it is built.

    Raises
    ------
    OrchestrationError
        If a carried file was changed, or as of `built_model`.
    MissingPartError
        If the FMU must be built, and the part ``build`` is not installed.
    """
    from adaptimp_fmu.files.parts import MissingPartError
    from fmus.carried import ChangedFileError, carried_fmu, why_not_carried
    from fmus.catalog import model

    try:
        carried = None if reals else carried_fmu(identifier)
    except ChangedFileError as error:
        raise OrchestrationError(str(error)) from error
    if carried is not None:
        return carried
    try:
        return built_model(model(identifier), reals=reals)
    except MissingPartError as error:
        why = why_not_carried(identifier) or f"The wheel does not carry {identifier}.fmu with Reals only."
        raise MissingPartError(str(error.name), error.part, f"{why} Building it") from error


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
