"""Packs a system into a single FMU with fmu_manipulation_toolbox, to compare the speed of both.

The container steps its FMUs one after the other, in their order, in a C loop of its own; all their
outputs are outputs of the container. It sets start values its own way, so a container whose FMUs have
start values of their own need not start where the system does.
"""

import logging
from pathlib import Path

from orchestration.fmi.codes import REAL, STRING
from orchestration.fmi.description import Variable, read_description
from orchestration.system.system import Component, System

PREFIX = "shown."  # of the outputs; the container has a local variable for each of its links


def contained(system: System, folder: Path) -> System:
    """Pack a system, its start values included.

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
        for name, value in component.start.items():
            node.add_start_value(f"{component.name}.fmu", name, _text(component.variable(name), value))
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


def _text(variable: Variable, value: float | str) -> str:
    """A start value as fmu_manipulation_toolbox wants it."""
    return str(value) if variable.type == STRING else repr(float(value) if variable.type == REAL else int(value))
