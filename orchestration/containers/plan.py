"""What a program of a system is made of: FMUs, components, variables, links and their order. No text, no file.

    inner step k:  t = start + k step
      gauss-seidel   for each component: its inputs are copied, it steps
      jacobi         all inputs are copied; every component steps

as the master does; see `orchestration.master.algorithm`.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from adaptimp_fmu.variables import range_in_words, whole_range_in_words
from orchestration.containers.c_text import identifier
from orchestration.containers.contained.contained_fmu import ContainedFmu, document_of
from orchestration.containers.contained.containment import contained_fmu
from orchestration.containers.initial_order import Pass, initial_dependencies, initial_order
from orchestration.errors import ContainerError
from orchestration.fmi.codes import BOOLEAN, INTEGER, ONE_INSTANCE, STRING
from orchestration.fmi.description import SAMPLE_TIME, Variable
from orchestration.fmi.document import Declared
from orchestration.fmi.units import Linear
from orchestration.master.algorithm import ALGORITHMS, Algorithm, find_algorithm
from orchestration.sandbox.archive import file_hash
from orchestration.system.system import Component, Connection, System

GAUSS_SEIDEL, JACOBI = "gauss-seidel", "jacobi"
FIXED, TUNABLE, INPUT, OUTPUT = "FIXED_PARAMETER", "TUNABLE_PARAMETER", "INPUT", "OUTPUT"
"""Roles of variables, by the ends of their names in C."""


@dataclass(frozen=True)
class Member:
    """A component of the program.

    Attributes
    ----------
    component
        Component of the system.
    field
        C identifier of its state in the state of the system.
    fmu
        FMU that it is an instance of.
    period
        Its parameter ``sample_time``; None if it is not sampled.
    """

    component: Component
    field: str
    fmu: ContainedFmu
    period: Variable | None

    @property
    def name(self) -> str:
        """Name of the component in the system."""
        return self.component.name

    def place(self, variable: str) -> int:
        """Return the index of a variable in the values of the component's state."""
        return self.fmu.places[self.component.variable(variable).fmu_name]


@dataclass(frozen=True)
class ProgramVariable:
    """A variable that the program shows: a parameter, an input without a source, or an output.

    Attributes
    ----------
    path
        Name as ``component.variable``.
    member, place
        Index of the component in the program, and index in its values.
    variable, declared
        The variable in the system, and all that the FMU says of it.
    role
        `FIXED`, `TUNABLE`, `INPUT` or `OUTPUT`.
    start
        Start value in force, in the unit of the FMU; 0 of an output.
    minimum, maximum
        Closed range, infinite where there is no bound.
    range
        The range in words, such as ``at least 0 N/m``.
    """

    path: str
    member: int
    place: int
    variable: Variable
    declared: Declared
    role: str
    start: float
    minimum: float
    maximum: float
    range: str


@dataclass(frozen=True)
class Link:
    """A connection between places in memory; `source` and `target` are indices of components."""

    source: int
    source_place: int
    target: int
    target_place: int
    type: str
    scale: Linear
    connection: Connection


@dataclass(frozen=True)
class Plan:
    """A system as one program.

    Attributes
    ----------
    system, identifier
        The system, and its name as a C identifier.
    algorithm
        `GAUSS_SEIDEL` or `JACOBI`.
    step
        Inner step, s.
    fmus
        FMUs, each once.
    members
        Components in the order of stepping.
    variables
        All parameters, then the unconnected inputs, then all outputs; the index is the value reference of each form.
    links
        Connections in the order of the components that take the values.
    initialization
        Passes of the initialization, in their order.
    """

    system: System
    identifier: str
    algorithm: str
    step: float
    fmus: tuple[ContainedFmu, ...]
    members: tuple[Member, ...]
    variables: tuple[ProgramVariable, ...]
    links: tuple[Link, ...]
    initialization: tuple[Pass, ...]

    @property
    def foreign(self) -> list[Member]:
        """Components whose FMUs are of other tools, so that their states are not plain data."""
        return [member for member in self.members if not member.fmu.plain]

    @property
    def saves(self) -> bool:
        """Whether the states of all components can be saved and restored."""
        return all(member.fmu.plain or member.fmu.saves for member in self.members)

    @property
    def serializes(self) -> bool:
        """Whether the states of all components are plain data, which mean the same in another process."""
        return not self.foreign

    def with_role(self, *roles: str) -> list[ProgramVariable]:
        """Variables of the given roles, in their order."""
        return [variable for variable in self.variables if variable.role in roles]

    def links_to(self, member: int) -> list[Link]:
        """Links whose values a component takes."""
        return [link for link in self.links if link.target == member]

    def takes_tested_values(self, fmu: ContainedFmu) -> bool:
        """Whether every linked input of an FMU's components is an output, unscaled, that was found to be finite.

        A linked input that stands for a Boolean or an Integer must be an output that stands for the same.
        """
        links = [link for link in self.links if self.members[link.target].fmu is fmu]
        return all(
            link.scale.trivial and self.members[link.source].fmu.tests_outputs and self._stands_for_the_same(link)
            for link in links
        )

    def _stands_for_the_same(self, link: Link) -> bool:
        source, target = self.members[link.source].component, self.members[link.target].component
        ends = source.variable(link.connection.output), target.variable(link.connection.input)
        return ends[1].stands_for in ("", ends[0].stands_for)


def plan_of(system: System, algorithm: str | Algorithm = GAUSS_SEIDEL) -> Plan:
    """Plan a program of a system.

    Parameters
    ----------
    system
        System with a step; its components in the order of stepping, and its start values, become a part of the program.
    algorithm
        ``gauss-seidel`` or ``jacobi``.

    Raises
    ------
    ContainerError
        If an FMU does not bring the sources that a program needs, outputs depend on each other in a cycle, or the
        algorithm is another one.
    SystemDescriptionError
        If the system has no step, or a sampling period is not a multiple of it.
    """
    chosen = _fixed_step(system, algorithm)
    step = system.run_step()
    system.steps_per_tick(step)
    name = identifier(system.name, (), "system")
    fmus = _fmus(system, name)
    members = _members(system, fmus)
    return Plan(
        system,
        name,
        chosen,
        step,
        tuple({fmu.name: fmu for fmu in fmus.values()}.values()),
        members,
        _variables(system, members),
        _links(system, members),
        initial_order(system, _dependencies(members)),
    )


def _fixed_step(system: System, algorithm: str | Algorithm) -> str:
    """Return the name of an algorithm of fixed steps, and refuse all others."""
    chosen = find_algorithm(algorithm)
    for name in (GAUSS_SEIDEL, JACOBI):
        if chosen == ALGORITHMS[name]:
            return name
    msg = f"System {system.name}: a program cannot step with {chosen.name}; choose {GAUSS_SEIDEL} or {JACOBI}."
    raise ContainerError(msg)


def _fmus(system: System, name: str) -> dict[str, ContainedFmu]:
    """The FMU of each component, by the component's name; equal files are one FMU unless it has one instance only."""
    by_content: dict[tuple[str, str], ContainedFmu] = {}
    found = {}
    for component in system.components:
        alone = component.name if component.description.can(ONE_INSTANCE) else ""
        key = (file_hash(component.path), alone)
        if key not in by_content:
            by_content[key] = contained_fmu(component, {name, *(fmu.name for fmu in by_content.values())})
        found[component.name] = by_content[key]
    return found


def _members(system: System, fmus: Mapping[str, ContainedFmu]) -> tuple[Member, ...]:
    taken = ["run"]  # the system's own place in its state
    members = []
    for component in system.components:
        place = identifier(component.name, taken, "component")
        taken.append(place)
        sampled = component.sample_time is not None
        period = component.variable(SAMPLE_TIME) if sampled else None
        members.append(Member(component, place, fmus[component.name], period))
    return tuple(members)


def _variables(system: System, members: Sequence[Member]) -> tuple[ProgramVariable, ...]:
    found = []
    for number, member in enumerate(members):
        for variable in member.component.description.variables.values():
            role = _role(system, member.component, variable)
            if role and variable.fmu_name in member.fmu.places:
                found.append(_variable(number, member, variable, role))
    groups = ((FIXED, TUNABLE), (INPUT,), (OUTPUT,))
    return tuple(variable for group in groups for variable in found if variable.role in group)


def _role(system: System, component: Component, variable: Variable) -> str:
    """Role of a variable in the program; empty if the program does not show it."""
    if variable.type == STRING:
        return ""
    if variable.causality == "parameter":
        return TUNABLE if variable.variability == "tunable" else FIXED
    if variable.causality == "input":
        return "" if f"{component.name}.{variable.name}" in system.sources else INPUT
    if variable.causality == "output":
        return OUTPUT
    return FIXED if variable.can_start and variable.name in component.start else ""


def _variable(number: int, member: Member, variable: Variable, role: str) -> ProgramVariable:
    declared = member.fmu.declared[variable.fmu_name]
    low, high = declared.limits
    minimum, maximum = -math.inf if low is None else low, math.inf if high is None else high
    start = 0.0 if role == OUTPUT else float(member.component.start.get(variable.name, variable.start or 0.0))
    return ProgramVariable(
        f"{member.name}.{variable.name}",
        number,
        member.fmu.places[variable.fmu_name],
        variable,
        declared,
        role,
        start,
        minimum,
        maximum,
        whole_range_in_words(minimum, maximum)
        if variable.stands_for
        else range_in_words(minimum, maximum, variable.unit),
    )


def _links(system: System, members: Sequence[Member]) -> tuple[Link, ...]:
    number = {member.name: i for i, member in enumerate(members)}
    for c in system.connections:
        if system.component(c.source).variable(c.output).type == STRING:
            msg = f"Connection {c}: a program has no Strings; remove the connection, or run the system as it is."
            raise ContainerError(msg)
    links = [
        Link(
            number[c.source],
            members[number[c.source]].place(c.output),
            number[c.target],
            members[number[c.target]].place(c.input),
            system.component(c.source).variable(c.output).type,
            c.scale,
            c,
        )
        for c in system.connections
    ]
    return tuple(sorted(links, key=lambda link: (link.target, link.target_place)))


def _dependencies(members: Sequence[Member]) -> dict[str, dict[str, list[str]]]:
    """Inputs that each output depends on during initialization, by component and output, by names in the system."""
    found = {}
    for member in members:
        ours = {v.fmu_name: v.name for v in member.component.description.variables.values()}
        declared = initial_dependencies(document_of(member.fmu.path))
        found[member.name] = {ours[output]: [ours[i] for i in inputs] for output, inputs in declared.items()}
    return found


__all__ = ["BOOLEAN", "INTEGER", "Link", "Member", "Plan", "ProgramVariable", "plan_of"]
