"""Measures the claims about computational cost: C12."""

from fmus.catalog import MODELS
from orchestration.paper import joint_space_laws as laws
from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.claims.operations import counted, operations, without_update
from orchestration.paper.evidence import DIVISORS, Evidence
from orchestration.paper.scenarios import CRAIG, SLOTINE_LI

JOINTS = (2, 6)


def _fewer_operations(evidence: Evidence) -> Finding:  # noqa: ARG001 - needs no run
    one, two = (operations(MODELS[name]())["tick_update"] for name in (CRAIG, SLOTINE_LI))
    pairs = [(one, two)]
    parts = [f"generated C, n = 2: {one}, {two}"]
    for n in JOINTS:
        for name, dynamics in (("closed form", laws.lagrangian(n)), ("recursion", laws.recursive(n))):
            pair = counted(laws.algorithm_1(n, dynamics)), counted(laws.algorithm_2(n, dynamics))
            pairs.append(pair)
            parts.append(f"{name}, n = {n}: {pair[0]}, {pair[1]}")
    miss = max(laws.recursion_difference(n) for n in JOINTS)
    return Finding(
        {
            limits.FEWER_SIMPLE: [second.simple - first.simple for first, second in pairs],
            limits.FEWER_COSTLY: [second.costly - first.costly for first, second in pairs],
            limits.INVERSE_DYNAMICS: miss,
        },
        f"operations of algorithms 1 and 2 per tick with update (of which costly): {'; '.join(parts)}."
        f" For algorithm 2 {_forms()}. The recursion serves (32), too, with products of two rates, w_i v_i, in the"
        f" place of w_i^2, and agrees with the Lagrangian equations to {miss:.0e}",
    )


def _forms() -> str:
    """What the forms of algorithm 2 cost by the recursion at the largest number of joints."""
    n = JOINTS[-1]
    dynamics = laws.recursive(n)
    ticks = {form: laws.algorithm_2(n, dynamics, form) for form in laws.FORMS}
    whole = ", ".join(f"{form} {counted(tick)}" for form, tick in ticks.items())
    one, two = (without_update(tick) for tick in (laws.algorithm_1(n, dynamics), ticks["(32)"]))
    return (
        f"at n = {n}, by recursion: {whole}; without update algorithm 1 takes {one}, algorithm 2 by (32) {two},"
        f" without C_x s {without_update(ticks['no C_x s'])}"
    )


def _lower_rate(evidence: Evidence) -> Finding:
    runs, parts = [], []
    for name, (first, *slower) in evidence.divisors.items():
        for n, run in zip(DIVISORS[1:], slower, strict=True):
            runs.append((run.e_contact - 2 * first.e_contact, run.m2_in_contact))
            parts.append(f"{name} N = {n}: |e| in contact {run.e_contact * 1e3:.2g} mm, m2 {run.m2_in_contact:.1%}")
    return Finding(
        {
            limits.SLOW_UPDATE_ERROR: [excess for excess, _ in runs],
            limits.M2_IN_CONTACT: [deviation for _, deviation in runs],
        },
        "; ".join(parts),
    )


_SLOWER = " and ".join(str(n) for n in DIVISORS[1:])

QUESTIONS = (
    Question(
        "C12a",
        "Algorithm 2 costs less to compute",
        "IV-B",
        (limits.FEWER_SIMPLE, limits.FEWER_COSTLY, limits.INVERSE_DYNAMICS),
        _fewer_operations,
        scope="operations of a tick with the update of p_hat: those of the generated C of both FMUs, and those of both"
        " laws in joint space for n = 2 and 6 joints and as many tip coordinates, in closed form and by the"
        " Newton-Euler recursion; costly ones are divisions, square roots, sines, cosines and hyperbolic tangents",
    ),
    Question(
        "C12b",
        "p_hat may be updated at a lower rate without harm",
        "IV-B",
        (limits.SLOW_UPDATE_ERROR, limits.M2_IN_CONTACT),
        _lower_rate,
        f"fig5, fig7 at update_divisor {', '.join(map(str, DIVISORS))} (seed 1)",
        f"a lower rate is an update every {_SLOWER} ticks",
    ),
)
