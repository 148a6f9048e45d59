"""Power bonds that the physical units of connections show, and the energy that the coupling adds there."""

import re
from collections.abc import Iterator

import numpy as np

from orchestration.analysis.doctor.case import Case
from orchestration.analysis.doctor.finding import Finding, Severity, percent
from orchestration.analysis.energy import Ledger, PowerBond, ledger
from orchestration.results.result import Result
from orchestration.system.component import unit_scale
from orchestration.system.system import Connection, System

EFFORTS_AND_FLOWS = (
    ({"kg": 1, "m": 1, "s": -2}, {"m": 1, "s": -1}),  # N, m/s
    ({"kg": 1, "m": 2, "s": -2}, {"s": -1}),  # N.m, rad/s
    ({"kg": 1, "m": 2, "s": -3, "A": -1}, {"A": 1}),  # V, A
    ({"kg": 1, "m": -1, "s": -2}, {"m": 3, "s": -1}),  # Pa, m3/s
)
"""Base units, without the radian, of variables whose product is a power."""
MUCH = 0.05  # of the energy that was exchanged
INDEX = re.compile(r"\[[^\]]*\]$")


def power_bonds(system: System) -> list[PowerBond]:
    """Find pairs of opposite connections between two components whose physical units multiply to a power.

    Where several pairs are possible, as between arrays, those with the same index belong together. Connections whose
    factor is not that of their units are left out, because both ends see different powers.
    """
    dimensions = [_dimension(system, connection) for connection in system.connections]
    between: dict[tuple[str, str], list[int]] = {}
    for i, c in enumerate(system.connections):
        between.setdefault((c.source, c.target), []).append(i)
    found = []
    for effort, dimension in zip(system.connections, dimensions, strict=True):
        flows = [flow for one, flow in EFFORTS_AND_FLOWS if one == dimension]
        opposite = between.get((effort.target, effort.source), ()) if flows else ()
        back = [system.connections[i] for i in opposite if dimensions[i] in flows]
        back = [c for c in back if _index(c.output) == _index(effort.output)] if len(back) > 1 else back
        if len(back) == 1:
            found.append(PowerBond(f"{effort.source}.{effort.output}", f"{back[0].source}.{back[0].output}"))
    return list(dict.fromkeys(found))


def _dimension(system: System, connection: Connection) -> dict[str, int] | None:
    """Exponents of the base units, without the radian; None without a unit, or if the factor is another than theirs."""
    source, target = system.component(connection.source), system.component(connection.target)
    output, input_ = source.variable(connection.output), target.variable(connection.input)
    unit = source.description.unit(output) if output.unit else None
    if unit is None or unit.meaning is None or unit_scale(source, output, target, input_) != connection.scale:
        return None
    return dict(unit.meaning.without_angle().exponents)


def _index(name: str) -> str:
    """Index of an element of an array, such as ``[2]``; empty for a scalar."""
    match = INDEX.search(name)
    return match[0] if match else ""


def energy_findings(case: Case, result: Result) -> Iterator[Finding]:
    """Findings on the energy that the coupling has added to each power bond, or taken from it, during a run."""
    for bond in power_bonds(case.system):
        energies = ledger(result, bond, case.system, case.algorithm)
        exchanged = _exchanged(energies)
        residual = float(energies.residual[-1])
        largest = float(np.abs(energies.residual).max())
        share = largest / exchanged if exchanged else 0.0
        word = "added" if residual >= 0 else "taken"
        much = share > MUCH
        yield Finding(
            "energy",
            Severity.WARNING if much else Severity.NOTE,
            bond.effort,
            f"The coupling has {word} {abs(residual):.3g} J at {bond} until {energies.time[-1]:.4g} s; at most"
            f" {largest:.3g} J, {percent(share)} of the {exchanged:.3g} J that were exchanged.",
            {"bond": str(bond), "residual": residual, "largest": largest, "exchanged": exchanged, "share": share},
            "Use a smaller step, or an algorithm whose inputs follow a line or parabola." if much else "",
        )


def _exchanged(energies: Ledger) -> float:
    """Sum of the magnitudes of the energies that went through a bond in both directions, J."""
    return max(float(np.abs(np.diff(e)).sum()) for e in (energies.given, energies.received))
