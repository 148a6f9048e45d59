"""Sets parameters and inputs of components while a run is under way."""

from collections.abc import Collection, Mapping, Sequence

from orchestration.fmi.instance import Instance
from orchestration.master.capabilities import require_settable_in_run
from orchestration.master.changes import require_free
from orchestration.master.initialization import set_values
from orchestration.system.system import System


def set_in_run(
    system: System,
    instances: Sequence[Instance],
    values: Mapping[str, float | bool | str | Sequence[float]],
    driven: Collection[str],
) -> dict[str, float | str]:
    """Set values by ``component.variable``; returns them as the components took them, scalar by scalar.

    Parameters
    ----------
    driven
        Inputs that take their values from time series.

    Raises
    ------
    SystemDescriptionError
        If a name or value is wrong, or the variable cannot be set during a run.
    SimulationError
        If a component refuses.
    """
    values = system.elementwise(values)
    require_settable_in_run(system, values)
    require_free(values, driven)
    changed = System("_", system.components).set(values)
    taken: dict[str, float | str] = {}
    for component, before, instance in zip(changed.components, system.components, instances, strict=True):
        named = [name.partition(".")[2] for name in values if name.partition(".")[0] == component.name]
        set_values(before, instance, {name: component.start[name] for name in named})
        taken |= {f"{component.name}.{name}": component.start[name] for name in named}
    return taken
