"""Defines the command ``adaptimp sweep``: its options and the end of its help."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from orchestration.cli import completion
from orchestration.cli.codes import ExitCode
from orchestration.cli.isolation import EVERY, IsolatingCommand
from orchestration.cli.options import (
    ALGORITHM,
    ROWS,
    Controller,
    Isolate,
    Json,
    Mapping,
    SampleTime,
    Settings,
    Step,
    Stop,
    Variant,
)
from orchestration.cli.program import closing

STUDY, RUNS = "Study", "Runs"
PLOT, PLOTS, READY = "--plot", "plots", "--ready"
WITHOUT_WORD = {PLOT: PLOTS, READY: EVERY}
"""Options that take one word or none, and the word that stands for none."""
EPILOG = closing(
    "adaptimp sweep fig5 --vary plant.K_f=1e4:1e6:3log \\\n    --measure peak_force --stop 0.2 --store runs",
    "adaptimp sweep --resume runs --plot",
    codes={
        ExitCode.FAILED: "every run failed, or a file cannot be used",
        ExitCode.INTERRUPTED: "interrupted by Ctrl-C; a store keeps what is finished",
    },
)


class SweepCommand(IsolatingCommand):
    """A command whose options ``--plot``, ``--ready`` and ``--isolate`` take one word or none."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the words of the command line, after each of these options got its word."""
        return super().parse_args(ctx, with_words(args))


def with_words(words: Sequence[str]) -> list[str]:
    """Give each of the options `WITHOUT_WORD` its word where none follows."""
    found: list[str] = []
    for k, word in enumerate(words):
        found.append(word)
        if word in WITHOUT_WORD and (k + 1 == len(words) or words[k + 1].startswith("-")):
            found.append(WITHOUT_WORD[word])
    return found


Subject = Annotated[
    str | None,
    typer.Argument(
        metavar="SYSTEM",
        help="A system, as for 'adaptimp run', or the .toml file of a study, whose keys are these options.",
        autocompletion=completion.studies,
    ),
]
Vary = Annotated[
    list[str] | None,
    typer.Option(
        "--vary",
        metavar="NAME=RANGE",
        help="A factor: a start value, an array or sample_time, with A:B:N, A:B:Nlog or A,B,C; with --samples A:B, "
        "'A:B log', 'normal(M,S)'; repeatable.",
        rich_help_panel=STUDY,
        autocompletion=completion.settable,
    ),
]
Seeds = Annotated[
    list[str] | None,
    typer.Option(metavar="A-B", help="Seeds of random numbers: 1-30 or 1,2,7; repeatable.", rich_help_panel=STUDY),
]
Measures = Annotated[
    list[str] | None,
    typer.Option(
        "--measure",
        metavar="NAME|FORMULA",
        help="A ready measure ('adaptimp list'), a formula such as 'max(plant.gap)', or NAME=FORMULA; repeatable.",
        rich_help_panel=STUDY,
        autocompletion=completion.measures,
    ),
]
Drawn = Annotated[
    int | None,
    typer.Option("--samples", metavar="N", help="Draw N points instead of all combinations.", rich_help_panel=STUDY),
]
Method = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="sobol (default), latin-hypercube or random.", rich_help_panel=STUDY),
]
SampleSeed = Annotated[
    int | None, typer.Option(metavar="N", help="Seed of the drawing; 0 by default.", rich_help_panel=STUDY)
]
Store = Annotated[
    Path | None,
    typer.Option(metavar="FOLDER", help="Keep every run here, and take runs that are here.", rich_help_panel=RUNS),
]
Resume = Annotated[
    Path | None,
    typer.Option(metavar="FOLDER", help="Go on with the study that this store has.", rich_help_panel=RUNS),
]
RetryFailed = Annotated[
    bool,
    typer.Option("--retry-failed", help="Make runs again that the store has as failed.", rich_help_panel=RUNS),
]
Ready = Annotated[
    str | None,
    typer.Option(
        READY,
        metavar="[NAME]",
        help="List the ready studies of the paper, or run one.",
        rich_help_panel=STUDY,
        autocompletion=completion.ready_studies,
    ),
]
Workers = Annotated[
    int | None, typer.Option(metavar="N", help="Threads; by default one for each core.", rich_help_panel=RUNS)
]
Cluster = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS", help="Dask scheduler, such as tcp://host:8786.", rich_help_panel=RUNS),
]
Best = Annotated[
    str | None,
    typer.Option(metavar="min|max:MEASURE", help="Show the best run so far while runs are made.", rich_help_panel=RUNS),
]
DryRun = Annotated[
    bool,
    typer.Option("--dry-run", help="Say what would be run, and how long it takes.", rich_help_panel=RUNS),
]
Out = Annotated[
    Path | None,
    typer.Option("--out", "-o", metavar="FILE", help="Table: .csv, .parquet or .nc.", rich_help_panel=ROWS),
]
Plot = Annotated[
    Path | None,
    typer.Option(
        PLOT, metavar="[FOLDER]", help=f"Draw pictures and a page into FOLDER ({PLOTS}).", rich_help_panel=ROWS
    ),
]


def sweep(
    system: Subject = None,
    vary: Vary = None,
    seeds: Seeds = None,
    measure: Measures = None,
    samples: Drawn = None,
    method: Method = None,
    sample_seed: SampleSeed = None,
    ready: Ready = None,
    variant: Variant = None,
    controller: Controller = None,
    map_: Mapping = None,
    set_: Settings = None,
    algorithm: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="gauss-seidel (default), jacobi, iterative, newton or adaptive.",
            rich_help_panel=ALGORITHM,
            autocompletion=completion.algorithms,
        ),
    ] = None,
    step: Step = None,
    sample_time: SampleTime = None,
    stop: Stop = None,
    store: Store = None,
    resume: Resume = None,
    retry_failed: RetryFailed = False,
    workers: Workers = None,
    cluster: Cluster = None,
    best: Best = None,
    dry_run: DryRun = False,
    out: Out = None,
    plot: Plot = None,
    isolate: Isolate = None,
    json: Json = False,
) -> None:
    """Run a system many times with other start values, and keep a row of measures of each run."""
    from orchestration.cli.sweep import run_sweep

    given = {
        "vary": vary,
        "seeds": ",".join(seeds or []) or None,
        "measure": measure,
        "samples": samples,
        "method": method,
        "sample-seed": sample_seed,
        "variant": variant,
        "controller": controller,
        "map": map_,
        "set": set_,
        "algorithm": algorithm,
        "step": step,
        "sample-time": sample_time,
        "stop": stop,
        "isolate": isolate,
        "store": store,
        "resume": resume,
        "retry-failed": retry_failed,
        "ready": ready,
        "workers": workers,
        "cluster": cluster,
        "best": best,
        "dry-run": dry_run,
        "out": out,
        "plot": plot,
        "json": json,
    }
    raise typer.Exit(run_sweep(system, given))
