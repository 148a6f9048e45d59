"""What ``adaptimp sweep`` is asked for: a system, factors, measures, and what becomes of the table.

A request is made of the command's options, or of the keys of a file, which have the same names.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from adaptimp_fmu.files.parts import require
from orchestration.cli.isolation import isolation_of
from orchestration.cli.settings import setting_of
from orchestration.cli.systems import SystemRequest
from orchestration.errors import SystemDescriptionError
from orchestration.fmi.names import suggestion

if TYPE_CHECKING:
    from orchestration.campaigns.design.factor import Factor
    from orchestration.campaigns.study import Study

SOBOL = "sobol"
TABLES = (".csv", ".parquet", ".nc")
"""Suffixes of files for the table."""
NO_INTERVAL = "plant.K_f=1e4:1e6 or 'plant.K_f=1e4:1e6 log'"
NO_RANGE = "NAME=RANGE is needed, such as plant.K_f=1e4:1e6:9log"


@dataclass(frozen=True)
class Samples:
    """How many points are drawn, and how.

    Attributes
    ----------
    n, method, seed
        Number of points, name of the method, and seed of the generator.
    """

    n: int
    method: str = SOBOL
    seed: int = 0


@dataclass(frozen=True)
class SweepRequest:
    """Options of ``adaptimp sweep``; times in s.

    Attributes
    ----------
    systems
        Systems that are compared, by the names of the variants; a single one has an empty name.
    vary
        Values or texts of ranges by the names of factors; a mapping with ``variables`` and ``values`` is a factor that
        sets several start values.
    seeds
        Seeds as a text such as ``1-30`` or as numbers; None for the seeds of the system.
    measures
        Names of ready measures, formulas, or texts ``NAME = FORMULA``.
    samples
        How points are drawn; None makes all combinations.
    store, resume, ready
        Folder of the store; folder of the store with a study to go on with; name of a ready study.
    workers, cluster
        Number of threads; address of a scheduler.
    out, plot
        File for the table; folder for the pictures.
    best
        ``min:MEASURE`` or ``max:MEASURE``: the run that is shown while others are made.
    retry_failed
        Whether runs that the store has as failed are made again.
    """

    systems: Mapping[str, SystemRequest] = field(default_factory=dict)
    vary: Mapping[str, Any] = field(default_factory=dict)
    seeds: Any = None
    measures: Sequence[str] = ()
    samples: Samples | None = None
    algorithm: str = "gauss-seidel"
    step: float | None = None
    stop: float | None = None
    isolate: Sequence[str] = ()
    store: Path | None = None
    resume: Path | None = None
    ready: str | None = None
    workers: int | None = None
    cluster: str | None = None
    out: Path | None = None
    plot: Path | None = None
    best: str | None = None
    retry_failed: bool = False
    dry_run: bool = False
    json: bool = False

    @property
    def name(self) -> str:
        """Names of the systems, for reports."""
        begun = self.ready or self.resume
        return str(begun) if begun else ", ".join(asked.name for asked in self.systems.values())

    def require_sense(self) -> None:
        """Refuse what contradicts itself, before any work is done.

        Raises
        ------
        SystemDescriptionError
            If options contradict each other, or one is missing.
        """
        if self.out is not None and self.out.suffix.lower() not in TABLES:
            msg = f"--out {self.out}: tables are written as {', '.join(TABLES)}; end the name with one of them."
            raise SystemDescriptionError(msg)
        if self.store is not None or (self.out is not None and self.out.suffix.lower() == ".parquet"):
            require("pyarrow")
        if self.samples is not None or (self.out is not None and self.out.suffix.lower() == ".nc"):
            require("scipy")
        if self.cluster is not None and self.workers is not None:
            msg = "--cluster and --workers exclude each other: the cluster has its own workers."
            raise SystemDescriptionError(msg)
        if self.retry_failed and self.store is None:
            msg = "--retry-failed is about runs that a store has, and there is none; give --store or --resume."
            raise SystemDescriptionError(msg)
        if self.resume is not None or self.ready is not None:
            return
        if self.step is not None and any(asked.sample_time is not None for asked in self.systems.values()):
            msg = "--step and --sample-time exclude each other: the latter sets the step too."
            raise SystemDescriptionError(msg)
        if not self.measures:
            msg = "Nothing is measured; give --measure, such as peak_force ('adaptimp list' names the ready ones)."
            raise SystemDescriptionError(msg)
        if self.samples is not None and not self.vary:
            msg = f"--samples {self.samples.n}: there is no factor to draw; give --vary, such as {NO_INTERVAL}."
            raise SystemDescriptionError(msg)
        if not self.vary and self.seeds is None:
            msg = f"Nothing varies; give --vary or --seeds: {NO_RANGE}."
            raise SystemDescriptionError(msg)

    def study(self) -> "Study":
        """Make the study; FMUs that are not there yet are built.

        Raises
        ------
        OrchestrationError
            If there is no such system, factor, range or measure, or no study in the store.
        """
        from orchestration.campaigns.study import Study

        if self.resume is not None:
            return Study.resume(self.resume)
        if self.ready is not None:
            return ready_study(self.ready)
        systems = {name: asked.system() for name, asked in self.systems.items()}
        study = Study(
            systems[""] if list(systems) == [""] else systems,
            measure=list(self.measures),
            stop_time=self.stop,
            step=self.step,
            algorithm=self.algorithm,
            isolate=isolation_of(self.isolate),
        )
        if self.samples is not None:
            drawn = self.samples
            study = study.samples(self._factors(), n=drawn.n, method=drawn.method, seed=drawn.seed)
        elif self.vary:
            study = study.grid(self._factors())
        return study if self.seeds is None else study.seeds(self.seeds)

    def _factors(self) -> "list[Factor]":
        """The factors, those that set several start values included."""
        from orchestration.campaigns.design.factor import Factor

        return [
            Factor(name, wanted["variables"], wanted["values"])
            if isinstance(wanted, Mapping)
            else Factor(name, name, wanted)
            for name, wanted in self.vary.items()
        ]


def varied(texts: Sequence[str]) -> dict[str, str]:
    """Ranges by the names of factors, from texts NAME=RANGE of ``--vary``.

    Raises
    ------
    SystemDescriptionError
        If a text has another form, or two have the same name.
    """
    found: dict[str, str] = {}
    for name, text in map(setting_of("--vary", NO_RANGE), texts):
        if name in found:
            msg = f"--vary {name}: the factor is given twice, as {found[name]} and as {text}; give it once."
            raise SystemDescriptionError(msg)
        found[name] = text
    return found


def ready_study(name: str) -> "Study":
    """A ready study by its name.

    Raises
    ------
    SystemDescriptionError
        If there is no such study.
    """
    from orchestration.paper.studies.ready import READY_STUDIES

    if name not in READY_STUDIES:
        msg = f"--ready {name}: there is no such study; {suggestion(name, READY_STUDIES)}"
        raise SystemDescriptionError(msg)
    return READY_STUDIES[name].make()
