"""Words the failures of the compiled loops as sentences for a user."""

import math
from collections.abc import Sequence

from orchestration.fmi.display import listed
from orchestration.fmi.instance import Instance
from orchestration.master.discard import how_far
from orchestration.master.flatten import Assembly
from orchestration.master.kernel.codes import CALL_NAMES, Column, Failure, Reason
from orchestration.master.step_arrays import Layout


def failure_message(
    failure: Failure,
    where: str,
    layout: Layout,
    instances: Sequence[Instance],
    assembly: Assembly,
) -> str:
    """Return the sentence for a failure of a compiled loop; `where` gives time and step."""
    subject, call, status = failure
    if status in tuple(Reason) and (wrong := _not_finite(assembly)):
        why = "iterations and step control need finite values; use algorithm gauss-seidel or jacobi, with allow_nan"
        return f"{wrong}{where}: {why}."
    if status == Reason.NOT_CONVERGED:
        return _not_converged(subject, where, layout, assembly)
    if status == Reason.SINGULAR:
        names = f"{layout.connections[subject]} and those with it"
        return f"{names}{where}: the Jacobian of the interface is singular; the connections contradict each other."
    if status == Reason.TOO_SMALL:
        smallest = layout.coupling.method.smallest_step
        return (
            f"{layout.watched[subject]}{where}: its error asks for steps below the smallest, {smallest:g} s;"
            " loosen its tolerance, allow smaller steps, or look for a jump (crossings locate them)."
        )
    said = instances[subject].failure(CALL_NAMES[Column(call)], status, where)
    method = layout.coupling.method
    further = how_far(failure, instances, smallest=float(method.smallest_step) if method.controlled else None)
    return said + further + _given(instances[subject].name, assembly)


def _not_finite(assembly: Assembly) -> str:
    """Outputs that are not finite, with their values; empty if there are none."""
    values = ((name, assembly.plan.reals[place]) for name, place in assembly.real_outputs.items())
    return listed([f"{name} = {value:g}" for name, value in values if not math.isfinite(value)])


def _given(component: str, assembly: Assembly) -> str:
    """Return a sentence about outputs that gave a component a value that is not finite; empty if there are none."""
    names = dict.fromkeys(f"{c.source}.{c.output}" for c in assembly.real_connections if c.target == component)
    values = ((name, assembly.plan.reals[assembly.real_outputs[name]]) for name in names)
    wrong = [f"{name} = {value:g}" for name, value in values if not math.isfinite(value)]
    return f" It was given {', '.join(wrong)}." if wrong else ""


def _not_converged(link: int, where: str, layout: Layout, assembly: Assembly) -> str:
    connection, method = layout.connections[link], layout.coupling.method
    advice = "use smaller steps" if method.newton else "use algorithm newton, or smaller steps"
    head = f"Connection {connection}{where}: no convergence after {method.max_iterations} sweeps"
    if link >= len(layout.coupling.links):
        return f"{head}, the discrete value does not settle; {advice}."
    state = layout.coupling.links[link]
    accepted = state.absolute + state.relative * abs(assembly.plan.reals[state.source])
    unit = assembly.units.get(f"{connection.source}.{connection.output}", "")
    return f"{head}, the residual is {state.residual:.3g} {unit}, accepted {accepted:.3g}; {advice}."
