"""Adapter for fmpy's loop for SSP packages, with the parameters that it can be given."""

from types import SimpleNamespace

from tests.interop.matrix.protocol import SYSTEM, Job, Record, Tool, ordered

TOOL = Tool("fmpy_ssp", "fmpy.ssp", "fmpy", (SYSTEM,))


def run(job: Job) -> Record:
    """Given the packages' start values, which it does not read, as its argument `parameter_set`."""
    from fmpy.ssp.simulation import simulate_ssp

    parameters = [
        SimpleNamespace(name=f"{part.name}.{name}", value=value)
        for part in job.parts
        for name, value in part.start.items()
    ]
    result = simulate_ssp(
        job.ssp,
        stop_time=(job.n_steps - 0.5) * job.step,  # it sums its times
        step_size=job.step,
        parameter_set=SimpleNamespace(parameters=parameters),
    )
    return ordered(job, {name: result[name] for name in result.dtype.names or ()}, first=1)
