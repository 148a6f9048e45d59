"""Models that compute next to nothing, and systems of their FMUs: what remains is the work of the master.

An FMU of width n has inputs u[1..n] and outputs y = t - u. In a ring every output feeds the next
FMU, so all values change at every step.
"""

from functools import cache
from pathlib import Path

from adaptimp_fmu import SampledModel, build
from orchestration.fmi.description import read_description
from orchestration.system.system import Component, Connection, System

STEP = 2.0**-10  # s: a power of two, so that k STEP is exact


@cache
def trivial_fmu(width: int) -> Path:
    """The FMU of a trivial model, from the cache or built now."""
    model = SampledModel(f"Trivial{width}", "Subtracts its inputs from the time", sample_time=STEP)
    u = model.input("u", [0.0] * width, description="Signals")
    model.output("y", model.time - u, description="t - u", scalar=False)
    return build(model)


def ring(n_fmus: int, width: int, *, closed: bool = True) -> System:
    """FMUs one behind the other; if not `closed`, the first has no sources."""
    names = [f"member{i + 1}" for i in range(n_fmus)]
    description = read_description(trivial_fmu(width))
    links = tuple(
        Connection(names[i - 1], f"y[{j + 1}]", names[i], f"u[{j + 1}]")
        for i in range(0 if closed else 1, n_fmus)
        for j in range(width)
    )
    components = tuple(Component(name, description) for name in names)
    kind = "ring" if closed else "chain"
    return System(f"{kind}{n_fmus}x{width}", components, links, step=STEP, stop_time=1000 * STEP)


def chain(n_fmus: int, width: int = 1) -> System:
    """An open ring."""
    return ring(n_fmus, width, closed=False)
