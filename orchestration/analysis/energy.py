"""Energy that the coupling of a co-simulation adds to a system or takes from it, per power bond.

A power bond is a pair of connections between two components. One component has the effort e as output and
the flow f as input, the other component has f as output and e as input. During a step, a component computes
with its own output and with the input value that the algorithm gave it, ~e or ~f:

    energy given by the component with the effort as output       E_e = int e ~f dt
    energy received by the component with the flow as output      E_f = int ~e f dt
    residual                                                      E_f - E_e

In a monolithic simulation both energies are equal. In a co-simulation the residual is energy that the coupling
has created (S. Sadjina, L. Kyllingstad, S. Skjong, E. Pedersen, "Energy conservation and power bonds in
co-simulations", Eng. with Computers 33, 2017; M. Benedikt, D. Watzenig, J. Zehetner, A. Hofer, "NEPCE - a
nearly energy-preserving coupling element for weak-coupled problems", 2013). A positive residual excites the
system, a negative residual damps it. A positive product e f is power from the component with the effort as
output to the other component; the sign of a bond can reverse this.

The input values ~e and ~f follow from the algorithm. A held input has the old output of its source, or the new
output if the source stepped earlier in the same step or the input was corrected. An interpolated input is a
polynomial from the value at t to the known, assumed or extrapolated value at t + h. The integral over a step
uses the trapezoidal rule, with an own output that changes linearly from its old to its new value. An output
that jumps with a held input has its new value during the whole step. Such jumps come from direct feedthrough
and from ticks. For an output that both jumps and changes with the states of its component, the error of the
ledger can be as large as the residual.
"""

from dataclasses import dataclass

import numpy as np

from orchestration.errors import SystemDescriptionError
from orchestration.fmi.codes import INTERPOLATES
from orchestration.fmi.given import require_type
from orchestration.fmi.units import Unit
from orchestration.master.algorithm import SEQUENTIAL, Algorithm, find_algorithm
from orchestration.results.result import Result
from orchestration.system.component import unit_scale
from orchestration.system.system import Component, Connection, System

POWER = {"kg": 1, "m": 2, "s": -3}  # exponents of the watt; a radian counts as 1


@dataclass(frozen=True)
class PowerBond:
    """Two opposite connections whose variables multiply to a power.

    Attributes
    ----------
    effort, flow
        Output variables as ``component.variable``, such as ``wall.F`` (N) and ``mass.v`` (m/s).
    sign
        1 if a positive product of effort and flow is power into the component with the flow as output, else -1.
    jumps
        Names of effort and flow variables that jump at the start of a step. Default: those that declare
        direct feedthrough.

    Raises
    ------
    SystemDescriptionError
        If the sign is neither 1 nor -1.

    Examples
    --------
    >>> from orchestration import PowerBond, System, ledger, scenario, simulate
    >>> fig2 = scenario("fig2")
    >>> system = System.of({name: fig2[name] for name in ("trajectory", "sensor", "controller", "plant")})
    >>> system = system.connect().connect("controller.tau_cmd -> plant.tau")  # without actuators
    >>> result = simulate(system, stop_time=2.0, step=1e-4)
    >>> motors = [PowerBond(f"controller.tau_cmd[{i}]", f"plant.dq[{i}]") for i in (1, 2)]  # N.m times rad/s
    >>> [round(float(ledger(result, motor, system).received[-1]), 1) for motor in motors]  # J
    [2.0, -2.0]
    """

    effort: str
    flow: str
    sign: int = 1
    jumps: tuple[str, ...] | None = None

    def __post_init__(self) -> None:
        """Refuse a sign other than 1 and -1."""
        if self.sign not in (1, -1):
            msg = f"Power bond {self}: the sign {self.sign!r} is neither 1 nor -1."
            raise SystemDescriptionError(msg)

    def __str__(self) -> str:
        """Product of both variables, such as ``wall.F * mass.v``."""
        return f"{self.effort} * {self.flow}"


@dataclass(frozen=True, repr=False)
class Ledger:
    """Energies through a power bond since the start of a run.

    Attributes
    ----------
    bond
        Power bond.
    time
        Communication points, s, shape (n_rows,).
    given
        Energy given by the component that has the effort as output, J, shape (n_rows,).
    received
        Energy received by the component that has the flow as output, J, shape (n_rows,).

    Examples
    --------
    >>> from orchestration import PowerBond, System, ledger, scenario, simulate
    >>> fig2 = scenario("fig2")
    >>> system = System.of({name: fig2[name] for name in ("trajectory", "sensor", "controller", "plant")})
    >>> system = system.connect().connect("controller.tau_cmd -> plant.tau")  # without actuators
    >>> result = simulate(system, stop_time=2.0, step=1e-4)
    >>> shoulder = ledger(result, PowerBond("controller.tau_cmd[1]", "plant.dq[1]"), system)
    >>> shoulder
    <Ledger of controller.tau_cmd[1] * plant.dq[1]: given 1.92337 J, received 1.96352 J, residual +0.0401 J at t = 2 s>
    >>> float(shoulder.residual[-1].round(3))  # J, which holding the torque has added
    0.04
    """

    bond: PowerBond
    time: np.ndarray
    given: np.ndarray
    received: np.ndarray

    def __repr__(self) -> str:
        """Bond, and the energies at the end of the run."""
        if not len(self.time):
            return f"<Ledger of {self.bond}: no rows>"
        ends = f"given {self.given[-1]:.6g} J, received {self.received[-1]:.6g} J"
        return f"<Ledger of {self.bond}: {ends}, residual {self.residual[-1]:+.3g} J at t = {self.time[-1]:g} s>"

    @property
    def residual(self) -> np.ndarray:
        """Energy that the coupling has created, J, shape (n_rows,)."""
        return self.received - self.given


def ledger(result: Result, bond: PowerBond, system: System, algorithm: str | Algorithm = "gauss-seidel") -> Ledger:
    """Compute the energies through a power bond from the result of a run.

    Parameters
    ----------
    result
        Result with a row at every communication point.
    bond
        Power bond.
    system
        System of the run. The order of its components decides which output an input had during a step.
    algorithm
        Algorithm of the run, or its name.

    Returns
    -------
    Ledger
        Energies at all communication points, J.

    Raises
    ------
    SystemDescriptionError
        If effort and flow are not connected to each other, or their product is not a power.
    OrchestrationError
        If the result has no column of the effort or of the flow.

    Examples
    --------
    >>> from orchestration import PowerBond, System, ledger, scenario, simulate
    >>> fig2 = scenario("fig2")
    >>> system = System.of({name: fig2[name] for name in ("trajectory", "sensor", "controller", "plant")})
    >>> system = system.connect().connect("controller.tau_cmd -> plant.tau")  # without actuators
    >>> result = simulate(system, stop_time=2.0, step=1e-4)
    >>> energy = ledger(result, PowerBond("controller.tau_cmd[1]", "plant.dq[1]"), system)
    >>> fine = simulate(system.with_sample_time(1e-5), stop_time=2.0)
    >>> finer = ledger(fine, energy.bond, system)
    >>> round(float(energy.residual[-1] / finer.residual[-1]))  # a tenth of the step, a tenth of the residual
    10
    """
    require_type("The bond", bond, PowerBond, "give one, as PowerBond('wall.F', 'mass.v')")
    require_type("The result", result, Result, "give the Result of a run of the system")
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
    """Values of an input at the start and at the end of each step, shapes (n_steps,)."""
    names = [component.name for component in system.components]
    source, target = system.component(connection.source), system.component(connection.target)
    smooth = source.continuous and target.continuous
    earlier = names.index(source.name) < names.index(target.name)
    known = (algorithm.exchange == SEQUENTIAL and earlier) or (smooth and _corrects(algorithm))
    old, new = y[:-1], y[1:]
    if not _interpolates(algorithm, source, target):
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
    """Whether an algorithm corrects inputs by at least one repeated sweep."""
    return algorithm.correction is not None and algorithm.correction.sweeps != 1


def _interpolates(algorithm: Algorithm, source: Component, target: Component) -> bool:
    """Whether an input is a polynomial in time during a step."""
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
        return False  # an output with interpolated inputs changes continuously
    return variable.direct


def _connection(system: System, bond: PowerBond, source: str, target: str) -> Connection:
    """Connection from an output to the component that has a given other output."""
    (component, variable), (other, _) = system.resolve(source), system.resolve(target)
    for connection in system.connections:
        if (connection.source, connection.output) == (component.name, variable.name):
            if connection.target == other.name:
                by_units = unit_scale(component, variable, other, other.variable(connection.input))
                if connection.scale != by_units:
                    msg = f"Power bond {bond}: {connection} changes the value, so both ends compute different powers."
                    raise SystemDescriptionError(msg)
                return connection
    advice = "so the bond carries no power; name a pair that is connected"
    msg = f"Power bond {bond}: {source} is not connected to {other.name}, {advice}."
    raise SystemDescriptionError(msg)


def _watts(system: System, bond: PowerBond) -> float:
    """Watts per product of effort and flow; a variable without a unit counts as one in SI units.

    Raises
    ------
    SystemDescriptionError
        If the product is not a power.
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
        msg = f"Power bond {bond}: {names[0]} times {names[1]} is not a power; N times m/s or N.m times rad/s is."
        raise SystemDescriptionError(msg)
    return factor
