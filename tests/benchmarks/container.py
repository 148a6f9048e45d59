"""A system packed into one FMU by fmu_manipulation_toolbox, and the system of that one FMU.

The container steps its FMUs one after the other, in their order, in a C loop of its own; all their
outputs are outputs of the container.
"""

import logging
from pathlib import Path

from orchestration.fmi.description import read_description
from orchestration.system.system import Component, System

PREFIX = "shown."  # of the outputs; the container has a local variable for each of its links


def contained(system: System, folder: Path) -> System:
    """Pack a system whose FMUs have no start values of their own.

    Parameters
    ----------
    folder
        Where ``container.fmu`` is written.
    """
    from fmu_manipulation_toolbox.assembly import AssemblyNode, Port

    logging.getLogger("fmu_manipulation_toolbox").setLevel(logging.CRITICAL)  # an open input is no news
    node = AssemblyNode(
        "container.fmu",
        step_size=system.run_step(),
        sequential=True,
        auto_link=False,
        auto_input=False,
        auto_output=False,
    )
    for component in system.components:
        node.add_fmu(f"{component.name}.fmu", str(component.description.path))
    for c in system.connections:
        node.add_link(f"{c.source}.fmu", c.output, f"{c.target}.fmu", c.input)
    for component in system.components:
        for variable in component.description.of_causality("output"):
            node.output_ports[Port(f"{component.name}.fmu", variable.name)] = (
                f"{PREFIX}{component.name}.{variable.name}"
            )
    node.make_fmu(folder)
    packed = Component("container", read_description(folder / "container.fmu"))
    return System(f"{system.name}-container", (packed,), step=system.step, stop_time=system.stop_time)
