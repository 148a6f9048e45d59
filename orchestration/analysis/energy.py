"""What a coupling adds to the energy of a system: a ledger of the power through a bond.

Effort e and flow f cross between two units, each the output of one and an input of the other. Over
a step each unit accounts for its own output times the input it was given, ~e or ~f:

    the effort's producer gives       E_e = int e ~f dt
    the flow's producer receives      E_f = int ~e f dt           residual  E_f - E_e

Solved monolithically both are equal. The residual is energy out of nothing: positive, it drives; negative, it
damps (S. Sadjina, L. Kyllingstad, S. Skjong, E. Pedersen, "Energy conservation and power bonds in
co-simulations", Eng. with Computers 33, 2017; M. Benedikt, D. Watzenig, J. Zehetner, A. Hofer, "NEPCE - a
nearly energy-preserving coupling element for weak-coupled problems", 2013). Positive e f is power from the
effort's producer to the flow's; `sign` turns it.

Given values follow from the algorithm: held, the source's value before the step if it steps later or at
the same time, its new one if it stepped before or was corrected; polynomials run from the value at t to
the one known, assumed or extrapolated at t + h. The integral over a step is the trapezoid rule, with an own
output that runs from its old to its new value. It is exact for linear products. An output that jumps with
an input that is held (direct feedthrough, or a tick) shows its new value during the whole step. One that does
both, jump and run with states of its unit, is accounted for with an error as large as the residual.
"""

from dataclasses import dataclass

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import INTERPOLATES
from orchestration.fmi.units import Unit
from orchestration.master.algorithm import SEQUENTIAL, Algorithm, find_algorithm
from orchestration.results.result import Result
from orchestration.system.component import unit_scale
from orchestration.system.system import Component, Connection, System

POWER = {"kg": 1, "m": 2, "s": -3}  # W in base units, radians counting as 1


@dataclass(frozen=True)
class PowerBond:
    """Two connections that carry power together.

    Attributes
    ----------
    effort, flow
        Outputs as ``component.variable``, such as ``wall.F`` (N) and ``mass.v`` (m/s).
    sign
        1 if positive effort times flow is power into the flow's producer, else -1.
    jumps
        Names of effort and flow variables that jump at the start of a step. Default: those that declare
        direct feedthrough.
    """

    effort: str
    flow: str
    sign: int = 1
    jumps: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        """Check the sign."""
        if self.sign not in (1, -1):
            msg = f"Power bond {self}: the sign {self.sign!r} is neither 1 nor -1."
            raise SystemDescriptionError(msg)

    def __str__(self) -> str:
        """``wall.F * mass.v``."""
        return f"{self.effort} * {self.flow}"


@dataclass(frozen=True)
class Ledger:
    """Cumulative energies, J, each of shape (n_rows,).

    Attributes
    ----------
    time
        s.
    given, received
        What the effort's producer accounts for as given, and the flow's as received.
    """

    bond: PowerBond
    time: np.ndarray
    given: np.ndarray
    received: np.ndarray

    @property
    def residual(self) -> np.ndarray:
        """Energy that the coupling has added, J, shape (n_rows,)."""
        return self.received - self.given


def ledger(result: Result, bond: PowerBond, system: System, algorithm: str | Algorithm = "gauss-seidel") -> Ledger:
    """Account for the power through a bond.

    Parameters
    ----------
    result
        Of a run with that algorithm, its rows at all communication points.
    system
        As it was run: the order of its components decides who was given what.

    Raises
    ------
    SystemDescriptionError
        If the two are not connected to each other, or their product is no power.
    OrchestrationError
        If one of them was not recorded.
    """
    algorithm = find_algorithm(algorithm)
    to_flow, to_effort = (
        _connection(system, bond, bond.effort, bond.flow),
        _connection(system, bond, bond.flow, bond.effort),
    )
    factor = bond.sign * _watts(system, bond)
    e, f, h = result[bond.effort], result[bond.flow], np.diff(result.time)
    given_e, given_f = (_given(system, algorithm, c, result[f"{c.source}.{c.output}"], h) for c in (to_flow, to_effort))
    energies = []
    for path, own, (start, end) in ((bond.effort, e, given_f), (bond.flow, f, given_e)):
        first = own[1:] if _jumps(system, bond, path, algorithm) else own[:-1]
        work = factor * h * (first * start + own[1:] * end) / 2
        energies.append(np.concatenate([[0.0], np.cumsum(work)]))
    return Ledger(bond, result.time, *energies)


def _given(
    system: System, algorithm: Algorithm, connection: Connection, y: np.ndarray, h: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Values of an input at start and end of each step, shapes (n_steps,)."""
    names = [component.name for component in system.components]
    source, target = system.component(connection.source), system.component(connection.target)
    smooth = source.continuous and target.continuous
    earlier = names.index(source.name) < names.index(target.name)
    known = (algorithm.exchange == SEQUENTIAL and earlier) or (smooth and _corrects(algorithm))
    old, new = y[:-1], y[1:]
    if not (_interpolates(algorithm, source, target)):
        held = new if known else old
        return held, held
    if known:
        return old, new
    slope = np.concatenate([[0.0], np.diff(y)[:-1] / h[:-1]])
    end = old + h * slope
    if algorithm.order > 1:
        bend = np.concatenate([[0.0, 0.0], np.diff(slope[1:]) / (h[1:-1] + h[:-2])])[: end.size]
        behind = np.concatenate([[0.0], h[:-1]])
        end = end + bend * h * (h + behind)
    return old, end


def _corrects(algorithm: Algorithm) -> bool:
    return algorithm.correction is not None and algorithm.correction.sweeps != 1


def _interpolates(algorithm: Algorithm, source: Component, target: Component) -> bool:
    smooth = source.continuous and target.continuous
    return algorithm.order > 0 and smooth and target.description.can(INTERPOLATES)


def _jumps(system: System, bond: PowerBond, path: str, algorithm: Algorithm) -> bool:
    """Whether an output takes its new value at the start of a step."""
    component, variable = system.resolve(path)
    if bond.jumps is not None:
        return path in bond.jumps
    if not component.continuous:
        return True
    if component.description.can(INTERPOLATES) and algorithm.order > 0:
        return False  # its inputs run, and so does it
    return variable.direct


def _connection(system: System, bond: PowerBond, source: str, target: str) -> Connection:
    """The connection from an output to the component of another."""
    (component, variable), (other, _) = system.resolve(source), system.resolve(target)
    for connection in system.connections:
        if (connection.source, connection.output) == (component.name, variable.name):
            if connection.target == other.name:
                by_units = unit_scale(component, variable, other, other.variable(connection.input))
                if connection.scale != by_units:
                    msg = f"Power bond {bond}: {connection} changes the value on its way, so the powers differ."
                    raise SystemDescriptionError(msg)
                return connection
    msg = f"Power bond {bond}: {source} is not connected to {other.name}, so no power goes through it."
    raise SystemDescriptionError(msg)


def _watts(system: System, bond: PowerBond) -> float:
    """Watts per effort times flow, in their units; an end without a unit counts as one in SI.

    Raises
    ------
    SystemDescriptionError
        If the product is no power.
    """
    exponents: dict[str, int] = {}
    factor, names = 1.0, []
    for path in (bond.effort, bond.flow):
        component, variable = system.resolve(path)
        unit = component.description.unit(variable)
        names.append(variable.unit or "none")
        if unit is None:
            return factor
        meaning = unit.meaning or Unit(((unit.name, 1),))
        factor *= meaning.factor
        for name, exponent in meaning.exponents:
            exponents[name] = exponents.get(name, 0) + exponent
    found = {name: exponent for name, exponent in exponents.items() if exponent and name != "rad"}
    if found != POWER:
        msg = f"Power bond {bond}: {names[0]} times {names[1]} is no power, such as N times m/s or N.m times rad/s."
        raise SystemDescriptionError(msg)
    return factor
