"""Says why an FMU cannot take the place of a component: which outputs are missing, and which FMUs have them."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from orchestration.errors import OrchestrationError, SystemDescriptionError
from orchestration.fmi.description import Description, read_description
from orchestration.fmi.display import listed
from orchestration.fmi.names import base_name
from orchestration.system.component import Component

if TYPE_CHECKING:
    from orchestration.system.system import System

MOST_READ = 40
"""How many FMUs of a folder are looked at, in the order of their names."""


def require_outputs(system: "System", new: Component) -> None:
    """Refuse an FMU that lacks outputs which other components of the system read.

    Parameters
    ----------
    new
        The FMU with the name of the component that it shall replace.

    Raises
    ------
    SystemDescriptionError
        Naming a missing output, who reads it, what the FMU has instead, and FMUs beside it that have the output.
    """
    readers = {c.output: c.target for c in system.connections if c.source == new.name}
    missing = [output for output in readers if output not in new.description.variables]
    if not missing:
        return
    output = base_name(missing[0])
    outputs = [v.name for v in new.description.of_causality("output")]
    if parts := [name for name in outputs if base_name(name) == output]:
        n = sum(base_name(name) == output for name in readers)
        msg = (
            f"{new.description.path.name} cannot be {new.name}: it has no output {missing[0]}, which"
            f" {readers[missing[0]]} reads, but {listed(parts)}; declare {output} as an array of {n} elements."
        )
        raise SystemDescriptionError(msg)
    kin = [c.name for c in system.components if c.name != new.name and _alike(c.description, new.description)]
    looks = f" looks like {kin[0]}, not like {new.name}:" if kin else f" cannot be {new.name}:"
    has = listed(list(dict.fromkeys(map(base_name, outputs))))
    fitting = _beside(new.description, missing)
    advice = f"use one such as {listed(fitting)}" if fitting else f"map the name of an output of the FMU to {output}"
    msg = (
        f"{new.description.path.name}{looks} it has no output {output}, which {readers[missing[0]]} reads,"
        f" but {has}; {advice}."
    )
    raise SystemDescriptionError(msg)


def _alike(known: Description, new: Description) -> bool:
    """Whether an FMU has all outputs of another one."""
    outputs = {variable.name for variable in known.of_causality("output")}
    return bool(outputs) and outputs <= {variable.name for variable in new.of_causality("output")}


def _beside(description: Description, outputs: Iterable[str]) -> list[str]:
    """Names of FMUs in the same folder that have all of the outputs."""
    found = []
    for path in sorted(description.path.parent.glob("*.fmu"))[:MOST_READ]:
        try:
            other = read_description(path)
        except OrchestrationError:  # whatever is wrong with it, it is no help
            continue
        if {*outputs} <= {variable.name for variable in other.of_causality("output")}:
            found.append(path.name)
    return found
