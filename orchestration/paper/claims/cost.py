"""Claims about sensitivity and cost: C11 and C12."""

import time

import casadi as ca
import numpy as np

from adaptimp_fmu.lowering import lower
from fmus.catalog import UNITS
from orchestration.fmi.instance import read_description
from orchestration.master.flatten import assemble
from orchestration.master.initialization import initialize, opened
from orchestration.master.kernel import fixed_step
from orchestration.master.kernel.step_program import operations_of_step
from orchestration.paper.claims.claim import Finding, Question
from orchestration.paper.evidence import DIVISORS, Evidence
from orchestration.paper.measure import Summary
from orchestration.paper.scenarios import ADAPTIVE_STEP, CRAIG, SLOTINE_LI
from orchestration.system.system import Component, System

_NOT_ARITHMETIC = (ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_CONST, ca.OP_PARAMETER, ca.OP_ASSIGN)
TIMED_STEPS, REPETITIONS = 20_000, 9


def _accurate(summary: Summary | None) -> bool:
    """Stable and accurate: |e| <= 1 mm from half of the free motion on, m2_hat within 20 % in contact."""
    if summary is None:
        return False
    return summary.e_free <= 1e-3 and summary.e_contact <= 1e-3 and summary.m2_in_contact < 0.2


def _sensitivity(evidence: Evidence) -> Finding:
    counts = {name: sum(_accurate(s) for _, _, s in rows) for name, rows in evidence.sensitivity.items()}
    failed = {name: sum(s is None for _, _, s in rows) for name, rows in evidence.sensitivity.items()}
    total = len(evidence.sensitivity["fig5"])
    return Finding(
        counts["fig7"] > counts["fig5"],
        f"stable and accurate: algorithm 1 {counts['fig5']} of {total} ({failed['fig5']} failed or refused,"
        f" Psi must be below B/M = 170 1/s), algorithm 2 {counts['fig7']} of {total}"
        f" ({failed['fig7']} failed)",
    )


def operations(identifier: str) -> dict[str, int]:
    """Arithmetic operations per tick of a controller, without and with the update of p_hat."""
    functions = {f.name(): f for f in lower(UNITS[identifier]()).functions}
    return {
        name: sum(
            functions[name].instruction_id(i) not in _NOT_ARITHMETIC for i in range(functions[name].n_instructions())
        )
        for name in ("tick", "tick_update")
    }


def _times(evidence: Evidence, identifiers: tuple[str, ...]) -> dict[str, float]:
    """Median time of a tick with update, ns, of controllers stepped alone, in alternation."""
    times: dict[str, list[float]] = {identifier: [] for identifier in identifiers}
    grid = np.arange(TIMED_STEPS + 1) * ADAPTIVE_STEP, np.array([ADAPTIVE_STEP])
    for _ in range(REPETITIONS):
        for identifier in identifiers:
            component = Component("controller", read_description(evidence.laboratory.fmus[identifier]))
            system = System("alone", (component,)).with_sample_time(ADAPTIVE_STEP)
            with opened(system) as instances:
                assembly = assemble(system, instances, ())
                initialize(system, instances, assembly, 0.0)
                chain = operations_of_step(assembly.plan, sequential=True)
                rows = np.empty((TIMED_STEPS + 1, 0))
                started = time.perf_counter()
                fixed_step.run(chain, assembly.plan, grid, (0, TIMED_STEPS), rows[1:], 1)
                times[identifier].append((time.perf_counter() - started) / TIMED_STEPS * 1e9)
    return {identifier: float(np.median(values)) for identifier, values in times.items()}


def _cost(evidence: Evidence) -> Finding:
    one, two = operations(CRAIG), operations(SLOTINE_LI)
    measured = _times(evidence, (CRAIG, SLOTINE_LI))
    ratio = measured[SLOTINE_LI] / measured[CRAIG]
    harmless, parts = True, []
    for name, runs in evidence.divisors.items():
        first = runs[0]
        for n, run in zip(DIVISORS[1:], runs[1:], strict=True):
            harmless &= run.m2_in_contact < 0.2 and run.e_contact <= 2 * first.e_contact + 1e-4
            parts.append(f"{name} N = {n}: |e| in contact {run.e_contact * 1e3:.2g} mm, m2 {run.m2_in_contact:.1%}")
    return Finding(
        two["tick_update"] < one["tick_update"] and ratio < 1 and harmless,
        f"operations per tick with update: algorithm 1 {one['tick_update']}, algorithm 2 {two['tick_update']}"
        f" (without: {one['tick']}, {two['tick']}); measured time ratio {ratio:.2f}; {'; '.join(parts)}",
    )


QUESTIONS = (
    Question(
        "C11",
        "Algorithm 2 is less sensitive to Psi and Gamma than algorithm 1",
        "V",
        "more stable and accurate runs (|e| <= 1 mm after the transient, m2_hat within 20 % in contact) among"
        " 7 x 7 over two decades of Psi and Gamma",
        _sensitivity,
        "fig5, fig7 without limits (seed 1)",
    ),
    Question(
        "C12",
        "Algorithm 2 costs less to compute; p_hat may be updated at a lower rate without harm",
        "IV-B",
        "fewer operations in the generated C and less measured time per tick; at N = 10 and 100 |e| in"
        " contact at most doubles (plus 0.1 mm) and m2_hat stays within 20 %",
        _cost,
        "fig5, fig7 at update_divisor 1, 10, 100 (seed 1)",
    ),
)
