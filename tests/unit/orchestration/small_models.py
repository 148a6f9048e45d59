"""Small models whose outputs can be predicted exactly, and systems of their FMUs.

All numbers are small integers and powers of two, so predictions hold bitwise.
"""

from pathlib import Path

import casadi as ca

from adaptimp_fmu import ContinuousModel, SampledModel, Type, build
from orchestration import Component, Connection, System
from orchestration.fmi.description import read_description

H = 0.125  # s, step and sampling period: k * H is exact
FIRST = 3.0  # value of a source at tick 0
LAST_TICK = 40  # at which a fragile FMU still works


def source() -> SampledModel:
    """Counts its ticks: Real u = 3 + k, Integer n = k, Boolean even."""
    model = SampledModel("Source", "Counts ticks", sample_time=H)
    k = model.state("k", ca.SX(0))
    model.update(k, k + 1)
    model.output("u", FIRST + k, unit="m", description="Three more than the number of ticks", scalar=True)
    model.output("n", k, description="Number of ticks", type=Type.INTEGER, scalar=True)
    model.output("even", ca.fmod(k, 2) == 0, description="Whether n is even", type=Type.BOOLEAN, scalar=True)
    return model


def relay() -> SampledModel:
    """Passes signals on, changed: y = 2 u + offset, m = n + 1, odd = not even."""
    model = SampledModel("Relay", "Doubles, increments, negates", sample_time=H)
    u = model.input("u", 0.0, unit="m", description="A Real")
    n = model.input("n", 0, description="An Integer", type=Type.INTEGER)
    even = model.input("even", False, description="A Boolean", type=Type.BOOLEAN)
    offset = model.parameter("offset", 0.0, unit="m", description="Added to y")
    model.output("y", 2 * u + offset, unit="m", description="2 u + offset", scalar=True)
    model.output("m", n + 1, description="n + 1", type=Type.INTEGER, scalar=True)
    model.output("odd", ca.logic_not(even), description="not even", type=Type.BOOLEAN, scalar=True)
    return model


def switch() -> SampledModel:
    """Y = n where `flag`, else -n: consumes an Integer and a Boolean."""
    model = SampledModel("Switch", "Signs an Integer by a Boolean", sample_time=H)
    n = model.input("n", 0, description="An Integer", type=Type.INTEGER)
    flag = model.input("flag", False, description="A Boolean", type=Type.BOOLEAN)
    model.output("y", ca.if_else(flag, n, -n), description="n or -n", scalar=True)
    return model


def integrator() -> ContinuousModel:
    """dx/dt = u; y = x + through u, which feeds the input through unless `through` is zero."""
    model = ContinuousModel("Integrator", "Integrates its input", dt_max=H)
    u = model.input("u", 0.0, unit="m", description="A rate")
    start = model.parameter("x_start", 0.0, description="First x")
    through = model.parameter("through", 0.0, description="Direct part of u in y")
    x = model.state("x", start)
    model.derivative(x, u)
    model.output("x", x, unit="m", description="The integral", scalar=True)
    model.output("y", x + through * u, unit="m", description="x + through u", scalar=True)
    return model


def fragile() -> SampledModel:
    """Counts its ticks and fails at the one after `LAST_TICK`."""
    model = SampledModel("Fragile", "Fails after a while", sample_time=H)
    k = model.state("k", ca.SX(0))
    model.update(k, k + 1)
    model.require(LAST_TICK + 0.5 - k, "k must stay small")
    model.output("k", k, description="Number of ticks", scalar=True)
    return model


def build_small_models(folder: Path) -> dict[str, Path]:
    """Build them all; FMU files by model identifier."""
    models = [source(), relay(), switch(), integrator(), fragile()]
    return {model.name: build(model, folder) for model in models}


def system(fmus: dict[str, Path], units: dict[str, str], connections: str = "", *, steps: int = 16) -> System:
    """A system from component names with model identifiers, and lines ``a.y -> b.u``."""
    components = tuple(Component(name, read_description(fmus[unit])) for name, unit in units.items())
    links = []
    for line in filter(None, map(str.strip, connections.splitlines())):
        (source_name, output), (target, input_) = (end.split(".", 1) for end in line.split(" -> "))
        links.append(Connection(source_name, output, target, input_))
    return System("small", components, tuple(links), step=H, stop_time=steps * H)


def chain(fmus: dict[str, Path], length: int, *, steps: int = 16) -> System:
    """A source and `length` relays one behind the other, in the order of the signals."""
    units = {"source": "Source", **{f"relay{i}": "Relay" for i in range(1, length + 1)}}
    lines = ["source.u -> relay1.u", "source.n -> relay1.n", "source.even -> relay1.even"]
    for i in range(1, length):
        pairs = (("y", "u"), ("m", "n"), ("odd", "even"))
        lines += [f"relay{i}.{output} -> relay{i + 1}.{input_}" for output, input_ in pairs]
    return system(fmus, units, "\n".join(lines), steps=steps)


def mixed(fmus: dict[str, Path], *, steps: int = 16) -> System:
    """Real, Integer and Boolean signals, sampled and continuous FMUs, one feedback."""
    units = {"source": "Source", "relay": "Relay", "switch": "Switch", "plant": "Integrator"}
    return system(
        fmus,
        units,
        """
        plant.x -> relay.u
        source.n -> relay.n
        source.even -> relay.even
        relay.m -> switch.n
        relay.odd -> switch.flag
        relay.y -> plant.u
        """,
        steps=steps,
    ).set({"plant.x_start": 1.0})
