"""Contains an FMU of another tool in a program: an adapter calls FMI's functions, which its sources define.

    fmus/NAME.h, NAME.c       the functions of a contained FMU, made of calls of NAME_fmi2DoStep and others
    fmus/NAME.source1.c ...   one file for each source file, which includes it under names of its own
    fmus/NAME/...             the files of the FMU's sources, unchanged

The calls are those of the master: start values before initialization mode, inputs in it, then inputs, fmi2DoStep and
outputs at every step, with one call for each type.
"""

from collections.abc import Iterable, Mapping, Sequence

from orchestration.containers.c_text import environment, identifier
from orchestration.containers.contained.contained_fmu import ContainedFmu, declared_variables
from orchestration.containers.contained.foreign.names import rename
from orchestration.containers.contained.foreign.sources import read_sources
from orchestration.errors import ContainerError
from orchestration.fmi.codes import BOOLEAN, INTEGER, REAL, SAVES_STATE, STRING
from orchestration.fmi.description import Description, Variable
from orchestration.fmi.display import listed
from orchestration.fmi.document import EXACT
from orchestration.sandbox.archive import file_hash
from orchestration.system.component import Component

ARENA = 65536
"""Bytes of the array that replaces calloc for an FMU where there is no C library."""
MOST_NAMES = 4
_C_TYPES = {
    REAL: {"name": REAL, "c": "double", "convert": ""},
    INTEGER: {"name": INTEGER, "c": "int", "convert": "to_integer"},
    BOOLEAN: {"name": BOOLEAN, "c": "int", "convert": "to_boolean"},
}
_ALWAYS = (
    *("fmi2Instantiate", "fmi2FreeInstance", "fmi2SetupExperiment", "fmi2EnterInitializationMode"),
    *("fmi2ExitInitializationMode", "fmi2DoStep", "fmi2Terminate"),
)
_OF_STATES = ("fmi2GetFMUstate", "fmi2SetFMUstate", "fmi2FreeFMUstate")


def foreign_fmu(component: Component, taken: Iterable[str]) -> ContainedFmu:
    """Return the FMU of a component, which another tool has exported with its sources, as a part of a program.

    Parameters
    ----------
    component
        Component whose FMU is contained; messages name it.
    taken
        Identifiers that others have.

    Raises
    ------
    ContainerError
        If the FMU does not bring sources that compile by themselves, or needs what a program lacks.
    ArchiveError
        If the archive is unsafe.
    """
    description, path = component.description, component.path
    name = identifier(description.identifier, taken, "Fmu")
    sources = read_sources(component)
    renamed = rename(component, name, sources)
    variables = _variables(description)
    _require_functions(component, renamed.functions, variables)
    places = {variable.fmu_name: i for i, variable in enumerate(variables)}
    templates, settings = environment(), _settings(description, variables)
    settings["resets"] = settings["saves"] and "fmi2Reset" in renamed.functions
    return ContainedFmu(
        name,
        path,
        file_hash(path),
        description,
        declared_variables(path),
        places,
        header=templates.get_template("foreign.h.j2").render(name=name, **settings),
        source=templates.get_template("foreign.c.j2").render(name=name, **settings),
        sources=sources.files,
        plain=False,
        wrappers=renamed.wrappers,
        needed=tuple(sorted(renamed.needed)),
        fmi_headers=not renamed.own_headers,
        saves=settings["saves"],
    )


def _variables(description: Description) -> list[Variable]:
    """Variables that have a place: what can have a start value, then the other inputs and outputs; no Strings."""
    numbers = [v for v in description.variables.values() if v.type != STRING]
    settable = [v for v in numbers if v.can_start and v.causality != "input"]
    return [*settable, *(v for v in numbers if v.causality in ("input", "output") and v not in settable)]


def _require_functions(component: Component, defined: frozenset[str], variables: Sequence[Variable]) -> None:
    """Refuse sources without the functions that the adapter calls."""
    types = dict.fromkeys(variable.type for variable in variables)
    wanted = [*_ALWAYS, *(f"fmi2{verb}{kind}" for kind in types for verb in ("Get", "Set"))]
    if component.description.can(SAVES_STATE):
        wanted += _OF_STATES
    if component.description.texts("input"):
        wanted.append("fmi2SetString")
    if missing := [function for function in wanted if function not in defined]:
        msg = (
            f"{component.name}: the sources of {component.path.name} do not define {listed(missing, MOST_NAMES)};"
            " a program calls them, so export the FMU with complete sources."
        )
        raise ContainerError(msg)


def _settings(description: Description, variables: Sequence[Variable]) -> dict:
    """What the templates of the adapter are given."""
    place = {variable.name: i for i, variable in enumerate(variables)}
    settable = [v for v in variables if v.can_start and v.causality != "input"]
    inputs = [v for v in variables if v.causality == "input"]
    outputs = [v for v in variables if v.causality == "output"]
    types = [
        {
            **_C_TYPES[kind],
            "given": max(sum(v.type == kind for v in inputs), int(any(v.type == kind for v in settable))),
            "shown": sum(v.type == kind for v in outputs),
            "startable": any(v.type == kind for v in settable),
        }
        for kind in (REAL, INTEGER, BOOLEAN)
        if any(v.type == kind for v in variables)
    ]
    return {
        "model": description.model_name,
        "guid": description.guid,
        "n": max(1, len(variables)),
        "arena": ARENA,
        "starts": [_number(v) for v in variables] or [0.0],
        "startable": [
            {"reference": v.reference, "place": place[v.name], "type": v.type, "last_phase": _last_phase(v)}
            for v in settable
        ],
        "groups": [*_groups("input", inputs, place), *_groups("output", outputs, place)],
        "real_outputs": [v.fmu_name for v in outputs if v.type == REAL],
        "types": types,
        "type_names": [kind["name"] for kind in types if kind["given"]],
        "texts": [v for v in description.texts("input") if v.start is not None],
        "saves": description.can(SAVES_STATE),
        "tolerance": description.experiment.tolerance,
    }


def _groups(role: str, variables: Sequence[Variable], place: Mapping[str, int]) -> list[dict]:
    """Variables of a role by type, as one call of FMI takes them."""
    return [
        {
            "role": role,
            "type": kind,
            "references": [v.reference for v in group],
            "places": [place[v.name] for v in group],
        }
        for kind in (REAL, INTEGER, BOOLEAN)
        if (group := [v for v in variables if v.type == kind])
    ]


def _number(variable: Variable) -> float:
    return 0.0 if variable.start is None else float(variable.start)


def _last_phase(variable: Variable) -> str:
    """The last phase of an instance in which a variable can be set (FMI 2.0.5, section 4.2.4)."""
    if variable.causality == "parameter" and variable.variability == "tunable":
        return "STEPPING"
    return "INITIALIZATION" if variable.initial == EXACT else "INSTANTIATED"
