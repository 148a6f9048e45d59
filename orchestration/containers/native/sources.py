"""The C sources of a system as a native library: the same text whatever the start values and the step are."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from adaptimp_fmu.runtime_files import runtime_sources
from orchestration.containers.c.program import c_sources, compiled_files, counts
from orchestration.containers.c_text import environment, identifier
from orchestration.containers.native.reduction_text import Shown, reduction_text
from orchestration.containers.plan import OUTPUT, Plan, plan_of
from orchestration.errors import ContainerError
from orchestration.fmi.codes import BOOLEAN, INTEGER
from orchestration.fmi.description import SAMPLE_TIME
from orchestration.fmi.names import suggestion
from orchestration.results.measures.expression import Reduction
from orchestration.system.system import System

MAIN = "runs.c"
"""The file that is compiled besides the sources of the FMUs; it includes ``step.c``."""
_ANY_PERIOD = 1.0  # s; runs set the periods and the step


@dataclass(frozen=True)
class NativeSources:
    """C sources of a system as a native library.

    Attributes
    ----------
    plan
        Plan of the program. Its start values are those of the FMUs.
    files
        Texts by file name.
    compiled
        Names of the files that are compiled, each alone.
    common
        Start values that are the same in all runs, by ``component.variable``.
    """

    plan: Plan
    files: Mapping[str, str]
    compiled: tuple[str, ...]
    common: Mapping[str, float]


def native_sources(
    system: System,
    algorithm: str,
    varied: Sequence[str],
    reductions: Sequence[Reduction],
    record: Sequence[str],
) -> NativeSources:
    """Write a system as C for many runs.

    Raises
    ------
    ContainerError
        If the system cannot be a native library, or does not show a variable that is varied, reduced or recorded.
    """
    plan = _plan(system, algorithm)
    common = _common(system, varied)
    places = {variable.path: i for i, variable in enumerate(plan.variables)}
    for path in varied:
        _require_settable(plan, places, path)
    reduced = reduction_text(reductions, lambda path: _shown(plan, places, path))
    given = {
        "id": plan.identifier,
        "system": plan.system.name,
        "counts": counts(plan),
        "varied": [places[path] for path in varied],
        "recorded": [_shown(plan, places, path).text for path in record],
        "reduced": reduced.values,
        "begin": reduced.begin,
        "at_rows": reduced.at_rows,
        "before_steps": reduced.before_steps,
        "behind_steps": reduced.behind_steps,
        "end": reduced.end,
    }
    files = c_sources(plan, variable_step=True)
    files["real_numbers.h"] = runtime_sources()["real_numbers.h"]
    files[MAIN] = environment().get_template(f"{MAIN}.j2").render(given)
    compiled = (MAIN, *(name for name in compiled_files(plan) if name != "step.c"))
    return NativeSources(plan, files, compiled, common)


def _plan(system: System, algorithm: str) -> Plan:
    """Plan a program whose text does not depend on the name, the start values and the step of a system."""
    periods = {
        component.name: {SAMPLE_TIME: _ANY_PERIOD}
        for component in system.components
        if component.sample_time is not None
    }
    components = tuple(replace(component, start=periods.get(component.name, {})) for component in system.components)
    plan = plan_of(replace(system, components=components, step=_ANY_PERIOD, assumptions={}), algorithm)
    if plan.foreign:
        names = ", ".join(f"{member.name}: {member.fmu.path.name}" for member in plan.foreign)
        msg = f"{names} cannot be a part of a native library, since other tools made it; run the system by the master."
        raise ContainerError(msg)
    name = identifier("native", (fmu.name for fmu in plan.fmus))
    return replace(plan, system=replace(plan.system, name="a system"), identifier=name)


def _common(system: System, varied: Sequence[str]) -> dict[str, float]:
    """Start values of the system that no run varies, and all sampling periods."""
    sampled = {f"{name}.{SAMPLE_TIME}": period for name, period in system.sample_times.items()}
    given = {
        f"{component.name}.{name}": value for component in system.components for name, value in component.start.items()
    }
    chosen = set(varied) | set(system.sources)
    return {path: float(value) for path, value in {**sampled, **given}.items() if path not in chosen}


def _require_settable(plan: Plan, places: Mapping[str, int], path: str) -> None:
    """Refuse to vary what the program does not let a run set."""
    if path in plan.system.sources:
        msg = f"{path} takes its value from {plan.system.sources[path]}; vary a parameter or an input without a source."
        raise ContainerError(msg)
    if path not in places or plan.variables[places[path]].role == OUTPUT:
        component, variable = plan.system.resolve(path)
        what = f"a {variable.type} of causality {variable.causality}"
        msg = f"{path} of {component.path.name} is {what}, which a native library cannot vary; vary a parameter."
        raise ContainerError(msg)


def _shown(plan: Plan, places: Mapping[str, int], path: str) -> Shown:
    """A variable as C that reads it as FMI's functions do."""
    if path not in places:
        known = list(places)
        msg = f"A native library shows no {path}, but outputs, parameters and inputs; {suggestion(path, known)}"
        raise ContainerError(msg)
    variable = plan.variables[places[path]]
    member = plan.members[variable.member]
    text = f"s->{member.field}.values[{variable.place}]"
    if variable.variable.type == BOOLEAN:
        text = f"({text} < 0 || {text} > 0 ? 1.0 : 0.0)"
    elif variable.variable.type == INTEGER:
        text = f"(double)(int32_t){text}"
    return Shown(text, member.period is not None)
