"""A system of FMUs that are simulated together: components, start values, and connections between variables.

A `System` is a value: its methods return changed copies. A system that exists was checked, so it can be run.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from orchestration.fmi.description import SAMPLE_TIME, Variable
from orchestration.fmi.given import a_path, positive, require_type
from orchestration.system.component import Component, Connection, require_settable, spread, start_value
from orchestration.system.display import system_html, system_line
from orchestration.system.programs import Programs
from orchestration.system.refused import no_component, not_a_path, require_names, require_order, required_time
from orchestration.system.registry import analysis, reader, writer
from orchestration.system.replacement import replaced
from orchestration.system.sampling import steps_per_tick
from orchestration.system.wiring import by_equal_names, checked_connections, parsed

if TYPE_CHECKING:
    from orchestration.analysis.stability.verdict import Verdict
    from orchestration.master.algorithm import Algorithm

__all__ = ["Component", "Connection", "System"]


@dataclass(frozen=True, repr=False)
class System(Programs):
    """A set of components and the connections between them, which a master runs together.

    Attributes
    ----------
    step, stop_time
        Communication step and stop time of a run that does not ask for others, s. If a system has None, every run
        must give its own. The default experiments of the FMUs are not used, because an FMU does not know the
        components that it is coupled with. An SSP package has a default experiment of its own.
    notices
        Sentences that the user should know about the making of the system, for example dropped connections. A
        comparison of systems ignores notices.
    assumptions
        Sentences about values that were assumed, by ``component.variable``. SSP packages keep them.
    start_time
        Time of row 0 of a run that does not ask for another, s.

    Examples
    --------
    >>> from orchestration import System, scenario
    >>> system = scenario("fig2").set({"controller.K": [4000.0, 2000.0]})
    >>> list(system), system["controller"]["K"].tolist()
    (['trajectory', 'sensor', 'controller', 'actuator', 'plant'], [4000.0, 2000.0])
    >>> System.read(system.write("mine.ssp")).connections == system.connections
    True

    What a system consists of, and what a run would take:

    >>> system.component("plant") is system["plant"], system.elements("plant.x")
    (True, ['plant.x[1]', 'plant.x[2]'])
    >>> system.elementwise({"plant.m": [2.0, 1.5]}), system.resolve("plant.m[1]")[1].unit
    ({'plant.m[1]': 2.0, 'plant.m[2]': 1.5}, 'kg')
    >>> system.sources["plant.tau[1]"], system.unconnected_inputs(), system.sample_times["sensor"]
    ('actuator.tau[1]', [], 0.0001)
    >>> system.run_step(), system.run_stop_time(0.5), system.steps_per_tick(5e-5)["sensor"]
    (0.0001, 0.5, 2)
    >>> late = system.with_sample_time(7e-3).ordered(["plant", "trajectory", "sensor", "controller", "actuator"])
    >>> late.stability(algorithm="jacobi").stable
    False
    >>> files = {"actuator": system["actuator"].path, "plant": system["plant"].path}
    >>> System.connected_by_name("arm", files, step=1e-3)
    <System arm: 2 components (actuator: Actuator, plant: Plant), 2 connections, step 0.001 s>
    """

    name: str
    components: tuple[Component, ...]
    connections: tuple[Connection, ...] = ()
    step: float | None = None
    stop_time: float | None = None
    notices: tuple[str, ...] = field(default=(), compare=False)
    assumptions: Mapping[str, str] = field(default_factory=dict)
    start_time: float = 0.0

    def __post_init__(self) -> None:
        """Check names, connections and start values."""
        names = [component.name for component in self.components]
        require_names(self.name, names)
        for component in self.components:
            for name, value in component.start.items():
                variable = component.variable(name)
                require_settable(component, variable)
                start_value(f"{component.name}.{name}", variable, value)
        for path in self.assumptions:
            self.resolve(path)
        object.__setattr__(self, "connections", checked_connections(self.connections, self.component))

    @classmethod
    def of(cls, fmus: "Mapping[str, str | Path | Component]", name: str = "system") -> "System":
        """Make a system of FMUs, without connections; `connect` adds them.

        Parameters
        ----------
        fmus
            FMU file, or `Component`, by the name that the component gets; their order is the order of stepping.

        Raises
        ------
        ArchiveError
            If a file is no FMI 2.0 co-simulation FMU.
        SystemDescriptionError
            If a name is empty or has a dot.

        Examples
        --------
        >>> from orchestration import System, scenario
        >>> plant = scenario("fig2")["plant"].path  # any FMU of yours
        >>> System.of({"left": plant, "right": plant}, "two arms")
        <System two arms: 2 components (left: Plant, right: Plant), 0 connections>
        """
        require_type("What System.of takes", fmus, Mapping, 'give FMUs by name, as {"plant": "Plant.fmu"}')
        components = [
            replace(fmu, name=component) if isinstance(fmu, Component) else Component.read(fmu, component)
            for component, fmu in fmus.items()
        ]
        return cls(name, tuple(components))

    @classmethod
    def connected_by_name(
        cls,
        name: str,
        fmus: Mapping[str, Path],
        *,
        step: float | None = None,
        stop_time: float | None = None,
    ) -> "System":
        """Make a system from FMU files and connect every input to the output of the same name.

        Parameters
        ----------
        fmus
            FMU files by component name, in the order of the components.
        step, stop_time
            Communication step and stop time of runs that do not ask for others, s.

        Raises
        ------
        SystemDescriptionError
            If two components have an output of the same name that an input could take.
        """
        components = tuple(Component.read(path, component) for component, path in fmus.items())
        connections = by_equal_names(components)
        return cls(name, components, tuple(connections), step, stop_time)

    @classmethod
    def read(cls, path: str | Path, variant: str | None = None) -> "System":
        """Read a system from an SSP package, from a folder with the files of one, or from an .ssd file.

        Parameters
        ----------
        path
            The package, folder or file.
        variant
            Name of an .ssd file in the package, without its suffix. Default: ``SystemStructure``.

        Raises
        ------
        ArchiveError
            If the package is unsafe, incomplete or invalid.
        SystemDescriptionError
            If the package describes a system that cannot be run here, or has no such variant.
        """
        file = a_path("A system's file", path)
        return reader(file)(file, variant)

    def write(self, path: str | Path) -> Path:
        """Write the system to a file, such as an SSP package; see `orchestration.system.registry`."""
        file = a_path("A system's file", path)
        return writer(file)(self, file)

    def connect(self, *connections: str | Connection) -> "System":
        """Add connections from outputs to inputs.

        Parameters
        ----------
        connections
            ``"source.output -> target.input"`` each; scalars, or whole arrays of the same number of elements. A
            `Connection` may scale its value. Without any, all inputs that have no source are connected to the
            outputs of the same name.

        Raises
        ------
        SystemDescriptionError
            If a name is unknown, types or physical dimensions differ, or an input has a source already.

        Examples
        --------
        >>> from orchestration import System, scenario
        >>> fig2 = scenario("fig2")
        >>> system = System.of({"actuator": fig2["actuator"], "plant": fig2["plant"]})
        >>> print(*system.connect("actuator.tau -> plant.tau").connections)
        actuator.tau[1] -> plant.tau[1] actuator.tau[2] -> plant.tau[2]
        """
        added = [c for line in connections for c in parsed(line, self._by_name)]
        if not connections:
            added = by_equal_names(self.components, self.connections)
        return replace(self, connections=(*self.connections, *added))

    def __getitem__(self, name: str) -> Component:
        """A component by name; see `component`."""
        return self.component(name)

    def __contains__(self, name: object) -> bool:
        """Whether there is a component of that name."""
        return isinstance(name, str) and name in self._by_name

    def __iter__(self) -> Iterator[str]:
        """Names of the components, in the order of stepping."""
        return (component.name for component in self.components)

    def __repr__(self) -> str:
        """Name, components with their models, and number of connections."""
        return system_line(self)

    def _repr_html_(self) -> str:
        return system_html(self)

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)

    def component(self, name: str) -> Component:
        """Return the component of a name.

        Raises
        ------
        SystemDescriptionError
            If there is no such component; the message gives near names.
        """
        if name in self:
            return self._by_name[name]
        raise no_component(self.name, name, list(self))

    def set(self, values: "Mapping[str, float | bool | str | Sequence[float] | Sequence[str]]") -> "System":
        """Return the system with other start values.

        A value that differs from an assumed value is no longer marked as assumed.

        Parameters
        ----------
        values
            By ``component.variable``. An array takes one number for all of its elements, or one number for each.

        Raises
        ------
        SystemDescriptionError
            If a name is unknown, the variable cannot be set, or the value does not have the variable's type.

        Examples
        --------
        >>> from orchestration import scenario
        >>> system = scenario("fig2").set({"controller.K": 2000.0, "plant.m": [2.5, 1.2]})  # N/m, kg
        >>> system["controller"]["K"].tolist(), system["plant"]["m"].tolist()
        ([2000.0, 2000.0], [2.5, 1.2])
        """
        require_type("What set takes", values, Mapping, 'give values by name, as {"plant.K_f": 1e5}')
        changed: dict[str, dict[str, float | str]] = {}
        for path, value in self.elementwise(values).items():
            component, variable = self.resolve(path)
            require_settable(component, variable)
            changed.setdefault(component.name, {})[variable.name] = start_value(path, variable, value)
        components = tuple(replace(c, start={**c.start, **changed.get(c.name, {})}) for c in self.components)
        before = {f"{c.name}.{name}": value for c in self.components for name, value in c.start.items()}
        given = {f"{c}.{name}": value for c, of_component in changed.items() for name, value in of_component.items()}
        kept = {path: text for path, text in self.assumptions.items() if given.get(path) in (None, before.get(path))}
        return replace(self, components=components, assumptions=kept)

    def elementwise(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """The same values by ``component.variable``, those of arrays for each element."""
        found: dict[str, Any] = {}
        for path, value in values.items():
            elements = self.elements(path)
            values_of = [value] if elements == [path] else spread(path, value, elements)
            found |= dict(zip(elements, values_of, strict=True))
        return found

    def elements(self, path: str) -> list[str]:
        """Return the paths of an array's elements, row by row; the path itself if it does not name an array."""
        name, _, variable = path.partition(".")
        elements = self.component(name).description.elements(variable) if name in self else None
        return [path] if elements is None else [f"{name}.{element}" for element in elements]

    def replace(self, name: str, fmu: str | Path, mapping: Mapping[str, str] | None = None) -> "System":
        """Return the system with another FMU in the place of a component.

        Start values and connections of variables that the new FMU has are kept and converted to its units.
        Connections to inputs that the new FMU lacks are dropped, each with a notice. Further inputs of the new FMU
        are connected to outputs of the same name, each with a notice.

        Parameters
        ----------
        mapping
            Names in the new FMU by names in the system, of scalars or of whole arrays: with
            ``{"tau_cmd": "Torque"}`` the variable ``tau_cmd[1]`` is ``Torque[1]`` of the FMU. The component keeps
            the names of the system, and so do connections, start values and results.

        Raises
        ------
        SystemDescriptionError
            If the new FMU lacks an output that is connected, a mapped name is unknown, or a unit cannot
            be converted.

        Examples
        --------
        >>> from orchestration import scenario
        >>> adaptive = scenario("fig5")["controller"].path  # any controller of yours
        >>> system = scenario("fig2").replace("controller", adaptive)
        >>> system["controller"].description.model_name, len(system.notices)
        ('CraigAdaptiveImpedance', 2)
        """
        return replaced(self, name, a_path("An FMU", fmu), mapping or {})

    def ordered(self, names: Sequence[str]) -> "System":
        """Return the system with its components in another order.

        Raises
        ------
        SystemDescriptionError
            Unless each component is named once.
        """
        require_order(names, list(self))
        return replace(self, components=tuple(self.component(name) for name in names))

    def with_sample_time(self, sample_time: float) -> "System":
        """Return the system with another communication step, s, which is also every ``sample_time``."""
        positive("The sample time", sample_time)
        values = {f"{c.name}.{SAMPLE_TIME}": sample_time for c in self.components if c.sample_time is not None}
        return replace(self.set(values), step=sample_time)

    def run_step(self, asked: float | None = None) -> float:
        """Return the communication step of a run, s: the given one, or else the system's.

        Raises
        ------
        SystemDescriptionError
            If neither the run nor the system has a step.
        """
        return required_time(self.name, self.step if asked is None else asked, "step", "communication step")

    def run_stop_time(self, asked: float | None = None) -> float:
        """Return the stop time of a run, s: the given one, or else the system's.

        Raises
        ------
        SystemDescriptionError
            If neither the run nor the system has a stop time.
        """
        return required_time(self.name, self.stop_time if asked is None else asked, "stop_time", "stop time")

    def stability(
        self, step: float | None = None, algorithm: "str | Algorithm" = "gauss-seidel", *, at: float = 0.0
    ) -> "Verdict":
        """Judge the stability of an algorithm at a step, s, near a time, s; see `orchestration.analysis.stability`."""
        return analysis("stability")(self, step, algorithm, at=at)

    @cached_property
    def _by_name(self) -> Mapping[str, Component]:
        return {component.name: component for component in self.components}

    @property
    def sample_times(self) -> dict[str, float]:
        """Sampling periods of the sampled components, s, by name."""
        periods = {component.name: component.sample_time for component in self.components}
        return {name: float(period) for name, period in periods.items() if period is not None}

    @cached_property
    def sources(self) -> Mapping[str, str]:
        """The output that each connected input takes its value from, by the input; both as ``component.variable``."""
        return {f"{c.target}.{c.input}": f"{c.source}.{c.output}" for c in self.connections}

    def unconnected_inputs(self) -> list[str]:
        """Return the inputs without a source, which keep their start value, as ``component.input``."""
        every = ((c, v) for c in self.components for v in c.description.variables.values())
        return [path for c, v in every if v.causality == "input" and (path := f"{c.name}.{v.name}") not in self.sources]

    def resolve(self, path: str) -> tuple[Component, Variable]:
        """Return the component and the variable that ``component.variable`` names."""
        name, dot, variable = path.partition(".")
        if not dot:
            raise not_a_path(path, self.components)
        component = self.component(name)
        return component, component.variable(variable)

    def steps_per_tick(self, step: float) -> dict[str, int]:
        """Return the number of communication steps per sampling period, by sampled component.

        Raises
        ------
        SystemDescriptionError
            If a period is not an integer multiple of the step.
        """
        return steps_per_tick(self.components, step)
