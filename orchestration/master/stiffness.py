"""Warns before a run whose components integrate a stiff spring with sub-steps that are too long.

A continuous FMU may have a parameter ``dt_max``, the longest sub-step of its own Runge-Kutta method, s. A spring k on a
mass m swings at the rate

    omega = sqrt(k / m)

and the method is accurate while omega times the sub-step dt is small: its error of phase is (omega dt)^4 / 120 per
radian. At the wall of the paper's arm, errors are 0.01 to 1 % of the range of a signal at omega dt = 0.32, and 5 to
10 % at 0.55. Where the communication step h is long, too, the bounces off the wall fall between the samples of the
controller, and errors grow from bounce to bounce: from omega h = 0.5 on, omega dt = 0.1 is the limit. With 0.05 errors
stay below 0.1 %.

Contact at a stiff wall begins during a run, so the state at the start does not show it. The parameters do: the
stiffest parameter in N/m over the lightest in kg, or in N.m/rad over kg.m2, bounds omega. Where an array has moments of
inertia beside masses, as the parameters of a chain of rigid bodies do, the second pair is left out: such a moment is
about the frame of one body, and no spring of a joint acts on it alone.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from orchestration.errors import warn_caller
from orchestration.fmi.codes import REAL
from orchestration.fmi.units import Unit
from orchestration.system.component import Component
from orchestration.system.system import System

SUB_STEP = "dt_max"
"""Name of the parameter that tells the longest sub-step, s."""
WELL_SAMPLED = 0.5  # omega h: above it, a period of the swing has fewer than 13 communication steps
LIMITS = (0.32, 0.1)  # omega dt, with a swing that is sampled well, and that is not
ADVISED = 0.05  # omega dt
SLACK = 1e-6  # by which a step may exceed a whole number of sub-steps
MOMENT = {"kg": 1, "m": 2}
SPRINGS = (
    ({"kg": 1, "s": -2}, {"kg": 1}),
    ({"kg": 1, "m": 2, "s": -2, "rad": -1}, MOMENT),
)
"""Base units of a stiffness and of the inertia on which it acts, along a line and about an axis."""


class StiffnessWarning(UserWarning):
    """Warning that the sub-steps of an FMU are too long for the stiffest spring among its parameters.

    Examples
    --------
    >>> import warnings
    >>> from orchestration import StiffnessWarning, scenario, simulate
    >>> steel = scenario("fig2").set({"plant.K_f": 1e8})  # N/m
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always", StiffnessWarning)
    ...     result = simulate(steel, stop_time=0.1)
    >>> print(caught[0].message)
    plant: K_f = 1e+08 N/m on m[2] = 1 kg swings at 1e+04 rad/s, ... set plant.dt_max to 5e-06 s or less.
    """


@dataclass(frozen=True)
class Stiffness:
    """A spring that a component integrates with sub-steps that are too long.

    Attributes
    ----------
    component
        Name of the component.
    stiffness, inertia
        Parameters that decide, as text with value and unit.
    rate
        Largest rate that both make possible, rad/s.
    sub_step
        Sub-step that the component uses, s.
    advised
        Value of ``dt_max`` that would do, s.
    """

    component: str
    stiffness: str
    inertia: str
    rate: float
    sub_step: float
    advised: float

    def __str__(self) -> str:
        """One sentence with both values and what to do."""
        return (
            f"{self.component}: {self.stiffness} on {self.inertia} swings at {self.rate:.3g} rad/s, too fast for"
            f" sub-steps of {self.sub_step:.3g} s; set {self.component}.{SUB_STEP} to {self.advised:g} s or less."
        )


def report_stiffness(system: System, step: float) -> None:
    """Warn of each component whose sub-steps are too long for its stiffest spring; the step in s."""
    for found in stiff_components(system, step):
        warn_caller(str(found), StiffnessWarning)


def stiff_components(system: System, step: float) -> list[Stiffness]:
    """Find the components whose sub-steps are too long for the stiffest spring among their parameters.

    Parameters
    ----------
    system
        System with start values.
    step
        Communication step, s. A sub-step is the longest equal part of it that ``dt_max`` allows.

    Returns
    -------
    list of Stiffness
        Components in their order; empty if all sub-steps are short enough.
    """
    return [found for component in system.components for found in _of(component, step)]


def _of(component: Component, step: float) -> Iterator[Stiffness]:
    limit = component.description.variables.get(SUB_STEP)
    if limit is None or (limit.causality, limit.type, limit.unit) != ("parameter", REAL, "s"):
        return
    longest = _value(component, SUB_STEP)
    if longest is None or not longest > 0:
        return
    sub_step = step / max(1, math.ceil(step / longest - SLACK))
    worst = max(_springs(component), default=None)
    if worst is not None and worst[0] * sub_step > LIMITS[worst[0] * step > WELL_SAMPLED]:
        rate, stiffness, inertia = worst
        named = _named(component, stiffness), _named(component, inertia)
        yield Stiffness(component.name, *named, rate, sub_step, _rounded_down(ADVISED / rate))


def _springs(component: Component) -> Iterator[tuple[float, str, str]]:
    """Largest rate, rad/s, with the parameters that it comes from, for each kind of spring."""
    for stiff, inert in SPRINGS:
        springs, masses = _in_base_units(component, stiff), _in_base_units(component, inert)
        if inert == MOMENT and _has_bodies(component, [name for _, name in masses]):
            continue
        if springs and masses:
            (k, spring), (m, mass) = max(springs), min(masses)
            yield math.sqrt(k / m), spring, mass


def _has_bodies(component: Component, moments: list[str]) -> bool:
    """Whether moments of inertia are in an array that also has elements of other units."""
    arrays = {name.partition("[")[0] for name in moments}
    parameters = component.description.of_causality("parameter")
    units = {(base, v.unit) for v in parameters if (base := v.name.partition("[")[0]) in arrays}
    return len(units) > len(arrays)


def _in_base_units(component: Component, exponents: dict[str, int]) -> list[tuple[float, str]]:
    """Positive parameters of a dimension, in base units, with their names."""
    found = []
    for variable in component.description.of_causality("parameter"):
        unit = component.description.unit(variable) if variable.unit else None
        meaning = unit.meaning if unit is not None else None
        if isinstance(meaning, Unit) and dict(meaning.exponents) == exponents:
            value = _value(component, variable.name)
            if value is not None and 0 < value * meaning.factor < math.inf:
                found.append((value * meaning.factor, variable.name))
    return found


def _value(component: Component, name: str) -> float | None:
    value = component.start.get(name, component.variable(name).start)
    return None if value is None else float(value)


def _named(component: Component, name: str) -> str:
    return f"{name} = {_value(component, name):g} {component.variable(name).unit}"


def _rounded_down(value: float) -> float:
    """The value with one digit, rounded down."""
    decade = 10.0 ** math.floor(math.log10(value))
    return float(f"{math.floor(value / decade * (1 + SLACK)) * decade:.0e}")
