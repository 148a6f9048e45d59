"""Adapter for sofirpy's loop over FMUs."""

from tests.interop.matrix.protocol import FMU, SYSTEM, Job, Record, Tool, ordered

TOOL = Tool(
    "sofirpy",
    "sofirpy",
    "sofirpy",
    (FMU, SYSTEM),
    "a Python model of its kind whose outputs are connected to the FMU's inputs and tunable parameters",
    requirements=("sofirpy==1.0.2", "numpy", "setuptools<81"),  # sofirpy imports pkg_resources
)


def run(job: Job) -> Record:
    """Connected systems; inputs start with the values that initialization gives here, which sofirpy does not find."""
    import sofirpy

    connections: dict[str, list[dict[str, str]]] = {}
    for source, output, target, input_ in [*job.connections, *_driven(job)]:
        connections.setdefault(target, []).append(
            {"parameter_name": input_, "connect_to_system": source, "connect_to_external_parameter": output}
        )
    logged: dict[str, list[str]] = {}
    for part, name in map(job.split, job.columns):
        logged.setdefault(part.name, []).append(name)
    result = sofirpy.simulate(
        stop_time=(job.n_steps + 0.5) * job.step,  # it truncates the number of rows
        step_size=job.step,
        fmu_paths={part.name: part.fmu for part in job.parts},
        model_classes={"source": _source(job)} if job.stimulus else None,
        connections_config=connections,
        start_values={
            part.name: {name: part.value(name, value) for name, value in {**part.initial, **part.start}.items()}
            for part in job.parts
        },
        parameters_to_log=logged,
    )
    return ordered(job, result)


def _driven(job: Job) -> list[tuple[str, str, str, str]]:
    """Connections from the source to the driven inputs."""
    return [("source", path, part.name, name) for path in job.stimulus for part, name in [job.split(path)]]


def _source(job: Job) -> type:
    """A model that plays the stimulus: what it shows at t_k is set before the step from there."""
    from sofirpy import SimulationEntity

    class Source(SimulationEntity):
        """Counts steps."""

        def initialize(self, start_values) -> None:  # noqa: ARG002
            self.k = 0

        def set_parameter(self, parameter_name, parameter_value) -> None:
            raise NotImplementedError

        def get_parameter_value(self, parameter_name):
            part, name = job.split(parameter_name)
            return part.value(name, job.stimulus[parameter_name][self.k])

        def do_step(self, time) -> None:  # noqa: ARG002
            self.k += 1

        def get_dtype_of_parameter(self, parameter_name):
            part, name = job.split(parameter_name)
            return type(part.value(name, 0))

    return Source
