"""Adapter for CasADi's importer of FMUs."""

from tests.interop.matrix.protocol import CHECKED, FMU, Job, Record, Tool

TOOL = Tool("casadi", "CasADi DaeBuilder", "casadi", (FMU,))


def run(job: Job) -> Record:
    """``DaeBuilder`` of the FMU, and a function of it if that works."""
    import casadi

    builder = casadi.DaeBuilder(job.parts[0].name, job.parts[0].fmu)
    builder.create("unit", ["x", "u"], ["ode", "y"])
    return CHECKED
