"""What a shell offers when the user presses the tabulator key: names of systems, algorithms, controllers, variables.

Nothing is built and no FMU is run for a completion. A file that cannot be read offers nothing.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

FILES = (".fmu", ".ssp", ".ssd")
RESULTS = (".csv", ".parquet")
STUDIES = (".toml",)


def systems(incomplete: str) -> list[str]:
    """Scenarios, and files that can be run."""
    from orchestration.paper.scenarios import ALL_SCENARIOS

    return _beginning(incomplete, [*ALL_SCENARIOS, *_files(incomplete, FILES)])


def studies(incomplete: str) -> list[str]:
    """Systems, and files of studies."""
    return [*systems(incomplete), *_beginning(incomplete, _files(incomplete, STUDIES))]


def measures(incomplete: str) -> list[str]:
    """Ready measures."""
    from orchestration.campaigns.measuring.registry import ready_measures

    return _beginning(incomplete, ready_measures())


def ready_studies(incomplete: str) -> list[str]:
    """Ready studies of the paper."""
    from orchestration.paper.studies.ready import READY_STUDIES

    return _beginning(incomplete, READY_STUDIES)


def controllers(incomplete: str) -> list[str]:
    """Models of shipped controllers and their variants, and FMU files."""
    from fmus.catalog import VARIANTS
    from orchestration.paper.scenarios import ALL_SCENARIOS

    shipped = dict.fromkeys(s.models["controller"] for s in ALL_SCENARIOS.values())
    variants = [name for name in VARIANTS if any(name.startswith(controller) for controller in shipped)]
    return _beginning(incomplete, [*shipped, *variants, *_files(incomplete, FILES[:1])])


def kinds(incomplete: str) -> list[str]:
    """What ``adaptimp new`` can begin."""
    return _beginning(incomplete, ["controller"])


def laws(incomplete: str) -> list[str]:
    """Laws that a new controller can begin with."""
    from orchestration.cli.new_controller import BEGINNINGS

    return _beginning(incomplete, BEGINNINGS)


def cache_actions(incomplete: str) -> list[str]:
    """What ``adaptimp cache`` can do."""
    return _beginning(incomplete, ["clear"])


def cache_kinds(incomplete: str) -> list[str]:
    """Kinds of content of the cache."""
    from adaptimp_fmu.files.cache_contents import KINDS

    return _beginning(incomplete, KINDS)


def subjects(incomplete: str) -> list[str]:
    """All that ``adaptimp info`` can look at."""
    from fmus.catalog import MODELS, VARIANTS

    return [*systems(incomplete), *_beginning(incomplete, [*MODELS, *VARIANTS, *_files(incomplete, RESULTS)])]


def algorithms(incomplete: str) -> list[str]:
    """Algorithms of the master."""
    from orchestration.master.algorithm import ALGORITHMS

    return _beginning(incomplete, ALGORITHMS)


def settable(ctx: Any, incomplete: str) -> list[str]:
    """Parameters and inputs of the system on the line, as COMPONENT.VARIABLE=."""
    paths = _paths(ctx, incomplete, ("parameter", "input"))
    return [path if path.endswith(".") else f"{path}=" for path in paths]


def recordable(ctx: Any, incomplete: str) -> list[str]:
    """Outputs of the system on the line, after those that are named already."""
    before, comma, last = incomplete.rpartition(",")
    return [f"{before}{comma}{path}" for path in _paths(ctx, last, ("output",))]


def _paths(ctx: Any, incomplete: str, causalities: tuple[str, ...]) -> list[str]:
    """Components, or variables of the one that is named."""
    from fmus.carried import ChangedFileError
    from orchestration.errors import OrchestrationError

    component, dot, _ = incomplete.partition(".")
    # The parser gives up at an option whose value is not there yet, and leaves the argument where it was.
    system = ctx.params.get("system") or next(iter(ctx.args), "")
    try:
        found = dict(_components(system, component if dot else None, causalities))
    except (OrchestrationError, OSError, ImportError, ChangedFileError):
        return []
    if not dot:
        return _beginning(incomplete, [f"{name}." for name in found])
    return _beginning(incomplete, [f"{component}.{name}" for name in found.get(component, ())])


def _components(name: str, asked: str | None, causalities: tuple[str, ...]) -> Iterator[tuple[str, list[str]]]:
    """Components of a system with their variables; those of scenarios for one component only, as that takes time."""
    from orchestration.cli.systems import named_system
    from orchestration.paper.scenarios import ALL_SCENARIOS

    if name in ALL_SCENARIOS:
        for component, identifier in ALL_SCENARIOS[name].models.items():
            yield component, _named(_shipped(identifier) if component == asked else {}, causalities)
    elif Path(name).suffix.lower() in FILES:
        for component in named_system(name).components:
            causality = {v.name: v.causality for v in component.description.variables.values()}
            yield component.name, _named(causality, causalities)


def _shipped(identifier: str) -> dict[str, str]:
    """Causality of the variables of a shipped model, by name: of the FMU in the wheel, or of the declaration."""
    from fmus.carried import carried_fmu
    from fmus.catalog import model

    carried = carried_fmu(identifier)
    if carried is None:
        return {v.name: _causality(v.role) for v in model(identifier).variables}
    from orchestration.fmi.description import read_description

    return {v.name: v.causality for v in read_description(carried).variables.values()}


def _causality(role: Any) -> str:
    """Causality in FMI of a role of a model's variable."""
    return "parameter" if role.is_parameter else role.name.lower()


def _named(causality: Mapping[str, str], wanted: tuple[str, ...]) -> list[str]:
    """Arrays and variables of the wanted causalities."""
    from orchestration.fmi.names import arrays

    names = tuple(name for name, found in causality.items() if found in wanted)
    return [*arrays(names), *names]


def _files(incomplete: str, suffixes: tuple[str, ...]) -> list[str]:
    """Files, and folders to look into, whose paths begin with a text."""
    folder, slash, begun = incomplete.rpartition("/")
    place = Path(folder + slash)
    if not place.is_dir():
        return []
    found = [entry for entry in place.iterdir() if entry.name.startswith(begun) and not entry.name.startswith(".")]
    folders = [f"{folder}{slash}{entry.name}/" for entry in found if entry.is_dir()]
    return sorted(f"{folder}{slash}{e.name}" for e in found if e.suffix.lower() in suffixes) + sorted(folders)


def _beginning(incomplete: str, names: Any) -> list[str]:
    return [name for name in names if name.startswith(incomplete)]
