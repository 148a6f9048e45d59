"""Factors: what varies from run to run, by a name, and the start values that it sets."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from orchestration.campaigns.design.ranges import Level
from orchestration.errors import StudyError
from orchestration.fmi.codes import REAL, STRING
from orchestration.fmi.description import SAMPLE_TIME, Variable
from orchestration.fmi.given import require_names, require_type, shown
from orchestration.fmi.names import suggestion
from orchestration.system.component import require_settable, start_value
from orchestration.system.system import System

STEP = "step"
"""Name of the communication step as a factor."""


@dataclass(frozen=True, init=False)
class Factor:
    """What varies from run to run: a name, the start values that it sets, and its values.

    Attributes
    ----------
    name
        Name of the factor in tables.
    variables
        Names of start values as ``component.variable``, arrays allowed: all of them get the same value. Other names are
        ``sample_time``, which is the communication step and the period of each sampled component, and ``step``, which
        is the communication step alone.
    values
        Levels or a distribution, as texts or as sequences; see `orchestration.campaigns.design.ranges`.

    Examples
    --------
    Two gains that go together:

    >>> from orchestration import Factor, Study, scenario
    >>> both = Factor("K", ["controller.K[1]", "controller.K[2]"], "2000:4000:3")  # N/m
    >>> study = Study(scenario("fig2"), measure="max(abs(controller.e[1]))", stop_time=0.2).grid(both)
    >>> study.run()["K"].values.tolist()
    [2000.0, 3000.0, 4000.0]
    >>> both.short, both.bare().values, Factor("plant.K_f", "plant.K_f", [1e4, 1e5]).short
    ('K', None, 'K_f')
    """

    name: str
    variables: tuple[str, ...]
    values: Any = None

    def __init__(self, name: str, variables: str | Sequence[str], values: Any = None) -> None:
        """Check that the name and the variables are texts."""
        require_type("The name of a factor", name, str, 'give a text, such as "K_d"', StudyError)
        require_names(f"factor {name}", variables, "'controller.K'")
        names = (variables,) if isinstance(variables, str) else tuple(variables)
        if not names or not name:
            msg = f"Factor {name}: it has no name or sets no variable; give both."
            raise StudyError(msg)
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "variables", names)
        object.__setattr__(self, "values", values)

    @property
    def short(self) -> str:
        """Last part of the name, such as ``K_f`` of ``plant.K_f``."""
        return self.name.partition(".")[2] or self.name

    def bare(self) -> "Factor":
        """The factor without its values."""
        return Factor(self.name, self.variables)


@dataclass(frozen=True)
class Target:
    """What a factor sets in a system.

    Attributes
    ----------
    factor
        The factor.
    paths
        Scalar start values, as ``component.variable``.
    variables
        The variables of the paths.
    sets_step
        Whether the factor is the communication step.
    names
        What is set, in words for a table: full names, those of arrays included.
    """

    factor: Factor
    paths: tuple[str, ...]
    variables: tuple[Variable, ...]
    sets_step: bool = False
    names: tuple[str, ...] = ()

    @property
    def unit(self) -> str:
        """Unit of the values; empty if there is none, or several."""
        units = {variable.unit for variable in self.variables} | ({"s"} if self.sets_step else set())
        return units.pop() if len(units) == 1 else ""

    @property
    def whole(self) -> bool:
        """Whether all values are whole numbers: of Booleans, Integers and Enumerations."""
        return bool(self.variables) and all(_kind(variable) != REAL for variable in self.variables)

    def numbers(self, levels: Iterable[Level]) -> np.ndarray:
        """Levels as numbers, float64, shape (n,).

        Raises
        ------
        StudyError
            If a step is not positive, or a text is given for it.
        SystemDescriptionError
            If a level does not have the type of a variable.
        """
        found = [self._number(level) for level in levels]
        return self.checked(np.array(found, dtype=np.float64))

    def checked(self, values: np.ndarray) -> np.ndarray:
        """The same values of one column, after a check that all variables can take them.

        Raises
        ------
        StudyError, SystemDescriptionError
            As `numbers`.
        """
        unfit = ~np.isfinite(values)
        if self.sets_step:
            unfit |= values <= 0
        if unfit.any():
            needed = "finite and positive" if self.sets_step else "finite"
            msg = f"Factor {self.factor.name}: run {int(unfit.argmax())} has {values[unfit.argmax()]}; values must be"
            msg = f"{msg} {needed}."
            raise StudyError(msg)
        for path, variable in zip(self.paths, self.variables, strict=True):
            if _kind(variable) != REAL:
                for value in np.unique(values):
                    start_value(path, variable, float(value))
        return values

    def _number(self, level: Level) -> float:
        """A level as a number: items of Enumerations and Booleans by their numbers."""
        found = {start_value(path, v, level) for path, v in zip(self.paths, self.variables, strict=True)}
        if not found and not isinstance(level, str):
            found = {float(level)}
        if len(found) != 1 or isinstance(number := found.pop(), str):
            msg = f"Factor {self.factor.name}: {shown(level)} means no single number; give a number."
            raise StudyError(msg)
        return number


def target(system: System, factor: Factor) -> Target:
    """Find what a factor sets in a system.

    Raises
    ------
    StudyError
        If a name without a component means several variables, or sampling periods are set where there are none.
    SystemDescriptionError
        If a name is unknown, or the variable cannot be set.
    """
    paths: list[str] = []
    names: list[str] = []
    sets_step = False
    for name in factor.variables:
        if name in (SAMPLE_TIME, STEP):
            sets_step = True
            names.append("the communication step")
            periods = [f"{component}.{SAMPLE_TIME}" for component in system.sample_times if name == SAMPLE_TIME]
            paths, names = paths + periods, names + periods
        else:
            names.append(path_of(system, name))
            paths += system.elements(names[-1])
    variables = []
    for path in paths:
        component, variable = system.resolve(path)
        require_settable(component, variable)
        if variable.type == STRING:
            advice = "factors are numbers; give each text a system of its own"
            msg = f"Factor {factor.name}: {path} is a String, and {advice}."
            raise StudyError(msg)
        variables.append(variable)
    return Target(factor, tuple(paths), tuple(variables), sets_step, tuple(names))


def path_of(system: System, name: str) -> str:
    """The full name ``component.variable`` of a start value that may be given by its last part.

    Raises
    ------
    StudyError
        If components have several start values of that name, or none.
    """
    component, dot, _ = name.partition(".")
    if dot and component in system:
        return name
    bearers = [c.name for c in system.components if name in c and _settable(c.description.elements(name), c, name)]
    if len(bearers) == 1:
        return f"{bearers[0]}.{name}"
    if bearers:
        msg = f"Factor {name}: components {', '.join(bearers)} have a start value of this name;"
        msg = f"{msg} write {' or '.join(f'{bearer}.{name}' for bearer in bearers)}."
        raise StudyError(msg)
    known = {v.name: None for c in system.components for v in c.description.variables.values() if v.can_start}
    msg = f"Factor {name}: no component has a start value of this name; {suggestion(name, known)}"
    raise StudyError(msg)


def factors_of(given: Sequence[Any]) -> tuple[Factor, ...]:
    """Factors that mappings from names to values, factors and lists of factors mean.

    Raises
    ------
    StudyError
        If something else is given.
    """
    found: list[Factor] = []
    for item in given:
        if isinstance(item, Factor):
            found.append(item)
        elif isinstance(item, Mapping):
            found += [Factor(name, name, values) for name, values in item.items()]
        elif isinstance(item, list | tuple):
            found += factors_of(item)
        else:
            msg = f'Factors are {shown(item)}; give values by name, as {{"plant.K_f": "1e4:1e6:9log"}}.'
            raise StudyError(msg)
    return tuple(found)


def _settable(elements: Sequence[str] | None, component: Any, name: str) -> bool:
    """Whether all elements of an array, or a scalar, have a start value that can be set."""
    return all(component.variable(element).can_start for element in elements or [name])


def _kind(variable: Variable) -> str:
    """Type of the values of a variable; of a Real that stands for another type, that type."""
    return variable.stands_for or variable.type
