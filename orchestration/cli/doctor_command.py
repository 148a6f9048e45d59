"""Defines the command ``adaptimp doctor``: its options and the end of its help."""

from typing import Annotated

import typer

from orchestration.cli.codes import ExitCode
from orchestration.cli.options import (
    CARE,
    AlgorithmName,
    Controller,
    Exchange,
    InputOrder,
    Isolate,
    Json,
    Mapping,
    Order,
    SampleTime,
    Settings,
    Step,
    Stop,
    SystemName,
    Variant,
)
from orchestration.cli.program import closing

EPILOG = closing(
    "adaptimp doctor fig5",
    "adaptimp doctor fig2 --algorithm jacobi \\\n    --sample-time 2e-3 --json",
    codes={
        ExitCode.FAILED: "warnings or errors were found, or a file is unusable",
        ExitCode.REFUSED: "the system cannot be examined",
    },
)


def doctor(
    system: SystemName,
    variant: Variant = None,
    controller: Controller = None,
    map_: Mapping = None,
    set_: Settings = None,
    algorithm: AlgorithmName = "gauss-seidel",
    exchange: Exchange = None,
    input_order: InputOrder = None,
    order: Order = None,
    step: Step = None,
    sample_time: SampleTime = None,
    stop: Stop = None,
    budget: Annotated[
        float, typer.Option(metavar="SECONDS", help="Time for the runs with halved steps, s.", rich_help_panel=CARE)
    ] = 10.0,
    isolate: Isolate = None,
    json: Json = False,
) -> None:
    """Examine whether a co-simulation is right: stability, accuracy, energy, delays, other tools."""
    from orchestration.cli.algorithms import AlgorithmRequest
    from orchestration.cli.doctor import DoctorRequest, run_doctor
    from orchestration.cli.systems import SystemRequest

    raise typer.Exit(
        run_doctor(
            DoctorRequest(
                asked=SystemRequest(system, controller, tuple(map_ or ()), tuple(set_ or ()), sample_time, variant),
                algorithm=AlgorithmRequest(algorithm, exchange, input_order),
                order=order.split(",") if order else None,
                step=step,
                stop=stop,
                budget=budget,
                isolate=tuple(isolate or ()),
                json=json,
            )
        )
    )
