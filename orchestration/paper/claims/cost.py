"""Measures the claims about computational cost: C12."""

from collections.abc import Sequence

from fmus.catalog import MODELS
from orchestration.paper import joint_space_laws as laws
from orchestration.paper.claims import criteria as limits
from orchestration.paper.claims.adaptive import SEEDS_TEXT
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.claims.judged import spread
from orchestration.paper.claims.operations import counted, operations, without_update
from orchestration.paper.evidence import DIVISORS, Evidence
from orchestration.paper.measure import Summary
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
        f" {_forms()}. The recursion serves (32), too, with products of two rates, w_i v_i, in the"
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
        f"Forms of algorithm 2 at n = {n}, by recursion: {whole}; without update algorithm 1 takes {one}, algorithm 2"
        f" by (32) {two},"
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


def _without_coriolis(evidence: Evidence) -> Finding:
    return judge_without_coriolis(evidence.noise["fig7"], evidence.no_coriolis)


def judge_without_coriolis(whole: Sequence[Summary], without: Sequence[Summary]) -> Finding:
    """What runs of algorithm 2 with and without C_x s, each pair with one seed, say about C12c."""
    excess = [two.e_contact - 2 * one.e_contact for one, two in zip(whole, without, strict=True)]
    e, force, m2, free, start = (
        [spread(runs, value) for runs in (whole, without)]
        for value in (
            lambda s: s.e_contact,
            lambda s: s.force_error,
            lambda s: s.m2_in_contact,
            lambda s: s.e_free,
            lambda s: s.e_start,
        )
    )
    values = {
        limits.NO_CORIOLIS_ERROR: excess,
        limits.NO_CORIOLIS_FORCE: force[1][0] - force[0][0],
        limits.M2_IN_CONTACT: m2[1][1],
    }
    text = (
        f"medians with and without C_x s: |e| in contact {e[0][0] * 1e3:.3g} and {e[1][0] * 1e3:.3g} mm, force error"
        f" {force[0][0]:.4g} and {force[1][0]:.4g} N, m2_hat off by {m2[0][0]:.2%} and {m2[1][0]:.2%} in contact;"
        f" |e| <= {start[0][1] * 1e3:.3g} and {start[1][1] * 1e3:.3g} mm while m2_hat adapts,"
        f" <= {free[0][1] * 1e3:.2g} and {free[1][1] * 1e3:.2g} mm in the second half of the free motion"
    )
    return Finding(values, text)


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
    Question(
        "C12c",
        "The term C_x s of algorithm 2 may be ignored",
        "IV-B",
        (limits.NO_CORIOLIS_ERROR, limits.NO_CORIOLIS_FORCE, limits.M2_IN_CONTACT),
        _without_coriolis,
        f"fig7, fig7-no-coriolis, {SEEDS_TEXT}",
        "all seeds but for the median; the torque has C_x dx in the place of C_x dx_r, the adaptation is unchanged",
    ),
)
