"""What a failure of the compiled loops means, as a sentence."""

import math
from collections.abc import Sequence

from orchestration.fmi.instance import Instance
from orchestration.master.flatten import Assembly
from orchestration.master.kernel.coupling import SOURCE
from orchestration.master.kernel.flat_system import CALL_NAMES
from orchestration.master.step_arrays import Layout


def failure_message(
    failure: tuple[int, int, int],
    where: str,
    layout: Layout,
    instances: Sequence[Instance],
    assembly: Assembly,
) -> str:
    """The sentence for (subject, call, status) of a loop; `where` is time and step."""
    from orchestration.master.kernel.correction import NOT_CONVERGED, SINGULAR
    from orchestration.master.kernel.exchange import STEP_CALL_NAMES
    from orchestration.master.kernel.step_control import TOO_SMALL

    subject, call, status = failure
    if status == NOT_CONVERGED:
        return _not_converged(subject, where, layout, assembly)
    if status == SINGULAR:
        names = f"{layout.connections[subject]} and those with it"
        return f"{names}{where}: the Jacobian of the interface is singular; the connections contradict each other."
    if status == TOO_SMALL:
        smallest = layout.coupling.limits[1]
        return (
            f"{layout.watched[subject]}{where}: its error asks for steps below the smallest, {smallest:g} s;"
            " loosen its tolerance, allow smaller steps, or look for a jump (crossings locate them)."
        )
    names = CALL_NAMES if call in CALL_NAMES else STEP_CALL_NAMES
    return instances[subject].failure(names[call], status, where) + _given(instances[subject].name, assembly)


def _given(component: str, assembly: Assembly) -> str:
    """A sentence that names the outputs that gave a component what is no number; empty if there are none."""
    names = dict.fromkeys(f"{c.source}.{c.output}" for c in assembly.real_connections if c.target == component)
    values = ((name, assembly.plan.reals[assembly.real_outputs[name]]) for name in names)
    wrong = [f"{name} = {value:g}" for name, value in values if not math.isfinite(value)]
    return f" It was given {', '.join(wrong)}." if wrong else ""


def _not_converged(link: int, where: str, layout: Layout, assembly: Assembly) -> str:
    connection, method = layout.connections[link], layout.method
    advice = "use smaller steps" if method.newton else "use algorithm newton, or smaller steps"
    head = f"Connection {connection}{where}: no convergence after {method.max_iterations} sweeps"
    if link >= len(layout.coupling.links):
        return f"{head}, the discrete value does not settle; {advice}."
    place = list(layout.coupling.assumed).index(link)
    residual = layout.work.residual[place]
    value = assembly.plan.reals[layout.coupling.links[link, SOURCE]]
    absolute, relative = layout.coupling.link_tolerances[link]
    accepted = absolute + relative * abs(value)
    unit = assembly.units.get(f"{connection.source}.{connection.output}", "")
    return f"{head}, the residual is {residual:.3g} {unit}, accepted {accepted:.3g}; {advice}."
