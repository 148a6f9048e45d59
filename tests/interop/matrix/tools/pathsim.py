"""Adapter for PathSim with its block for co-simulation FMUs."""

from tests.interop.matrix.protocol import (
    FMU,
    GAUSS_SEIDEL,
    SYSTEM,
    Job,
    Record,
    Tool,
    ordered,
    require_constant_parameters,
)

TOOL = Tool(
    "pathsim",
    "PathSim",
    "pathsim-fmi",
    (FMU, SYSTEM),
    "`Source` blocks connected to the FMU, which takes what they show at the end of the step; no parameters",
    algorithm=GAUSS_SEIDEL,
    requirements=("pathsim-fmi==0.1.1", "numpy"),
)


def run(job: Job) -> Record:
    """One block per FMU, connected by ports; outputs are read after every step of its simulation.

    Within a step the blocks take their inputs and step in the order in which they are given.
    """
    from pathsim import Connection, Simulation
    from pathsim_fmi import CoSimulationFMU

    require_constant_parameters(job)
    blocks = {}
    for part in job.parts:
        start = {name: part.value(name, value) for name, value in {**part.initial, **part.start}.items()}
        blocks[part.name] = CoSimulationFMU(part.fmu, part.name, start, job.step)
    sources, connections = _sources(job, blocks)
    for source, output, target, input_ in job.connections:
        connections.append(Connection(blocks[source][output], blocks[target][input_]))
    simulation = Simulation([*blocks.values(), *sources], connections, dt=job.step, log=False)
    series: dict[str, list[float]] = {column: [] for column in job.columns}
    for _ in range(job.n_steps + 1):
        for part, name in map(job.split, job.columns):
            series[f"{part.name}.{name}"].append(float(blocks[part.name].outputs[name]))
        simulation.timestep(job.step)
    return ordered(job, series)


def _sources(job: Job, blocks):
    """A source for each driven input; what it shows at t_k + step is what the FMU takes in the step from t_k."""
    from pathsim import Connection
    from pathsim.blocks import Source

    sources, connections = [], []
    for path, values in job.stimulus.items():
        part, name = job.split(path)
        if part.causalities[name] != "input":
            continue
        sources.append(Source(lambda t, values=values: values[max(round(t / job.step) - 1, 0)]))
        connections.append(Connection(sources[-1], blocks[part.name][name]))
    return sources, connections
