"""Adapter for SySSimX, whose signals carry units."""

from tests.interop.matrix.protocol import FMU, SYSTEM, Job, Record, Tool, ordered, require_constant_parameters

TOOL = Tool(
    "syssimx",
    "SySSimX",
    "syssimx",
    (FMU, SYSTEM),
    "`set_inputs` before each step; no parameters",
    requirements=("syssimx[fmu]==0.4.3", "numpy"),
    longest=2000,
)


def run(job: Job) -> Record:
    """Its Jacobi algorithm, or one component stepped alone."""
    from syssimx import Connection, System
    from syssimx.components import FMUComponent
    from syssimx.system.algorithms import JacobiAlgorithm

    require_constant_parameters(job)
    system = System(name=job.name)
    components = {part.name: FMUComponent(part.name, part.fmu) for part in job.parts}
    for part in job.parts:
        parameters = {n: part.value(n, v) for n, v in part.start.items() if part.causalities[n] == "parameter"}
        components[part.name].set_parameters(**parameters)
        system.add_component(components[part.name])
    for source, output, target, input_ in job.connections:
        system.add_connection(Connection(source, output, target, input_))
    system.set_algorithm(JacobiAlgorithm())
    system.initialize(0.0)
    series: dict[str, list[float]] = {column: [] for column in job.columns}
    for k in range(job.n_steps + 1):
        for part, name in map(job.split, job.columns):
            value = components[part.name].get_outputs()[name]
            series[f"{part.name}.{name}"].append(float(getattr(value, "magnitude", value)))
        for path, values in job.stimulus.items():
            part, name = job.split(path)
            if part.causalities[name] == "input":
                components[part.name].set_inputs({name: part.value(name, values[k])}, k * job.step)
        system.algorithm.step(system, k * job.step, job.step)
    return ordered(job, series)
