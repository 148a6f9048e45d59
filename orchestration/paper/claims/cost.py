"""Measures the claims about sensitivity and computational cost: C11 and C12.

Cost is counted, not timed: a count is the same on every machine. One operation is an addition, a subtraction,
a multiplication, a comparison, a choice or the like; a costly one is a division, a square root, or a sine,
cosine or hyperbolic tangent. Fewer operations of both kinds cost less whatever a machine makes of either.
"""

from dataclasses import dataclass

import casadi as ca

from adaptimp_fmu import Model
from adaptimp_fmu.lowering import lower
from fmus.catalog import MODELS
from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.evidence import DIVISORS, GAMMA_GRID_FACTORS, PSI_GRID, Evidence
from orchestration.paper.measure import Summary
from orchestration.paper.numbers import LARGEST_PSI
from orchestration.paper.scenarios import CRAIG, SLOTINE_LI

_NOT_ARITHMETIC = (ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST, ca.OP_PARAMETER, ca.OP_ASSIGN)
_COSTLY = frozenset(
    {
        *(ca.OP_DIV, ca.OP_INV, ca.OP_SQRT, ca.OP_POW, ca.OP_CONSTPOW, ca.OP_EXP, ca.OP_LOG, ca.OP_FMOD),
        *(ca.OP_SIN, ca.OP_COS, ca.OP_TAN, ca.OP_ASIN, ca.OP_ACOS, ca.OP_ATAN, ca.OP_ATAN2),
        *(ca.OP_SINH, ca.OP_COSH, ca.OP_TANH, ca.OP_ASINH, ca.OP_ACOSH, ca.OP_ATANH),
    }
)


@dataclass(frozen=True)
class Operations:
    """Arithmetic operations of a function of the generated C; `costly` are divisions, roots and functions."""

    simple: int
    costly: int

    @property
    def total(self) -> int:
        """All operations."""
        return self.simple + self.costly


def _accurate(summary: Summary | None) -> bool:
    """Whether a run is stable and accurate: `criteria.ACCURATE`."""
    if summary is None:
        return False
    measured = (summary.e_free, summary.e_contact, summary.m2_in_contact)
    return all(criterion.met(value) for criterion, value in zip(limits.ACCURATE, measured, strict=True))


def _sensitivity(evidence: Evidence) -> Finding:
    counts = {name: sum(_accurate(s) for _, _, s in rows) for name, rows in evidence.sensitivity.items()}
    failed = {name: sum(s is None for _, _, s in rows) for name, rows in evidence.sensitivity.items()}
    total = len(evidence.sensitivity["fig5"])
    return Finding(
        {limits.MORE_ACCURATE_RUNS: counts["fig7"] - counts["fig5"]},
        f"stable and accurate: algorithm 1 {counts['fig5']} of {total} ({failed['fig5']} failed or refused,"
        f" Psi must be below B/M = {LARGEST_PSI:g} 1/s), algorithm 2 {counts['fig7']} of {total}"
        f" ({failed['fig7']} failed)",
    )


def operations(model: Model) -> dict[str, Operations]:
    """Arithmetic operations of a sampled unit's tick, by function of the generated C.

    ``tick`` is the tick without, ``tick_update`` the tick with the update of slow states, p_hat.
    """
    functions = {f.name(): f for f in lower(model).functions}
    return {name: _counted(functions[name]) for name in ("tick", "tick_update") if name in functions}


def _counted(function: ca.Function) -> Operations:
    codes = [function.instruction_id(i) for i in range(function.n_instructions())]
    arithmetic = [code for code in codes if code not in _NOT_ARITHMETIC]
    costly = sum(code in _COSTLY for code in arithmetic)
    return Operations(len(arithmetic) - costly, costly)


def _cost(evidence: Evidence) -> Finding:
    one, two = operations(MODELS[CRAIG]()), operations(MODELS[SLOTINE_LI]())
    runs, parts = [], []
    for name, (first, *slower) in evidence.divisors.items():
        for n, run in zip(DIVISORS[1:], slower, strict=True):
            runs.append((run.e_contact - 2 * first.e_contact, run.m2_in_contact))
            parts.append(f"{name} N = {n}: |e| in contact {run.e_contact * 1e3:.2g} mm, m2 {run.m2_in_contact:.1%}")
    return Finding(
        {
            limits.FEWER_SIMPLE: two["tick_update"].simple - one["tick_update"].simple,
            limits.FEWER_COSTLY: two["tick_update"].costly - one["tick_update"].costly,
            limits.SLOW_UPDATE_ERROR: [excess for excess, _ in runs],
            limits.M2_IN_CONTACT: [deviation for _, deviation in runs],
        },
        f"arithmetic operations of the generated C per tick with update: algorithm 1 {one['tick_update'].total}, of"
        f" which {one['tick_update'].costly} costly, algorithm 2 {two['tick_update'].total}, of which"
        f" {two['tick_update'].costly} costly (without update: {one['tick'].total}, {one['tick'].costly} and"
        f" {two['tick'].total}, {two['tick'].costly}); {'; '.join(parts)}",
    )


_SLOWER = " and ".join(str(n) for n in DIVISORS[1:])

QUESTIONS = (
    Question(
        "C11",
        "Algorithm 2 is less sensitive to Psi and Gamma than algorithm 1",
        "V",
        (limits.MORE_ACCURATE_RUNS,),
        _sensitivity,
        "fig5, fig7 without limits (seed 1)",
        f"of {len(PSI_GRID)} x {len(GAMMA_GRID_FACTORS)} runs over two decades of Psi and Gamma; a run is stable and"
        f" accurate if {', '.join(map(str, limits.ACCURATE))}",
    ),
    Question(
        "C12",
        "Algorithm 2 costs less to compute; p_hat may be updated at a lower rate without harm",
        "IV-B",
        (limits.FEWER_SIMPLE, limits.FEWER_COSTLY, limits.SLOW_UPDATE_ERROR, limits.M2_IN_CONTACT),
        _cost,
        f"fig5, fig7 at update_divisor {', '.join(map(str, DIVISORS))} (seed 1)",
        "operations are those of the generated C with the update of p_hat; costly ones are divisions, square roots,"
        f" sines, cosines and hyperbolic tangents; a lower rate is an update every {_SLOWER} ticks",
    ),
)
